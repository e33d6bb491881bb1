"""Missions by their seeds: measures of those that succeeded, and why the others did not."""

from collections import Counter
from collections.abc import Sequence

from experiments.rows import Row


def of_successes(rows: Sequence[Row], name: str) -> dict[int, float]:
    """Return a measure of the successful missions by their seeds."""
    return {row["seed"]: float(row[name]) for row in rows if row["success"]}


def failures(rows: Sequence[Row]) -> str:
    """Return how many missions failed for each reason, such as `1 x fell, 4 x no_path`."""
    reasons = Counter(row["reason"] for row in rows if not row["success"])
    return ", ".join(f"{n} x {reason}" for reason, n in sorted(reasons.items())) or "none"
