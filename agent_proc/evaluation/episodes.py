"""Evaluates a policy: episodes from seeded initial conditions, summarized with 95 % intervals."""

import threading
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from functools import partial
from itertools import product
from math import degrees
from queue import SimpleQueue
from typing import Final, Literal

import numpy as np

from agent_proc.frames.poses import box_error
from agent_proc.frames.push_view import push_view
from agent_proc.policies.policy import Policy
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.statistics.estimate import Estimate
from agent_proc.statistics.intervals import mean, share
from agent_proc.walking.around_box import can_push, walk_to_face
from legpush.errors import MotionError, StopRequestedError
from legpush.lockstep.world import SteppingWorld
from legpush.long_work.parallel import in_parallel
from legpush.messages.poses import as_seen, planar_pose
from legpush.messages.stepping import Motion, Outcome, Reset
from legpush.scene.conventions import CONTROL_PERIOD_S
from legpush.scene.faces import FACES, pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.scenario import Scenario

EPISODE_CYCLES: Final = 200
"""Most push cycles of an episode if the scenario does not say how many."""
EvaluationEnding = Literal["done", "fell", "astray", "refused", "max_cycles"]


@dataclass(frozen=True, kw_only=True)
class Row:
    """One episode."""

    case: str
    """Changes to the scenario, such as `box.mass_kg=0.5`; empty if there are none."""
    seed: int
    """Seed of the initial offsets."""
    ending: EvaluationEnding
    """The policy was `done`, the robot `fell`, the box slid out of its reach (`astray`), or the episode reached
    `max_cycles`."""
    success: bool
    """Whether the policy was done, with the box within the goal's tolerances, by its true pose."""
    position_error_m: float
    angle_error_deg: float
    n_cycles: int
    simulated_s: float
    """Simulated time of the episode, with its walks around the box."""
    max_abs_roll_deg: float | None
    """Largest roll of the trunk; None without a push, and in a world that has no trunk. The next two, too."""
    max_abs_pitch_deg: float | None
    min_support_margin_m: float | None
    """Smallest margin of the robot's CoM inside its support polygon over all ticks."""


def run_episode(
    world: SteppingWorld,
    scenario: Scenario,
    seed: int,
    policy: Policy,
    case: str = "",
    stop: threading.Event | None = None,
    known: Mapping[Face, PushEstimate] | None = None,
) -> Row:
    """Reset and push until the policy is done, the robot falls, the box is out of its reach, or no cycles are left.

    A push that the legs cannot follow, as on a steep slope, is refused by the simulator, and ends the episode too.

    To push another face than the last one, the robot walks around the box first. What is `known` of the box by earlier
    pushes at a face goes on to be learned.

    Raises:
        StopRequestedError: `stop` was set; checked before each cycle.
    """
    outcome = world.step(Reset(scenario=scenario, seed=seed))
    estimates = {face: PushEstimate(pushed_box(scenario.box, face)) for face in FACES} | dict(known or {})
    n_most, n_cycles, face, posture = scenario.mission.max_push_cycles or EPISODE_CYCLES, 0, FACES[0], _Posture()

    def step(motion: Motion) -> Outcome:
        return posture.seen(world.step(motion, with_trace=True))

    ending: EvaluationEnding = "max_cycles"
    while True:
        if stop is not None and stop.is_set():
            raise StopRequestedError("Asked to stop in an episode")
        if outcome.world.fallen:
            ending = "fell"
            break
        seen = as_seen(outcome.world)
        estimate = estimates[face]
        push = policy.decide(push_view(seen, scenario, estimate.felt, face))
        if push is None:
            ending = "done"
            break
        if n_cycles == n_most:
            break
        if push.face != face:
            outcome, face = walk_to_face(step, scenario, outcome, push.face), push.face
            if outcome.world.fallen:
                continue
            seen = as_seen(outcome.world)
        if not can_push(seen, scenario, face):
            ending = "astray"
            break
        try:
            outcome = step(push)
        except MotionError:
            ending = "refused"
            break
        before, after = (pushed_pose(planar_pose(state.box), face) for state in (seen, as_seen(outcome.world)))
        estimates[face].learn(before, push, after)
        n_cycles += 1
    error = box_error(outcome.world, scenario)
    return Row(
        case=case,
        seed=seed,
        ending=ending,
        success=ending == "done" and error.within(scenario.goal),
        position_error_m=error.position_m,
        angle_error_deg=degrees(error.angle_rad),
        n_cycles=n_cycles,
        simulated_s=round(outcome.world.tick * CONTROL_PERIOD_S, 2),
        **posture.worst(),
    )


class _Posture:
    """The least steady posture of an episode."""

    def __init__(self) -> None:
        self._tilts_rad: list[tuple[float, float]] = []
        self._margins_m: list[float] = []

    def seen(self, outcome: Outcome) -> Outcome:
        """Take in the trace of an outcome, and return it."""
        if outcome.trace is not None and outcome.trace.roll_pitch_rad:
            roll_rad, pitch_rad = np.abs(outcome.trace.roll_pitch_rad).max(axis=0).tolist()
            self._tilts_rad.append((roll_rad, pitch_rad))
            self._margins_m.append(min(outcome.trace.support_margin_m))
        return outcome

    def worst(self) -> dict[str, float | None]:
        """Fields of the row; None if no trace was seen."""
        roll_rad, pitch_rad = map(max, zip(*self._tilts_rad, strict=True)) if self._tilts_rad else (None, None)
        return {
            "max_abs_roll_deg": None if roll_rad is None else degrees(roll_rad),
            "max_abs_pitch_deg": None if pitch_rad is None else degrees(pitch_rad),
            "min_support_margin_m": min(self._margins_m, default=None),
        }


def as_it_is(scenario: Scenario, _seed: int) -> Scenario:
    """Return the same scenario."""
    return scenario


def evaluate(
    worlds: Sequence[SteppingWorld],
    cases: Mapping[str, Scenario],
    seeds: Sequence[int],
    policy: Policy,
    on_row: Callable[[Row], None] = lambda _: None,
    stop: threading.Event | None = None,
    finished: Mapping[tuple[str, int], Row] | None = None,
    drawn: Callable[[Scenario, int], Scenario] = as_it_is,
) -> list[Row]:
    """Run each case with each seed, one episode per world at a time; rows in the order of cases, then seeds.

    `drawn` is the scenario of a start, by that of its case and its seed. `on_row` is called on the caller's thread with
    each row as its episode ends. The `finished` ones, by case and seed, are not run again.

    Raises:
        StopRequestedError: `stop` was set.
    """
    free: SimpleQueue[SteppingWorld] = SimpleQueue()
    for world in worlds:
        free.put(world)

    def one(case: str, seed: int) -> Row:
        world = free.get()
        try:
            return run_episode(world, drawn(cases[case], seed), seed, policy, case, stop)
        finally:
            free.put(world)

    planned, rows = list(product(cases, seeds)), dict(finished or {})
    missing = [episode for episode in planned if episode not in rows]
    made = in_parallel([partial(one, case, seed) for case, seed in missing], len(worlds), on_row)
    rows |= zip(missing, made, strict=True)
    return [rows[episode] for episode in planned]


@dataclass(frozen=True, kw_only=True)
class Summary:
    """Statistics of the episodes of one case."""

    n: int
    success_rate: Estimate
    position_error_m: Estimate
    """Mean, as the next two."""
    angle_error_deg: Estimate
    n_cycles: Estimate
    n_falls: int
    max_abs_roll_deg: float | None
    """Of all episodes that have one, as the next two; None if none has."""
    max_abs_pitch_deg: float | None
    min_support_margin_m: float | None
    largest_position_error_m: float
    largest_angle_error_deg: float

    def __str__(self) -> str:
        """For people."""
        return (
            f"position error {self.position_error_m.scaled(100.0).text('.2f')} cm, "
            f"angle error {self.angle_error_deg.text('.2f')} deg, success {self.success_rate.text('.0%')}, "
            f"{self.n_cycles.value:.1f} cycles, {self.n_falls} falls"
        )


def summarize(rows: Sequence[Row]) -> dict[str, Summary]:
    """Summarize the episodes of each case."""
    return {case: _summary([row for row in rows if row.case == case]) for case in dict.fromkeys(r.case for r in rows)}


def _summary(rows: Sequence[Row]) -> Summary:
    return Summary(
        n=len(rows),
        success_rate=share(sum(row.success for row in rows), len(rows)),
        position_error_m=mean([row.position_error_m for row in rows]).cut(0.0),
        angle_error_deg=mean([row.angle_error_deg for row in rows]).cut(0.0),
        n_cycles=mean([float(row.n_cycles) for row in rows]),
        n_falls=sum(row.ending == "fell" for row in rows),
        max_abs_roll_deg=max(_known(row.max_abs_roll_deg for row in rows), default=None),
        max_abs_pitch_deg=max(_known(row.max_abs_pitch_deg for row in rows), default=None),
        min_support_margin_m=min(_known(row.min_support_margin_m for row in rows), default=None),
        largest_position_error_m=max(row.position_error_m for row in rows),
        largest_angle_error_deg=max(row.angle_error_deg for row in rows),
    )


def _known(values: Iterable[float | None]) -> list[float]:
    return [value for value in values if value is not None]
