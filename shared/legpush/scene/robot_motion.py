"""How the robot stands, walks and pushes, and when it has fallen. A tick is 0.02 s."""

from math import hypot

import numpy as np
from msgspec import Struct

from legpush.arrays import Floats
from legpush.bounds import (
    BodyDistance,
    BodyLength,
    FallTilt,
    LandingSpeed,
    ReachMargin,
    SideShare,
    StationTurn,
    StepTurn,
    Ticks,
    Unit,
)


class Stance(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the robot stands: its feet at the corners of a rectangle about the trunk's ground projection."""

    foot_rectangle_length_m: BodyLength = 0.5963
    foot_rectangle_width_m: BodyLength = 0.3346
    """The paper's rectangle."""
    height_m: BodyLength = 0.48
    """Height of the trunk's centre above the floor."""
    com_below_trunk_m: BodyDistance = 0.05
    """How far the centre of mass is below the trunk's centre, because the legs hang down."""
    body_front_m: BodyLength = 0.38
    """How far the floor that the robot covers reaches ahead of the trunk's ground projection."""
    body_rear_m: BodyLength = 0.6
    """How far it reaches behind: while the robot walks, its knees go farther back than its feet."""
    body_width_m: BodyLength = 0.44
    """Width of that floor."""

    def __post_init__(self) -> None:
        """Check that the centre of mass is above the floor.

        Raises:
            ValueError: It is not.
        """
        if not self.com_below_trunk_m < self.height_m:
            raise ValueError(f"Expected com_below_trunk_m < height_m, got {self.com_below_trunk_m} and {self.height_m}")

    @property
    def foot_circle_m(self) -> float:
        """Radius of the circle through the four feet."""
        return hypot(self.foot_rectangle_length_m, self.foot_rectangle_width_m) / 2

    @property
    def body_circle_m(self) -> float:
        """Radius of the circle about the trunk's ground projection that covers the robot at any heading."""
        return hypot(max(self.body_front_m, self.body_rear_m), self.body_width_m / 2)

    @property
    def com_height_m(self) -> float:
        """Height of the centre of mass."""
        return self.height_m - self.com_below_trunk_m

    def foot_rectangle_b(self) -> Floats:
        """Return the corners in the ground-projected body frame, (4, 2), in the order of `LEGS`."""
        half_length, half_width = self.foot_rectangle_length_m / 2, self.foot_rectangle_width_m / 2
        return np.array(
            [
                [half_length, half_width],
                [half_length, -half_width],
                [-half_length, half_width],
                [-half_length, -half_width],
            ]
        )


class Gait(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the robot walks."""

    stride_m: BodyLength = 0.4
    """Largest advance of the trunk in a gait cycle."""
    max_step_m: BodyLength = 0.48
    """Largest step of a foot."""
    max_turn_rad: StepTurn = 0.6
    """Largest change of heading in a gait cycle."""
    step_height_m: BodyLength = 0.05
    """How high a foot is lifted."""
    landing_speed_m_s: LandingSpeed = 0.08
    """How fast a foot comes down at the end of a swing."""
    landing_ticks: Ticks = 2
    """Last part of the swing, in which it moves down at this speed."""
    contact_share: Unit = 0.05
    """A swinging foot that feels this share of the robot's weight is down, and its swing ends."""
    search_speed_m_s: LandingSpeed = 0.3
    """How fast a foot that did not meet the floor goes on down, after a slow beginning."""
    search_depth_m: BodyDistance = 0.05
    """How far below the end of its swing a foot looks for the floor."""
    press_m: BodyDistance = 0.001
    """How far a landing foot is commanded into the floor."""
    shift_ticks: Ticks = 6
    """Time to shift the weight before a foot is lifted."""
    swing_ticks: Ticks = 13
    """Time that a foot is in the air."""
    first_shift_ticks: Ticks = 16
    """Shift before the first step of a path. A quicker start from standing would unload a standing foot."""
    settle_ticks: Ticks = 24
    """Time after the last step to bring the weight back to the middle."""
    ramp_ticks: Ticks = 5
    """Time to load or unload a foot."""
    landed_share: Unit = 0.15
    """Share of its full load planned for a foot that lands."""
    reanchor_ticks: Ticks = 6
    """Time over which the joints follow a correction by measured feet."""
    margin_m: BodyDistance = 0.055
    """Wanted distance of the zero-moment point inside the support polygon while a foot is in the air."""
    least_margin_m: BodyDistance = 0.01
    """A foot is lifted once the projection of the centre of mass is planned to stay this far inside the polygon."""
    max_off_m: BodyLength = 0.35
    """Largest distance from the trunk to the start of a path, or to the place to push from. The first steps to a place
    farther away would be out of reach."""
    max_off_deg: StationTurn = 45.0
    """Largest turn from the trunk to such a place."""

    def __post_init__(self) -> None:
        """Check that a foot can step as far as the trunk advances.

        Raises:
            ValueError: It cannot.
        """
        if not self.stride_m <= self.max_step_m:
            raise ValueError(f"Expected stride_m <= max_step_m, got {self.stride_m} and {self.max_step_m}")


class PushMotion(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the robot stands at the box and pushes it."""

    gap_m: BodyDistance = 0.12
    """Distance from the hips of the front legs to the rear face of the box when the robot stands ready to push."""
    stand_off_m: BodyLength = 0.75
    """Distance from the trunk centre to that face at the end of the walk: there the box can still count as an
    obstacle."""
    contact_height_share: Unit = 0.5
    """Height of the contact point, as a share of the height of the box."""
    reach_height_share: Unit = 0.42
    """Greatest height of the contact point, as a share of the standing height."""
    tip_share: Unit = 0.8
    """Greatest height of the contact point, as a share of the height above which a box tips instead of sliding."""
    reach_margin_deg: ReachMargin = 1.0
    """A push is refused if the pushing leg, with all its joints this far from their limits, would leave the curve at
    the box by more than the radius of its foot."""
    contact_side_share: SideShare = 0.3
    """Distance of the contact point from the middle of the face, to the left (FL) or right (FR), as a share of the
    width of the box."""
    at_station_m: BodyLength = 0.15
    """Largest distance from the station at which the robot may push; each push cycle ends at the station."""
    at_station_deg: StationTurn = 15.0
    """Largest turn from the station at which it may push."""
    least_back_m: BodyDistance = 0.2
    """Least distance that the robot steps back from a face before it walks to another one."""
    most_back_m: BodyDistance = 1.2
    """Largest distance that it steps back."""
    calibration_push_m: BodyLength = 0.06
    """Largest distance by which one push of a calibration moves the box."""
    margin_m: BodyDistance = 0.06
    """Wanted distance of the zero-moment point inside the support polygon while a foot is in the air."""
    shift_ticks: Ticks = 14
    """Time to shift the weight before the push."""
    push_ticks: Ticks = 48
    """Time of the push of a light box."""
    heavy_share: Unit = 0.03
    """A box is heavy if it takes more than this share of the robot's weight to slide it. With 1, none is."""
    most_force_share: Unit = 0.5
    """Largest force that is planned for a push, as a share of what the friction of the feet can bear."""
    heavy_margin_m: BodyDistance = 0.09
    """Wanted distance of the zero-moment point inside the support polygon in the push of a heavy box."""
    approach_ticks: Ticks = 20
    """Time in which the foot comes up to a heavy box and rests at it."""
    press_ticks: Ticks = 44
    """Time in which it presses the box ahead."""
    unload_ticks: Ticks = 10
    """Time in which the force goes before the foot returns."""
    return_ticks: Ticks = 18
    """Time to return the foot to the floor."""
    restep_shift_ticks: Ticks = 8
    """Time to shift the weight before each step to the box."""
    restep_swing_ticks: Ticks = 13
    """Time of each of these steps."""


class RoughGait(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How the robot steps where its feet have found that the floor is not level."""

    from_m: BodyDistance = 0.01
    """A foot that stands this much above or below the level floor makes it rough."""
    missed_m: BodyDistance = 0.05
    """So does a foot that comes down this far from its place. It then steps once more."""
    step_height_m: BodyLength = 0.08
    """How high a foot is lifted above the highest one."""
    near_m: BodyDistance = 0.02
    """From this height above the highest foot on it comes down slowly, until it feels the floor."""
    descent_m_s: LandingSpeed = 0.25
    """How fast it does."""
    below_m: BodyDistance = 0.04
    """How far below the lowest foot its swing ends. From there on it looks for the floor."""
    flight_ticks: Ticks = 16
    """Time of the swing before the slow descent."""
    back_m: BodyDistance = 0.06
    """How much nearer a foot steps if an edge holds its leg."""
    slip_m: BodyDistance = 0.012
    """A standing foot that sinks by this much has slipped off an edge. Then a foot in the air is put down at once."""
    reflex_m_s: LandingSpeed = 0.5
    """How fast."""
    climb_m_s: LandingSpeed = 0.1
    """How fast the trunk follows the mean height of the feet."""


class Capture(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """How far the robot may be from its plan. Beyond that it takes capture steps until it stands.

    It trots: two diagonal feet stand while the other two step to where they can stop the trunk (capture steps).
    """

    from_m: BodyDistance = 0.06
    """The divergent component of its motion is at most this far from the plan, beyond the usual; else it trots."""
    pressing_share: Unit = 0.06
    """While a foot presses the box with more than this share of the robot's weight, it does not trot: the box moves the
    robot then, and would do so again."""
    more_m: BodyDistance = 0.02
    """How much more is allowed after a trot."""
    late_m: BodyDistance = 0.01
    """How much more is allowed for each tick by which motions are later than planned."""
    most_m: BodyDistance = 0.15
    """The most that is ever allowed."""
    small_m: BodyDistance = 0.025
    """Without a larger deviation nothing is late."""
    forget_ticks: Ticks = 100
    """Time constant with which it allows less again."""
    adapt_ticks: Ticks = 100
    """Time constant with which it learns how far it usually is from its plans."""
    step_ticks: Ticks = 9
    """Time of one step of two feet."""
    step_height_m: BodyLength = 0.07
    """How high these feet are lifted."""
    least_steps: Ticks = 2
    most_steps: Ticks = 16
    """Least and largest number of such steps in one trot."""
    most_trots: Ticks = 3
    """Largest number of trots in a row, each of which ends with an attempt to come to rest."""
    most_cycles: Ticks = 12
    """Largest number of gait cycles back to the box after a trot in a push."""
    brake_share: Unit = 0.5
    """The feet that stand follow the trunk's measured velocity but for this share of it, which they slow down."""
    still_m_s: LandingSpeed = 0.12
    """A trunk that is slower has been stopped."""
    level_deg: FallTilt = 6.0
    """A trunk that is tilted less stands."""
    forward_m: BodyLength = 0.3
    """How far ahead of its corner of the foot rectangle, or behind it, a foot may step."""
    inward_m: BodyDistance = 0.05
    outward_m: BodyLength = 0.42
    """Least and largest distance of a stepping foot from the middle of the trunk, to its own side."""
    apart_m: BodyDistance = 0.12
    """Least distance, across the trunk, from a stepping foot to the other foot at that end of the trunk."""


class FallLimits(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """When the robot has fallen."""

    tilt_deg: FallTilt = 30.0
    """A robot that is tilted more has fallen."""
    height_share: Unit = 0.625
    """A robot whose trunk is lower than this share of its standing height has fallen."""
