"""`python -m benchmarks.map_world.agreement`: errors of the world without physics, and the order of ten policies in it.

Every policy runs from the same unseen starts in the simulator and in the map, with and without residuals. The pushes in
the simulator also tell the error of the map in single pushes. The numbers go to `results/map_world_agreement.json`, the
episodes to `results/map_world_agreement.csv`.
"""

from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass
from itertools import combinations, product
from math import degrees
from multiprocessing import get_context
from typing import Any, Final

import numpy as np
import tyro
from scipy import stats

from agent_proc.statistics.estimate import Estimate
from agent_proc.statistics.intervals import mean, share
from agent_proc.statistics.paired import paired_difference
from benchmarks.map_world.episodes import Episode, run
from benchmarks.map_world.policies import POLICIES
from benchmarks.report import RESULTS, write_report
from experiments.tables.parts import as_csv, plain
from legpush.files import write_whole

REAL: Final = "mujoco"
MAPS: Final = ("map", "map_mean")
MEASURES: Final = ("position_error_m", "angle_error_deg")
FIRST_SEED: Final = 7_300_000
N_RESAMPLES: Final = 2000


@dataclass(frozen=True, kw_only=True)
class Config:
    """How much to measure."""

    n_starts: int = 20
    """Starts of each policy in each world."""
    workers: int = 2
    """Processes."""


def main(config: Config) -> None:
    """Run all episodes and report the numbers."""
    seeds = range(FIRST_SEED, FIRST_SEED + config.n_starts)
    jobs = list(product(POLICIES, seeds, (REAL, *MAPS)))
    with ProcessPoolExecutor(config.workers, mp_context=get_context("spawn")) as pool:
        episodes = list(pool.map(run, *zip(*jobs, strict=True), chunksize=len(MAPS) + 1))
    rows = [{name: _short(getattr(e, name)) for name in COLUMNS} for e in episodes]
    write_whole(RESULTS / "map_world_agreement.csv", as_csv(rows).encode())
    write_report("map_world_agreement", report_of(episodes))


COLUMNS: Final = (
    "policy",
    "seed",
    "world",
    "ending",
    "position_error_m",
    "angle_error_deg",
    "n_cycles",
    "x_m",
    "y_m",
    "yaw_deg",
)
"""Of the table of episodes."""


def report_of(episodes: Sequence[Episode]) -> dict[str, Any]:
    """Return all numbers of the report."""
    real = [episode for episode in episodes if episode.world == REAL]
    return {
        "n_policies": len({e.policy for e in real}),
        "n_starts": len({e.seed for e in real}),
        "n_episodes": len(real),
        "one_push": {"all": one_push(real), **{name: one_push(_of(real, policy=name)) for name in _names(real)}},
        "worlds": {world: _compared(episodes, world) for world in MAPS},
    }


def one_push(episodes: Iterable[Episode]) -> dict[str, Any]:
    """Return bias and root mean square of the error of the map in single pushes of the simulator."""
    episodes = list(episodes)
    errors = np.array([error for e in episodes for error in e.push_errors]) * (1000.0, 1000.0, degrees(1.0))
    within = [inside for e in episodes for inside in e.within]
    names = ("forward_mm", "left_mm", "turn_deg")
    return {
        "n": len(errors),
        "bias": dict(zip(names, errors.mean(axis=0).round(4).tolist(), strict=True)),
        "rms": dict(zip(names, np.sqrt((errors**2).mean(axis=0)).round(4).tolist(), strict=True)),
        "within_95_percent": round(float(np.mean(within)), 4),
    }


def _compared(episodes: Sequence[Episode], world: str) -> dict[str, Any]:
    """Compare ends and order of the policies in a map with those in the simulator."""
    policies = {name: _ends(_of(episodes, policy=name), world) for name in _names(episodes)}
    return {"policies": policies, "order": {name: order(episodes, world, name) for name in MEASURES}}


def _ends(episodes: Sequence[Episode], world: str) -> dict[str, Any]:
    """Compare how the episodes of one policy end."""
    real, mapped = (sorted(_of(episodes, world=name), key=lambda e: e.seed) for name in (REAL, world))
    apart_m = [float(np.hypot(a.x_m - b.x_m, a.y_m - b.y_m)) for a, b in zip(real, mapped, strict=True)]
    found: dict[str, Any] = {
        "ends_apart_m": {"median": _short(float(np.median(apart_m))), "largest": _short(max(apart_m))},
        "n_cycles": [_short(float(np.mean([e.n_cycles for e in part]))) for part in (real, mapped)],
        "done": [plain(share(sum(e.ending == "done" for e in part), len(part)), 3) for part in (real, mapped)],
    }
    for name in MEASURES:
        values: list[list[float]] = [[getattr(e, name) for e in part] for part in (real, mapped)]
        same = stats.ks_2samp(values[0], values[1])
        found[name] = {
            "simulator": plain(mean(values[0]), 5),
            "map": plain(mean(values[1]), 5),
            "map_minus_simulator": plain(paired_difference(*map(_by_index, reversed(values))), 5),
            "quantiles": [np.quantile(part, (0.1, 0.5, 0.9)).round(5).tolist() for part in values],
            "kolmogorov_smirnov": {"distance": _short(float(same.statistic)), "p": _short(float(same.pvalue))},
        }
    return found


def order(episodes: Sequence[Episode], world: str, measure: str) -> dict[str, Any]:
    """Return the rank correlation of the policies' means in two worlds, and the pairs that have another order."""
    names = _names(episodes)
    real, mapped = (_table(_of(episodes, world=name), names, measure) for name in (REAL, world))
    pairs = list(combinations(range(len(names)), 2))
    other = [pair for pair in pairs if _differs(real, *pair) * _differs(mapped, *pair) < 0.0]
    sure = [(a, b) for a, b in other if all(_is_sure(table, a, b) for table in (real, mapped))]
    return {
        "spearman": plain(rank_correlation(real, mapped), 4),
        "simulator": [names[index] for index in np.argsort(real.mean(axis=0), kind="stable")],
        "map": [names[index] for index in np.argsort(mapped.mean(axis=0), kind="stable")],
        "n_pairs": len(pairs),
        "in_another_order": [[names[a], names[b]] for a, b in other],
        "of_these_beyond_chance": [[names[a], names[b]] for a, b in sure],
    }


def rank_correlation(real: Any, mapped: Any) -> Estimate:
    """Return Spearman's rank correlation of the means over starts; both worlds are (starts, policies)."""

    def correlation(index: Any) -> float:
        return float(stats.spearmanr(real[index].mean(axis=0), mapped[index].mean(axis=0)).statistic)

    starts = np.arange(len(real))
    found = stats.bootstrap(
        (starts,), correlation, vectorized=False, n_resamples=N_RESAMPLES, method="percentile", rng=0
    ).confidence_interval
    kind = "percentile bootstrap 95 % over starts"
    return Estimate(value=correlation(starts), low=float(found.low), high=float(found.high), kind=kind, n=len(starts))


def _differs(table: Any, a: int, b: int) -> float:
    return float(table[:, a].mean() - table[:, b].mean())


def _is_sure(table: Any, a: int, b: int) -> bool:
    """Whether the interval of the difference of two policies from equal starts leaves out zero."""
    difference = paired_difference(_by_index(table[:, a]), _by_index(table[:, b]))
    return difference.low is not None and difference.high is not None and difference.low * difference.high > 0.0


def _by_index(values: Iterable[float]) -> Mapping[int, float]:
    return dict(enumerate(map(float, values)))


def _table(episodes: Sequence[Episode], names: Sequence[str], measure: str) -> Any:
    """A measure by start and policy, (starts, policies)."""
    columns = [[getattr(e, measure) for e in sorted(_of(episodes, policy=n), key=lambda e: e.seed)] for n in names]
    return np.array(columns).T


def _of(episodes: Iterable[Episode], **fields: str) -> list[Episode]:
    return [e for e in episodes if all(getattr(e, name) == value for name, value in fields.items())]


def _names(episodes: Iterable[Episode]) -> list[str]:
    return list(dict.fromkeys(e.policy for e in episodes))


def _short(value: Any) -> Any:
    return round(value, 6) if isinstance(value, float) else value


if __name__ == "__main__":
    main(tyro.cli(Config))
