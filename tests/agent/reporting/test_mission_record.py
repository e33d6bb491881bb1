"""What happened in a mission, read from its journal."""

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.reporting.mission_record import read_record
from legpush.errors import JournalError
from legpush.history.steps import StepRecord
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Walk
from tests.agent.fake_world import FakeWorld
from tests.agent.reporting.missions import SCENARIO, journal_by_hand


def test_the_ticks_of_a_mission_end_where_its_state_does() -> None:
    world = FakeWorld(box_offset=(0.02, 0.03, 0.05))
    run_mission(world, SCENARIO, 5, ScriptedPolicy())

    record = read_record(world.records)

    ticks, last = record.ticks(), record.steps[-1].world
    box = planar_pose(last.box)
    assert len(ticks.time_s) == last.tick
    assert ticks.time_s[-1] == pytest.approx(last.tick * 0.02)
    np.testing.assert_allclose(ticks.box[-1], [box.x_m, box.y_m, box.yaw_rad])
    np.testing.assert_allclose(ticks.trunk_m[-1], last.trunk.position_m[:2])
    np.testing.assert_allclose(ticks.tips_m[-1], last.tips_m)
    assert record.pushing()[0].world.box.position_m[:2] == (6.02, 3.03)


def test_walks_between_pushes_are_no_push_cycles() -> None:
    reset, follow, walk, push = journal_by_hand()
    record = read_record([reset, follow, walk, push, follow, walk, walk, push])
    assert [type(step.motion) for step in record.push_cycles()] == [Walk, Push, Push]
    assert len(record.pushing()) == 6
    assert read_record([reset, follow, walk]).push_cycles() == []


def test_a_journal_that_does_not_begin_with_a_reset_is_refused() -> None:
    with pytest.raises(JournalError, match="Expected a reset as the first step"):
        read_record(journal_by_hand()[1:])
    with pytest.raises(JournalError, match="Expected a reset as the first step"):
        read_record([])


def test_a_step_without_its_trace_is_refused() -> None:
    motion, result = journal_by_hand()[0]
    bare = StepRecord(motion, replace(result, trace=None))  # type: ignore[arg-type]

    with pytest.raises(JournalError, match="got step 0 without one"):
        read_record([bare])
