"""What the actions of a task are: their form, and the depths of their pushes."""

from typing import Annotated, Literal

from msgspec import Meta, Struct

from legpush.bounds import MAX_DEPTH_M
from legpush.errors import ConfigError

PushDepth = Annotated[float, Meta(gt=0.0, le=MAX_DEPTH_M)]


class ActionConfig(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """The actions of a task."""

    entry: Literal["fixed", "variable"] = "variable"
    """Whether the depth of a push is always the same or part of the action."""
    action_form: Literal["continuous", "discrete"] = "continuous"
    """Numbers in [-1, 1], or the published grid of w1, w2 and leg (fixed entry only)."""
    mirrored: bool = False
    """Whether the policy sees and chooses in the mirror image if the box is right of the line through its goal; every
    term of the observation must have a mirror image."""
    fixed_depth_m: PushDepth = 0.05
    """Depth of every push with fixed entry."""
    least_depth_m: PushDepth = 0.005
    """Depth of the shallowest push with variable entry."""
    max_depth_m: PushDepth = 0.10
    """Depth of the deepest push with variable entry."""
    limit_depth: bool = True
    """With variable entry: whether the deepest push is at most the one that brings the box up to its goal."""
    changes_face: bool = False
    """Whether an action also chooses the face to push; the robot walks around the box to another one first."""

    def __post_init__(self) -> None:
        """Check that form, entry and depths fit one another.

        Raises:
            ConfigError: They do not.
        """
        if self.action_form == "discrete" and self.entry != "fixed":
            raise ConfigError(
                "Expected entry `fixed` with action_form `discrete`: its grid has no depth, got `variable`"
            )
        if self.action_form == "discrete" and self.changes_face:
            raise ConfigError("Expected no `changes_face` with action_form `discrete`: its grid has no face")
        for name in ("fixed_depth_m", "least_depth_m", "max_depth_m"):
            depth_m = getattr(self, name)
            if not 0.0 < depth_m <= MAX_DEPTH_M:
                raise ConfigError(f"Expected {name} in (0, {MAX_DEPTH_M}], got {depth_m}")
        if not self.least_depth_m <= self.max_depth_m:
            raise ConfigError(f"Expected least_depth_m <= max_depth_m, got {self.least_depth_m} and {self.max_depth_m}")
