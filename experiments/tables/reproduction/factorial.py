"""The factorial of four causes, and the ladder from the published code to the tuned profile."""

from collections.abc import Sequence
from statistics import mean
from typing import Any, Final

from experiments.rows import Row
from experiments.tables.reproduction.summaries import grouped, training_numbers

FACTORS: Final = ("ending", "observation", "normalize_observation", "n_steps")
"""Columns of the factorial that differ; the size of a batch follows the number of steps between updates."""
PRINTED: Final = ("paper-text", "paper-text", False, 2048)
"""The combination of the paper."""
CHANGED: Final = ("paper-learns", "paper-learns", True, 256)
"""The other level of each factor."""
NAMES: Final = ("end", "frame", "normalization", "updates")
"""Names of the factors in tables and pages."""
KEPT: Final = ("paper-learns", "paper-text", True, 256)
"""Everything is changed but the frame of the observation."""
CHANGES: Final = (
    "the published code",
    "the paper's observation, read at every step",
    "the paper's reward",
    "continuous actions",
    "ReLU, as in the paper",
    "starts that vary",
    "an end within the tolerances or past the goal",
    "normalized observation",
    "32 updates instead of 4, batches of 64",
    "the goal's frame instead of the world",
    "progress as reward",
    "an end where no push helps",
    "settings of the profile `tuned`",
    "a depth that the policy chooses",
)
"""What each rung of the ladder changes of the one before."""
FAR_M: Final = 1.0
"""A policy with a larger mean error pushes the box away: the way is 1 m."""
N_FIRST: Final = 5
"""Rungs of the ladder before those that the factorial has."""
BETWEEN: Final[tuple[tuple[Any, ...], ...]] = (
    ("release", "paper-text", False, 2048),
    ("paper-learns", "paper-text", False, 2048),
    ("paper-learns", "paper-text", True, 2048),
    KEPT,
    CHANGED,
)
"""Rungs that are combinations of the factorial."""


def combination(row: Row) -> tuple[Any, ...]:
    """Return the levels of the factors."""
    return tuple(row[name] for name in FACTORS)


def rungs(ladder: Sequence[Row], factorial: Sequence[Row]) -> list[tuple[str, list[Row]]]:
    """Return what each rung changes, and its trainings."""
    own = list(grouped(ladder, _settings).values())
    cells = grouped(factorial, combination)
    rows = [*own[:N_FIRST], *(cells[levels] for levels in BETWEEN), *own[N_FIRST:]]
    return list(zip(CHANGES, rows, strict=True))


def _settings(row: Row) -> tuple[Any, ...]:
    names = ("profile", "observation", "reward", "actions", "ending", "entry")
    return tuple(row[name] for name in names)


def causes(factorial: Sequence[Row]) -> dict[str, Any]:
    """Return, for each factor: the paper with this change alone, and everything changed but this.

    For a factor other than the frame, the latter keeps the paper's observation: in the goal's frame, little depends
    on the others.
    """
    cells = grouped(factorial, combination)
    found: dict[str, Any] = {}
    for place, name in enumerate(NAMES):
        alone, without = list(PRINTED), list(CHANGED if name == "frame" else KEPT)
        alone[place], without[place] = CHANGED[place], PRINTED[place]
        found[name] = {
            "alone": training_numbers(cells[tuple(alone)]),
            "without": training_numbers(cells[tuple(without)]),
        }
    return found


def parts(factorial: Sequence[Row]) -> dict[str, Any]:
    """Return, over all trainings with an end at the goal or without, how the worst or the best one does."""
    shares = [(row, _share(row)) for row in factorial]
    frame = [(row, share) for row, share in shares if row["observation"] == "paper-learns"]
    with_end = [share for row, share in frame if row["ending"] != "paper-text"]
    without_end = [row for row, _ in frame if row["ending"] == "paper-text"]
    measured = [
        share for row, share in shares if row["observation"] == "paper-text" and not row["normalize_observation"]
    ]
    return {
        "frame_with_end": {"n": len(with_end), "least_success": min(with_end), "largest_success": max(with_end)},
        "frame_without_end": {
            "n": len(without_end),
            "n_pushed_away": sum(mean(row["final_position_error_m"]) > FAR_M for row in without_end),
        },
        "world_as_measured": {"n": len(measured), "largest_success": max(measured)},
    }


def _share(row: Row) -> float:
    return round(float(mean(row["final_success"])), 4)


def by_level(factorial: Sequence[Row]) -> dict[str, Any]:
    """Return the numbers of each combination, level within level: end, frame, `raw` or `normalized`, steps."""
    found: dict[str, Any] = {}
    for (ending, frame, normalized, n_steps), rows in grouped(factorial, combination).items():
        place = found.setdefault(ending, {}).setdefault(frame, {}).setdefault("normalized" if normalized else "raw", {})
        place[str(n_steps)] = training_numbers(rows)
    return found
