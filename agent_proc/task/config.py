"""The configuration of a pushing task: its action, observation, reward and scenarios, as one record."""

from dataclasses import dataclass, field, fields
from typing import Any, Final, Literal

from legpush.bounds import MAX_DEPTH_M, BoxMass, Friction, Length
from legpush.errors import ConfigError
from legpush.fields import require
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Scenario

Interval = tuple[float, float]
"""Lowest and highest value."""
_BOUNDS: Final[dict[str, Any]] = {"mass_kg": BoxMass, "friction": Friction, "distance_m": Length}
"""Type of the values of each interval of a `Domain`."""


@dataclass(frozen=True, kw_only=True)
class Domain:
    """What each episode draws in addition to the offsets of its scenario; None keeps the value of the scenario.

    Draws are uniform, except for the distance, whose logarithm is uniform: as many episodes between 0.1 and 0.2 m as
    between 0.5 and 1 m.
    """

    mass_kg: Interval | None = None
    """Of the box."""
    friction: Interval | None = None
    """Of the box."""
    distance_m: Interval | None = None
    """From the box's nominal place to its goal, in the direction of the scenario. The last pushes are the difficult
    ones, and short distances give more of them."""

    def __post_init__(self) -> None:
        for name in (entry.name for entry in fields(self)):
            interval = getattr(self, name)
            if interval is None:
                continue
            if not 0.0 < interval[0] <= interval[1]:
                raise ConfigError(f"Expected 0 < low <= high for {name} of the domain, got {interval}")
            for value in interval:
                require(_BOUNDS[name], value, f"{name} of the domain")


@dataclass(frozen=True, kw_only=True)
class TaskConfig:
    """A pushing task; saved with every policy that was trained on it."""

    entry: Literal["fixed", "variable"] = "variable"
    """Whether the depth of a push is always the same or part of the action."""
    action_form: Literal["continuous", "discrete"] = "continuous"
    """Numbers in [-1, 1], or the published grid of w1, w2 and leg (fixed entry only)."""
    observation: Literal["paper", "relative"] = "relative"
    """World positions (Eq. 18), or everything relative to goal and box, mirrored so that the box is left of the line;
    the leg of an action is mirrored with it."""
    reward: Literal["paper", "tuned"] = "tuned"
    """Eqs. 15 to 17, or progress in tolerances. `paper` ends an episode within the tolerances, `tuned` as soon as no
    push brings the box nearer."""
    fixed_depth_m: float = 0.05
    """Depth of every push with fixed entry."""
    least_depth_m: float = 0.005
    """Depth of the shallowest push with variable entry."""
    max_depth_m: float = 0.10
    """Depth of the deepest push with variable entry."""
    limit_depth: bool = True
    """With variable entry: whether the deepest push is at most the one that brings the box up to its goal."""
    max_steps: int = 200
    """Push cycles after which an episode is truncated."""
    scenario: Scenario = field(default_factory=lambda: load_scenario("push"))
    """It starts with the robot at its station, and has the drawn offsets and the goal with its tolerances."""
    domain: Domain = Domain()
    """Further quantities that vary from episode to episode."""

    def __post_init__(self) -> None:
        if self.action_form == "discrete" and self.entry != "fixed":
            raise ConfigError(
                "Expected entry `fixed` with action_form `discrete`: its grid has no depth, got `variable`"
            )
        if not 0.0 < self.fixed_depth_m <= MAX_DEPTH_M:
            raise ConfigError(f"Expected fixed_depth_m in (0, {MAX_DEPTH_M}], got {self.fixed_depth_m}")
        if not 0.0 < self.least_depth_m <= self.max_depth_m <= MAX_DEPTH_M:
            raise ConfigError(
                f"Expected 0 < least_depth_m <= max_depth_m <= {MAX_DEPTH_M}, got {self.least_depth_m} and "
                f"{self.max_depth_m}"
            )
        if self.max_steps < 1:
            raise ConfigError(f"Expected at least 1 for max_steps, got {self.max_steps}")

    @property
    def mirrored(self) -> bool:
        """Whether observation and action are mirrored if the box is right of the line."""
        return self.observation == "relative"
