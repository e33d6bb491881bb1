"""An estimate: a number, its 95 % interval, and how the interval was computed."""

from collections.abc import Iterable
from dataclasses import dataclass, replace
from math import inf, nan
from typing import Any, Final

EQUAL: Final = "all values equal"
CUT: Final = "cut to what is possible"
NO_INTERVAL: Final = "no interval"
"""Begin of the kinds of estimates without an interval; the reason follows."""


@dataclass(frozen=True, kw_only=True)
class Estimate:
    """A statistic of a sample with its 95 % interval."""

    value: float
    """Nan if there are no values, or if one of them is nan."""
    low: float | None
    high: float | None
    """Ends of the interval; both are None if there is no interval, and then `kind` says why."""
    kind: str
    """How the interval was computed, such as `Wilson 95 %`."""
    n: int
    """Number of values, pairs or groups."""

    @property
    def ends(self) -> tuple[float, float]:
        """Low and high for a plot: nan, which is not drawn, if there is no interval."""
        return (nan, nan) if self.low is None or self.high is None else (self.low, self.high)

    def scaled(self, factor: float) -> "Estimate":
        """In another unit; the factor is positive."""
        low, high = (None if end is None else factor * end for end in (self.low, self.high))
        return replace(self, value=factor * self.value, low=low, high=high)

    def cut(self, least: float, most: float = inf) -> "Estimate":
        """Without the part of the interval that is not possible, such as errors below 0; then its kind says so.

        Student's interval of few values may reach there, because it is as long to both sides.
        """
        if self.low is None or self.high is None or (least <= self.low and self.high <= most):
            return self
        return replace(self, low=max(self.low, least), high=min(self.high, most), kind=f"{self.kind}, {CUT}")

    def rounded(self, n_digits: int) -> "Estimate":
        """With value and interval rounded."""
        low, high = (None if end is None else round(end, n_digits) for end in (self.low, self.high))
        return replace(self, value=round(self.value, n_digits), low=low, high=high)

    def columns(self, name: str, n_digits: int) -> dict[str, Any]:
        """Cells of a table: `name`, `name_low`, `name_high`, `name_interval` (its kind) and `name_n`."""
        short = self.rounded(n_digits)
        return {
            name: short.value,
            f"{name}_low": short.low,
            f"{name}_high": short.high,
            f"{name}_interval": short.kind,
            f"{name}_n": short.n,
        }

    def __format__(self, spec: str) -> str:
        """Such as `0.19 [0.17, 0.22]` for the format `.2f`; `0.19 [-]` without an interval."""
        if self.low is None or self.high is None:
            return f"{self.value:{spec}} [-]"
        return f"{self.value:{spec}} [{self.low:{spec}}, {self.high:{spec}}]"

    def text(self, spec: str) -> str:
        """Such as `0.19 [0.17, 0.22] (Student's t 95 %, n 20)`."""
        return f"{self:{spec}} ({self.kind}, n {self.n})"


def kinds_in_words(kinds: Iterable[str]) -> str:
    """The kinds of the intervals of a table or picture, each once, without those that have no length.

    A cut one counts as the kind that it was.
    """
    named = dict.fromkeys(
        kind.removesuffix(f", {CUT}") for kind in kinds if kind != EQUAL and not kind.startswith(NO_INTERVAL)
    )
    return " or ".join(named) or NO_INTERVAL
