"""What is perceived decides what the robot does, and what is true decides what came of it."""

from math import radians
from pathlib import Path

import pytest
from msgspec.structs import replace

import agent_proc
from agent_proc.evaluation.episodes import run_episode
from agent_proc.learning.env import PushEnv
from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.task.file import DEFAULT_TASK, load_task
from legpush.errors import MotionError
from legpush.history.steps import PlanRecord
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Motion, Outcome, Perceived, Push
from tests.agent.fake_world import FakeWorld, make_scenario, scenario_at_station

OFF_M = 0.5


class Misplaced(FakeWorld):
    """Robot and box are perceived where the fake world has them, and are really elsewhere."""

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        outcome = super().step(motion, with_trace=with_trace)
        world = outcome.world
        x, y, z = world.box.position_m
        trunk_x, trunk_y, trunk_z = world.trunk.position_m
        true = replace(
            world,
            trunk=replace(world.trunk, position_m=(trunk_x + 2 * OFF_M, trunk_y - OFF_M, trunk_z)),
            box=replace(world.box, position_m=(x, y + OFF_M, z)),
            perceived=Perceived(
                trunk=planar_pose(world.trunk), trunk_tick=world.tick, box=world.box, box_tick=world.tick
            ),
        )
        return replace(outcome, world=true)


class Refusing(Misplaced):
    """Refuses some pushes in a row, as if the box were seen in the robot."""

    n_refused = 0
    seen_exactly = False

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        if isinstance(motion, Push) and self.n_refused > 0:
            self.n_refused -= 1
            raise MotionError("the trunk would be in the box")
        if self.seen_exactly:
            return FakeWorld.step(self, motion, with_trace=with_trace)
        return super().step(motion, with_trace=with_trace)


def told(world: FakeWorld) -> list[object]:
    """The motions that were asked for, without rounding errors."""
    motions = [record[0] for record in world.records if not isinstance(record, PlanRecord)]
    return [
        (each.leg, each.face, round(each.depth_m, 6), round(each.w1, 6)) if isinstance(each, Push) else type(each)
        for each in motions
    ]


def test_a_mission_depends_on_what_is_perceived_and_succeeds_by_what_is_true() -> None:
    offset = (0.04, -0.05, radians(4.0))
    plain, misplaced = FakeWorld(box_offset=offset), Misplaced(box_offset=offset)
    results = [run_mission(world, make_scenario(), 7, ScriptedPolicy()) for world in (plain, misplaced)]
    assert told(plain) == told(misplaced)
    assert [result.success for result in results] == [True, False]
    assert results[1].reason == "tolerance_missed"
    assert "box error 0.5" in results[1].detail
    assert "perceived as 0.0" in results[1].detail


def test_an_evaluated_episode_is_judged_by_the_true_pose() -> None:
    plain, misplaced = FakeWorld(), Misplaced()
    rows = [run_episode(world, scenario_at_station(), 0, ScriptedPolicy()) for world in (plain, misplaced)]
    assert [row.n_cycles for row in rows] == [rows[0].n_cycles] * 2
    assert [row.success for row in rows] == [True, False]
    assert rows[1].position_error_m == pytest.approx(OFF_M, abs=0.02)


@pytest.mark.parametrize(
    ("n_refused", "seen_exactly", "goes_on"), [(2, False, True), (3, False, False), (1, True, False)]
)
def test_a_refused_push_is_tried_again_where_another_look_may_help(
    n_refused: int, seen_exactly: bool, goes_on: bool
) -> None:
    world = Refusing()
    world.n_refused, world.seen_exactly = n_refused, seen_exactly
    result = run_mission(world, make_scenario(), 7, ScriptedPolicy())
    assert world.n_refused == 0
    assert (result.reason != "motion_refused") == goes_on
    assert (result.n_push_cycles > 5) == goes_on


def test_only_judges_read_the_true_state() -> None:
    judges = {"mission/mission.py", "pushing/pushes.py", "walking/actor.py"}
    folder = Path(agent_proc.__file__).parent
    reading = {
        path.relative_to(folder).as_posix()
        for path in folder.rglob("*.py")
        if any(word in path.read_text() for word in ("true_state", "true_box_error"))
    }
    assert reading == judges


def test_a_learner_sees_what_is_perceived_and_earns_by_what_is_true() -> None:
    task = load_task(DEFAULT_TASK)
    seen, errors_m = [], []
    for world in (FakeWorld(), Misplaced()):
        env = PushEnv(task, world)
        observation, info = env.reset(seed=0, options={"scenario": scenario_at_station()})
        seen.append(observation)
        errors_m.append(info["position_error_m"])
        env.close()
    assert seen[0] == pytest.approx(seen[1], abs=1e-5)
    assert errors_m[1] > errors_m[0] + 0.1 * OFF_M
