"""Which boxes a robot cannot push, whatever decides about its pushes: bounds of quasi-static forces.

A box that is excluded here cannot be pushed. One that is not may still be too heavy: the bounds leave out how the feet
share the force and what moving legs take.
"""

from math import cos, hypot, radians, sin

from legpush.scene.conventions import GRAVITY_M_S2
from legpush.scene.faces import PUSHABLE, pushed_box, pushed_com_m
from legpush.scene.names import Face
from legpush.scene.robot import RobotSpec
from legpush.scene.scenario import Box, Scenario


def contact_height_m(robot: RobotSpec, box: Box, face: Face) -> float:
    """Height of the contact point: within reach of the leg, and low enough that a sliding box does not tip.

    Friction with the floor holds a sliding box back by the same share of its weight whatever its mass. The box tips
    over its front edge if it is pushed above the distance from its centre of mass to that edge, along the push, divided
    by the friction coefficient with the floor.
    """
    length, _, height = pushed_box(box, face).size_m
    to_edge_m = length / 2 - pushed_com_m(box, face)[0]
    motion = robot.pushing
    tips_m = motion.tip_share * to_edge_m / box.friction
    reach_m = motion.reach_height_share * robot.stance.height_m
    return max(min(motion.contact_height_share * height, tips_m, reach_m), 2 * robot.legs.foot_radius_m)


def least_force_n(robot: RobotSpec, box: Box, face: Face, slope_deg: float) -> float:
    """The least force forward with which a foot can move a box, down the slope of the floor.

    It pushes beside the middle, and friction lets it push outward as well, so that the box turns as it slides. Then its
    friction with the floor bears force and moment on an ellipsoid (`(F / f)^2 + (M / (c f))^2 = 1`, with `f` that of
    sliding straight). `c` is the distance of the corners from the middle: no even contact bears a larger moment.
    """
    length, width, _ = pushed_box(box, face).size_m
    sliding = max(box.friction * cos(radians(slope_deg)) - sin(radians(slope_deg)), 0.0)
    outward = box.friction_with_robot
    arm_m = robot.pushing.contact_side_share * width + outward * length / 2
    return sliding * box.mass_kg * GRAVITY_M_S2 / hypot(1.0, outward, arm_m / hypot(length / 2, width / 2))


def most_force_n(robot: RobotSpec, box: Box, face: Face) -> float:
    """The largest force forward that the feet can bear by friction, and the hip of the pushing leg by its torque."""
    by_friction = robot.legs.foot_friction * robot.mass_kg * GRAVITY_M_S2
    lever_m = abs(robot.stance.height_m - contact_height_m(robot, box, face))
    by_hip = robot.joints.hip_y.max_torque_n_m / max(lever_m, robot.legs.foot_radius_m)
    return min(by_friction, by_hip)


def cannot_push(scenario: Scenario) -> str | None:
    """Say why no face of the scenario's box can be pushed by its robot; None if one may be."""
    robot, box = scenario.robot, scenario.box
    faces = [face for face in scenario.pushing.faces if face in PUSHABLE[box.shape]]
    forces = [
        (least_force_n(robot, box, face, scenario.room.slope_deg), most_force_n(robot, box, face)) for face in faces
    ]
    if not forces or any(least_n <= most_n for least_n, most_n in forces):
        return None
    least_n, most_n = min(forces, key=lambda pair: pair[0] - pair[1])
    return (
        f"the box of {box.mass_kg:g} kg with friction {box.friction:g} takes at least {least_n:.0f} N to move, and the "
        f"robot can push with {most_n:.0f} N at most"
    )
