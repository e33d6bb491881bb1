"""Progress in tolerances, positive or negative, and bonuses for the end.

Progress is the difference of a potential, so a way there and back earns nothing. Its sum is bounded by the errors at
the start. A fall takes it all back.
"""

from math import degrees, exp
from typing import Annotated

from msgspec import Meta

from agent_proc.frames.poses import box_error
from agent_proc.frames.push_view import PushView
from agent_proc.task.term import PushStep, RewardTerm
from legpush.bounds import MAX_FACTOR
from legpush.scene.conventions import CONTROL_PERIOD_S

Decay = Annotated[float, Meta(ge=0.0, le=MAX_FACTOR)]


def errors_in_tolerances(view: PushView) -> tuple[float, float]:
    """Errors of position and angle, each as a multiple of its tolerance."""
    error, goal = view.error, view.goal
    return error.position_m / goal.position_tolerance_m, degrees(error.angle_rad) / goal.angle_tolerance_deg


def steering_in_tolerances(view: PushView) -> float:
    """Steering error as a multiple of the tolerance of the angle."""
    return abs(degrees(view.steering_error_rad)) / view.goal.angle_tolerance_deg


def _since(step: PushStep) -> PushView:
    """The view up to which progress counts: a fall is back at the start."""
    return step.first if step.after.fallen else step.after


class PositionProgress(RewardTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Tolerances of the position by which the error shrinks."""

    def value(self, step: PushStep) -> float:
        """Error before, less error after."""
        return errors_in_tolerances(step.before)[0] - errors_in_tolerances(_since(step))[0]


class SteeringProgress(RewardTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Tolerances of the angle by which the steering error shrinks: shows at once whether the leg was the right one."""

    def value(self, step: PushStep) -> float:
        """Error before, less error after."""
        return steering_in_tolerances(step.before) - steering_in_tolerances(_since(step))


class GoalProgress(RewardTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Metres by which the box comes nearer to the goal of its scenario, in a straight line."""

    def value(self, step: PushStep) -> float:
        """Distance before, less distance after."""
        before, after = (box_error(view.world, view.scenario).position_m for view in (step.before, _since(step)))
        return before - after


class Cycle(RewardTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """1 for each push cycle."""

    def value(self, step: PushStep) -> float:
        """1."""
        return 1.0


class Time(RewardTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Simulated seconds of the step: a push cycle takes about 3 s, a walk to another face 20 to 30 s more."""

    def value(self, step: PushStep) -> float:
        """The seconds."""
        return (step.after.world.tick - step.before.world.tick) * CONTROL_PERIOD_S


class Success(RewardTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """1 if the episode arrives within the tolerances; else 0."""

    def value(self, step: PushStep) -> float:
        """1 or 0."""
        return 1.0 if step.ending == "success" else 0.0


class Precision(RewardTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """1 if the episode arrives without any error; decays with both errors."""

    position_decay: Decay = 2.0
    """Per tolerance of the position."""
    angle_decay: Decay = 3.0
    """Per tolerance of the angle."""

    def value(self, step: PushStep) -> float:
        """From 0 to 1."""
        if not step.arrived:
            return 0.0
        position, angle = errors_in_tolerances(_since(step))
        return exp(-self.position_decay * position - self.angle_decay * angle)


class Fall(RewardTerm, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """1 if the robot has fallen; else 0."""

    def value(self, step: PushStep) -> float:
        """1 or 0."""
        return 1.0 if step.after.fallen else 0.0
