"""Reports on phases, made by hand."""

from legpush.messages.measures import UnexpectedContact
from legpush.runs.report import OfJoints, PhaseReport

WALKING = PhaseReport(
    n_steps=12_000,
    n_footsteps=40,
    max_torque_n_m=OfJoints(hip_x=21.4, hip_y=35.2, knee=49.6),
    usual_torque_n_m=OfJoints(hip_x=18.0, hip_y=31.0, knee=45.0),
    max_speed_rad_s=OfJoints(hip_x=0.44, hip_y=8.61, knee=6.72),
    max_power_w=OfJoints(hip_x=5.0, hip_y=190.0, knee=92.0),
    share_at_torque_limit=0.00125,
    least_to_joint_limit_deg=-0.5,
    energy_j=1504.2,
    travel_m=9.6,
    cost_of_transport=0.503,
    min_support_margin_m=-0.004,
    n_outside_support=17,
    min_zmp_margin_m=0.021,
    min_capture_margin_m=-0.035,
    max_push_moment_n_m=None,
    touchdowns_per_footstep=1.04,
    loadings_per_footstep=1.0,
    usual_landing_speed_m_s=0.149,
    max_landing_speed_m_s=0.2,
    max_penetration_m=0.0009,
    n_unexpected_steps=6,
    unexpected=(UnexpectedContact(first="FL_lower", second="wall_0", n_steps=6, max_force_n=12.3),),
)
