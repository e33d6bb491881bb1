"""What was measured of all motions of a phase of a mission, walking or pushing."""

from collections.abc import Iterable, Sequence
from math import degrees, inf
from typing import Final

import numpy as np

from agent_proc.reporting.mission_record import MissionStep
from legpush.arrays import Floats
from legpush.messages.measures import Measures, UnexpectedContact, merged, torque_quantiles
from legpush.runs.report import OfJoints, PhaseReport
from legpush.scene.conventions import CONTROL_PERIOD_S, GRAVITY_M_S2, JOINTS
from legpush.scene.robot import RobotSpec

USUAL_TORQUES: Final = 0.999
USUAL_LANDINGS: Final = 0.99
"""Shares that are below the quantiles of a report."""
TRAVEL_TICKS: Final = 50
"""Ways are measured from second to second, so that the sway of each step does not count."""


def phase_report(steps: Sequence[MissionStep], robot: RobotSpec) -> PhaseReport | None:
    """Report on the motions of a phase; None if nothing was measured."""
    measured = [step for step in steps if step.measures is not None]
    total = merged(step.measures for step in measured if step.measures is not None)
    if total is None:
        return None
    travelled_m = sum(travel_m(points) for points in _ways(measured))
    weight_n = robot.mass_kg * GRAVITY_M_S2
    largest = _of_joints(total.max_torques_n_m)
    shares = torque_quantiles(total, USUAL_TORQUES)
    usual = {
        name: min(share * joint.max_torque_n_m, getattr(largest, name))
        for name, joint, share in zip(JOINTS, robot.joints.in_order(), shares, strict=True)
    }
    speeds = total.landing_speeds_m_s
    n_samples = total.n_steps * len(total.n_at_torque_limit)
    return PhaseReport(
        n_steps=total.n_steps,
        n_footsteps=total.n_footsteps,
        max_torque_n_m=largest,
        usual_torque_n_m=OfJoints(**usual),
        max_speed_rad_s=_of_joints(total.max_speeds_rad_s),
        max_power_w=_of_joints(total.max_powers_w),
        share_at_torque_limit=sum(total.n_at_torque_limit) / n_samples,
        least_to_joint_limit_deg=degrees(min(total.least_to_limits_rad)),
        energy_j=total.positive_work_j,
        travel_m=travelled_m,
        cost_of_transport=total.positive_work_j / (weight_n * travelled_m) if travelled_m > 0.0 else None,
        min_support_margin_m=total.min_support_margin_m,
        n_outside_support=total.n_outside_support,
        min_zmp_margin_m=total.min_zmp_margin_m,
        min_capture_margin_m=total.min_capture_margin_m,
        max_push_moment_n_m=total.max_push_moment_n_m,
        touchdowns_per_footstep=_per_footstep(total.n_touchdowns, total),
        loadings_per_footstep=_per_footstep(total.n_loadings, total),
        usual_landing_speed_m_s=float(np.quantile(speeds, USUAL_LANDINGS)) if speeds else None,
        max_landing_speed_m_s=max(speeds, default=None),
        max_penetration_m=total.max_penetration_m,
        n_unexpected_steps=total.n_unexpected_steps,
        unexpected=total.unexpected,
    )


def unexpected_notes(steps: Iterable[MissionStep]) -> tuple[str, ...]:
    """A note on the contacts that no plan asked for, if there were any."""
    total = merged(step.measures for step in steps if step.measures is not None)
    if total is None or not total.unexpected:
        return ()
    return (f"unexpected contacts: {', '.join(map(_words, total.unexpected))}",)


def travel_m(points: Floats) -> float:
    """Length of a way through points, (n, 2), one per tick."""
    every = np.concatenate([points[::TRAVEL_TICKS], points[-1:]])
    return float(np.hypot(*np.diff(every, axis=0).T).sum())


def _words(contact: UnexpectedContact) -> str:
    return f"{contact.first} with {contact.second} ({contact.n_steps} physics steps, {contact.max_force_n:.1f} N)"


def _ways(steps: Sequence[MissionStep]) -> list[Floats]:
    """The ways of the trunk in motions that follow one another without a pause, (n, 2) each."""
    ways: list[list[Floats]] = []
    end_s = -inf
    for ticks in (step.ticks for step in steps if len(step.ticks.time_s)):
        if ticks.time_s[0] - end_s > 1.5 * CONTROL_PERIOD_S:
            ways.append([])
        ways[-1].append(ticks.trunk_m)
        end_s = ticks.time_s[-1]
    return [np.concatenate(way) for way in ways]


def _of_joints(values: Sequence[float]) -> OfJoints:
    """The largest value of each kind of joint."""
    return OfJoints(**{joint: max(values[index :: len(JOINTS)]) for index, joint in enumerate(JOINTS)})


def _per_footstep(count: int, total: Measures) -> float | None:
    return count / total.n_footsteps if total.n_footsteps else None
