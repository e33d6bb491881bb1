"""A world in this process: steps and plans by function calls, with what is told of them."""

from collections.abc import Iterator

import pytest

from legpush.errors import BrokenEpisodeError, ConfigError, MotionError
from legpush.history.steps import PlanRecord, StepRecord
from legpush.lockstep.local import LocalWorld, never
from legpush.messages.planning import Plan, PlanQuery
from legpush.messages.stepping import Motion, Outcome, Walk
from legpush.plans.planner import Interrupted
from tests.legpush.examples import PLAN, QUERY, RESET
from tests.legpush.fakes import FakeStepper, crc_after, fake_plan, mission, one_plan

N_PLANS = 3


def better_and_better(query: PlanQuery, interrupted: Interrupted) -> Iterator[Plan]:
    """A planner that improves its plan."""
    assert interrupted is never
    for revision in range(N_PLANS):
        yield Plan(status="exact", reason="", n_iterations=query.seed + revision)


def test_motions_are_carried_out_as_the_simulator_does() -> None:
    world = LocalWorld(FakeStepper())
    outcomes = [world.step(motion) for motion in mission()]
    assert outcomes[-1].state_crc == crc_after(mission())
    assert all(outcome.trace is None for outcome in outcomes)
    assert world.step(RESET, with_trace=True).trace is not None


def test_a_motion_that_cannot_be_carried_out_is_an_error() -> None:
    with pytest.raises(MotionError, match="Expected a follow before the first walk"):
        LocalWorld(FakeStepper()).step(Walk())


class Broken(FakeStepper):
    """Fails at its first walk."""

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        if motion == Walk():
            raise ValueError("size 0 in geom")
        return super().perform(motion, with_trace=with_trace)


def test_after_a_failure_of_the_simulator_only_a_reset_goes_on() -> None:
    world = LocalWorld(Broken())
    for motion in mission()[:2]:
        world.step(motion)
    with pytest.raises(BrokenEpisodeError, match="The simulator failed in a walk: ValueError: size 0 in geom"):
        world.step(Walk())
    with pytest.raises(BrokenEpisodeError, match="size 0 in geom; expected a reset after that, got follow"):
        world.step(mission()[1])
    world.step(RESET)
    assert world.step(mission()[1]).state_crc == crc_after(mission()[:2])


def test_a_planner_that_fails_answers_failed() -> None:
    def fail(query: PlanQuery) -> Plan:
        raise OverflowError("math range error")

    assert LocalWorld(FakeStepper(), one_plan(fail)).plan(QUERY).status == "failed"


def test_plans_come_one_by_one_and_the_last_one_is_repeated() -> None:
    world = LocalWorld(FakeStepper(), better_and_better)
    first = world.plan(QUERY)
    assert [world.revision(k).n_iterations - first.n_iterations for k in (0, 1, 1, 2, 3, 9)] == [0, 1, 1, 2, 2, 2]


def test_after_it_is_cancelled_a_search_has_no_better_plans() -> None:
    world = LocalWorld(FakeStepper(), better_and_better)
    first = world.plan(QUERY)
    world.cancel_plan()
    assert world.revision(2) == first


def test_each_query_has_a_search_of_its_own() -> None:
    world = LocalWorld(FakeStepper(), one_plan(fake_plan))
    assert world.plan(QUERY) == world.plan(QUERY) == fake_plan(QUERY)


def test_steps_and_plans_are_told_in_order() -> None:
    records: list[StepRecord | PlanRecord] = []
    world = LocalWorld(FakeStepper(), one_plan(lambda query: PLAN), on_record=records.append)
    outcome = world.step(RESET)
    world.plan(QUERY)
    world.revision(1)
    assert records == [StepRecord(RESET, outcome), PlanRecord(QUERY, PLAN), PlanRecord(QUERY, PLAN)]


def test_a_world_without_a_planner_and_a_revision_without_a_query_are_errors() -> None:
    with pytest.raises(ConfigError, match="Expected a world with a planner"):
        LocalWorld(FakeStepper()).plan(QUERY)
    with pytest.raises(ConfigError, match="Expected a query before a revision"):
        LocalWorld(FakeStepper(), better_and_better).revision(0)
