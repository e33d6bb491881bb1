"""Evaluation of a policy: episodes from seeded initial conditions, and what they show with 95 % intervals."""

import csv
import io
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, fields
from itertools import product
from math import degrees, sqrt
from queue import SimpleQueue
from typing import Any, Final, Literal, Protocol

import numpy as np

from agent_proc.policy import Policy
from agent_proc.poses import box_error
from legpush.errors import ConfigError
from legpush.messages import Motion, Outcome, Reset
from legpush.scenario import Scenario
from legpush.scenario_file import override

Ending = Literal["done", "fell", "max_cycles"]
Z_95: Final = 1.959964
N_BOOTSTRAP: Final = 2000


class TracingWorld(Protocol):
    """Carries out motions and can tell what happened at every tick of them."""

    def step(self, motion: Motion, *, with_trace: bool = False) -> Outcome:
        """Carry out one motion."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One episode."""

    case: str
    """What was changed in the scenario, such as `box.mass_kg=0.5`; empty where nothing was."""
    seed: int
    """Draws the initial offsets."""
    ending: Ending
    """The policy was `done`, the robot `fell`, or `max_cycles` were not enough."""
    success: bool
    """The box ended within the goal's tolerances, and the robot stands."""
    position_error_m: float
    angle_error_deg: float
    n_cycles: int
    max_abs_roll_deg: float
    max_abs_pitch_deg: float


def run_episode(world: TracingWorld, scenario: Scenario, seed: int, policy: Policy, case: str = "") -> Row:
    """Reset and push until the policy is done, the robot falls, or the scenario's cycles are used up."""
    outcome = world.step(Reset(scenario=scenario, seed=seed))
    n_cycles, roll_rad, pitch_rad = 0, 0.0, 0.0
    ending: Ending = "max_cycles"
    while True:
        if outcome.trace is not None and outcome.trace.roll_pitch_rad:
            most = np.abs(outcome.trace.roll_pitch_rad).max(axis=0).tolist()
            roll_rad, pitch_rad = max(roll_rad, most[0]), max(pitch_rad, most[1])
        if outcome.world.fallen:
            ending = "fell"
            break
        push = policy.decide(outcome.world, scenario)
        if push is None:
            ending = "done"
            break
        if n_cycles == scenario.mission.max_push_cycles:
            break
        outcome = world.step(push, with_trace=True)
        n_cycles += 1
    error = box_error(outcome.world, scenario)
    return Row(
        case=case,
        seed=seed,
        ending=ending,
        success=ending != "fell" and error.within(scenario.goal),
        position_error_m=error.position_m,
        angle_error_deg=degrees(error.angle_rad),
        n_cycles=n_cycles,
        max_abs_roll_deg=degrees(roll_rad),
        max_abs_pitch_deg=degrees(pitch_rad),
    )


def evaluate(
    worlds: Sequence[TracingWorld],
    cases: Mapping[str, Scenario],
    seeds: Sequence[int],
    policy: Policy,
    on_row: Callable[[Row], None] = lambda _: None,
) -> list[Row]:
    """Each case with each seed, as many at once as there are worlds; rows in the order of cases, then seeds.

    `on_row` gets each row as it comes, in that order, on the caller's thread.
    """
    free: SimpleQueue[TracingWorld] = SimpleQueue()
    for world in worlds:
        free.put(world)

    def one(case: str, seed: int) -> Row:
        world = free.get()
        try:
            return run_episode(world, cases[case], seed, policy, case)
        finally:
            free.put(world)

    pool = ThreadPoolExecutor(len(worlds))
    try:
        futures = [pool.submit(one, case, seed) for case, seed in product(cases, seeds)]
        rows = []
        for future in futures:
            rows.append(future.result())
            on_row(rows[-1])
        return rows
    finally:
        pool.shutdown(cancel_futures=True)


# -- what is swept -----------------------------------------------------------------------------------------------------


def parse_sweep(text: str) -> tuple[str, tuple[float | str, ...]]:
    """`box.mass_kg=0.1,0.5` as field and values; `ConfigError` where it is none."""
    field, equals, values = text.partition("=")
    parts = [part.strip() for part in values.split(",")]
    if not (field and equals and all(parts)):
        raise ConfigError(f"Expected FIELD=VALUE,VALUE,... for --sweep, such as box.mass_kg=0.1,0.5, got {text!r}")
    return field.strip(), tuple(_value(part) for part in parts)


def make_cases(scenario: Scenario, sweeps: Iterable[str], *, grid: bool) -> dict[str, Scenario]:
    """The scenarios of all sweeps, one field after the other or, as a `grid`, every combination; by what is changed.

    Without a sweep it is the scenario itself, under the empty name. `ScenarioError` where a value cannot be used.
    """
    parsed = [parse_sweep(sweep) for sweep in sweeps]
    if not parsed:
        return {"": scenario}
    single = [[(field, value) for value in values] for field, values in parsed]
    changes = list(product(*single)) if grid else [((field, value),) for row in single for field, value in row]
    return {_name(change): _changed(scenario, dict(change)) for change in changes}


def _changed(scenario: Scenario, changes: dict[str, float | str]) -> Scenario:
    try:
        return override(scenario, changes)
    except (KeyError, TypeError) as error:
        raise ConfigError(f"Expected a field of the scenario for --sweep, got {', '.join(changes)}") from error


def _name(change: Iterable[tuple[str, float | str]]) -> str:
    return " ".join(f"{field}={value}" for field, value in change)


def _value(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


# -- statistics --------------------------------------------------------------------------------------------------------


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A mean or share and its 95 % interval."""

    value: float
    low: float
    high: float


@dataclass(frozen=True, kw_only=True)
class Summary:
    """What the episodes of one case show."""

    n: int
    success_rate: Estimate
    """Interval by Wilson."""
    position_error_m: Estimate
    """Mean; intervals of means by bootstrap."""
    angle_error_deg: Estimate
    n_cycles: Estimate
    n_falls: int
    max_abs_roll_deg: float
    max_abs_pitch_deg: float
    largest_position_error_m: float
    largest_angle_error_deg: float

    def __str__(self) -> str:
        """For people."""
        position, angle, rate = self.position_error_m, self.angle_error_deg, self.success_rate
        return (
            f"{100 * position.value:.2f} cm [{100 * position.low:.2f}, {100 * position.high:.2f}], "
            f"{angle.value:.2f}° [{angle.low:.2f}, {angle.high:.2f}], "
            f"success {rate.value:.0%} [{rate.low:.0%}, {rate.high:.0%}], "
            f"{self.n_cycles.value:.1f} cycles, {self.n_falls} falls, n = {self.n}"
        )


def summarize(rows: Sequence[Row]) -> dict[str, Summary]:
    """The summary of each case."""
    return {case: _summary([row for row in rows if row.case == case]) for case in dict.fromkeys(r.case for r in rows)}


def _summary(rows: Sequence[Row]) -> Summary:
    return Summary(
        n=len(rows),
        success_rate=wilson(sum(row.success for row in rows), len(rows)),
        position_error_m=mean_interval([row.position_error_m for row in rows]),
        angle_error_deg=mean_interval([row.angle_error_deg for row in rows]),
        n_cycles=mean_interval([float(row.n_cycles) for row in rows]),
        n_falls=sum(row.ending == "fell" for row in rows),
        max_abs_roll_deg=max(row.max_abs_roll_deg for row in rows),
        max_abs_pitch_deg=max(row.max_abs_pitch_deg for row in rows),
        largest_position_error_m=max(row.position_error_m for row in rows),
        largest_angle_error_deg=max(row.angle_error_deg for row in rows),
    )


def wilson(n_successes: int, n: int) -> Estimate:
    """A share with Wilson's score interval."""
    share, z2 = n_successes / n, Z_95**2
    centre = (share + z2 / (2 * n)) / (1 + z2 / n)
    half = Z_95 / (1 + z2 / n) * sqrt(share * (1 - share) / n + z2 / (4 * n**2))
    return Estimate(value=share, low=max(0.0, centre - half), high=min(1.0, centre + half))


def mean_interval(values: Sequence[float]) -> Estimate:
    """A mean with the percentile bootstrap interval, drawn with a fixed seed."""
    data = np.array(values)
    drawn = np.random.default_rng(0).integers(len(data), size=(N_BOOTSTRAP, len(data)))
    low, high = np.quantile(data[drawn].mean(axis=1), (0.025, 0.975)).tolist()
    return Estimate(value=float(data.mean()), low=low, high=high)


def as_csv(rows: Iterable[Row]) -> str:
    """One line per episode, under the names of the fields."""
    text = io.StringIO()
    writer = csv.DictWriter(text, [field.name for field in fields(Row)], lineterminator="\n")
    writer.writeheader()
    writer.writerows(_plain(rows))
    return text.getvalue()


def _plain(rows: Iterable[Row]) -> Iterator[dict[str, Any]]:
    for row in rows:
        yield {field.name: getattr(row, field.name) for field in fields(row)}
