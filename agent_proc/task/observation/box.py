"""What is known of the box: its sides, and what its pushes up to now have shown."""

from typing import ClassVar, Final

import numpy as np

from agent_proc.frames.push_view import PushView
from agent_proc.task.term import ObservationTerm
from legpush.arrays import Floats
from legpush.bounds import MAX_BOX_SIDE_M, MAX_DEPTH_M
from legpush.messages.common import USUAL_DEPTH_M
from legpush.scene.scenario import Scenario

MOST_DRIFT: Final = 1.0
"""Bound of each element of a drift or an effect, far beyond what a push does."""


class BoxSides(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Length and width of the box, seen from the robot."""

    AXES: ClassVar[tuple[str, ...]] = ("length", "width")
    FRAME: ClassVar[str] = ""
    HAS_MIRROR_IMAGE: ClassVar[bool] = True

    def meaning(self) -> str:
        """What the elements are."""
        return "sides of the box along the pushing direction and across it"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The sides, (2,)."""
        return np.array(view.box.size_m[:2])

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """From nothing to the longest side."""
        return np.zeros(2), np.full(2, MAX_BOX_SIDE_M)


class LostDepth(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How much deeper this box has to be pushed than the default one, by its pushes up to now."""

    AXES: ClassVar[tuple[str, ...]] = ("depth",)
    FRAME: ClassVar[str] = ""
    HAS_MIRROR_IMAGE: ClassVar[bool] = True
    FEELS_BOX: ClassVar[bool] = True

    def meaning(self) -> str:
        """What the element is."""
        return "depth that the box loses of a push before it moves, by its pushes up to now"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The depth, (1,)."""
        return np.array([view.lost_depth_m])

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """From nothing to the deepest push."""
        return np.zeros(1), np.full(1, MAX_DEPTH_M)


class PushEffect(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What a push of the usual depth would do to this box, by its pushes up to now: all that a fit of them says."""

    AXES: ClassVar[tuple[str, ...]] = ("forward", "forward_other", "turn", "turn_other")
    UNIT: ClassVar[str] = "m, m, rad, rad"
    FRAME: ClassVar[str] = "pushed"
    HAS_MIRROR_IMAGE: ClassVar[bool] = True
    FEELS_BOX: ClassVar[bool] = True

    def meaning(self) -> str:
        """What the elements are."""
        return (
            "how far a push of 5 cm moves and turns the box, by its pushes up to now: one with the left leg, and the "
            "mirror image of one with the right leg"
        )

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """Forward of both legs and turn of both legs, (4,); what is lost of the depth is not counted."""
        response = view.response
        legs = response.curves if mirror_sign > 0.0 else response.curves[::-1]
        rows = (*(leg.forward_m for leg in legs), *(leg.turn_rad for leg in legs))
        return np.array([np.interp(USUAL_DEPTH_M, response.depth_m, row) for row in rows])

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """Far beyond what a push does."""
        return np.full(4, -MOST_DRIFT), np.full(4, MOST_DRIFT)


class PushDrift(ObservationTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the last pushes did beyond what the push model expects: a slope or an uneven load shows here."""

    AXES: ClassVar[tuple[str, ...]] = ("forward", "left", "turn")
    UNIT: ClassVar[str] = "m, m, rad"
    FRAME: ClassVar[str] = "pushed"
    HAS_MIRROR_IMAGE: ClassVar[bool] = True
    FEELS_BOX: ClassVar[bool] = True

    def meaning(self) -> str:
        """What the elements are."""
        return "mean displacement of the last pushes beyond that of the push model; the last one counts most"

    def read(self, view: PushView, mirror_sign: float) -> Floats:
        """The drift, (3,)."""
        return np.array([1.0, mirror_sign, mirror_sign]) * view.drift

    def limits(self, scenario: Scenario) -> tuple[Floats, Floats]:
        """Far beyond what a push does."""
        return np.full(3, -MOST_DRIFT), np.full(3, MOST_DRIFT)
