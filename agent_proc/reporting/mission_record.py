"""Reads a mission from its journal into arrays, from which report and picture are made."""

from collections.abc import Iterable
from dataclasses import dataclass, fields
from typing import Any

import numpy as np
from numpy.typing import ArrayLike

from agent_proc.frames.poses import BoxError, box_error
from legpush.arrays import Floats
from legpush.errors import JournalError
from legpush.geometry import Pose2, rpy_from_quaternion
from legpush.history.steps import PlanRecord, StepRecord
from legpush.messages.measures import Measures
from legpush.messages.planning import BoxPathQuery
from legpush.messages.stepping import Follow, Motion, Push, Reset, Trace, WorldState
from legpush.scene.conventions import BOX_QPOS, CONTROL_PERIOD_S, JOINTS, LEGS, N_QPOS
from legpush.scene.reference import reference_curve
from legpush.scene.scenario import Scenario


@dataclass(frozen=True, kw_only=True)
class Ticks:
    """One row per tick in each array."""

    time_s: Floats
    """(n,)"""
    trunk_m: Floats
    """The trunk's position on the floor, (n, 2)."""
    roll_pitch_rad: Floats
    """(n, 2)"""
    tips_m: Floats
    """Foot tips in the order of `LEGS`, (n, 4, 3)."""
    support_margin_m: Floats
    """(n,)"""
    zmp_margin_m: Floats
    """(n,); this and the next two are NaN before protocol 8."""
    capture_margin_m: Floats
    """(n,)"""
    torques_n_m: Floats
    """Largest torque of the hip-x, hip-y and knee joints of all legs, (n, 3)."""
    box: Floats
    """x, y and yaw of the box, (n, 3)."""


@dataclass(frozen=True, kw_only=True)
class MissionStep:
    """A motion, and the world after it."""

    motion: Motion
    world: WorldState
    state_crc: int
    ticks: Ticks
    measures: Measures | None
    """None if nothing moved, and in journals before protocol 8."""
    path_m: Floats
    """The path given last to the robot, (m, 2); empty before the first."""
    box_path_m: Floats
    """The reference, or the path planned last for the box, (m, 2); empty before the first."""


@dataclass(frozen=True, kw_only=True)
class MissionRecord:
    """The plans and steps of a mission, each in order."""

    scenario: Scenario
    seed: int
    plans: list[PlanRecord]
    steps: list[MissionStep]
    """The first is the reset."""

    def ticks(self) -> Ticks:
        """The ticks of all steps."""
        return _join(step.ticks for step in self.steps)

    def pushing(self) -> list[MissionStep]:
        """All steps from the one before the first push cycle on; empty if there was no push."""
        first = next((index for index, step in enumerate(self.steps) if isinstance(step.motion, Push)), None)
        return [] if first is None else self.steps[first - 1 :]

    def push_cycles(self) -> list[MissionStep]:
        """The step before the first push cycle, then the push cycles; empty if there was no push."""
        steps = self.pushing()
        return steps[:1] + [step for step in steps[1:] if isinstance(step.motion, Push)]

    def box_error(self, step: MissionStep) -> BoxError:
        """Error of the box at the end of a step."""
        return box_error(step.world, self.scenario)


def read_record(records: Iterable[StepRecord | PlanRecord]) -> MissionRecord:
    """Read a mission.

    Raises:
        JournalError: The journal does not begin with a reset, or a step has no trace.
    """
    plans: list[PlanRecord] = []
    steps: list[MissionStep] = []
    path_m = box_path_m = np.empty((0, 2))
    reference = None
    for record in records:
        if isinstance(record, PlanRecord):
            plans.append(record)
            if isinstance(record.query, BoxPathQuery) and record.plan.waypoints and reference is None:
                box_path_m = _positions(record.plan.waypoints)
            continue
        motion, outcome = record
        if isinstance(motion, Follow):
            path_m = _positions(motion.waypoints)
        elif isinstance(motion, Reset) and (reference := motion.scenario.reference) is not None:
            box_path_m = reference_curve(reference, motion.scenario.box.pose.pose())[:, :2]
        step = MissionStep(
            motion=motion,
            world=outcome.world,
            state_crc=outcome.state_crc,
            ticks=_ticks(outcome.trace, len(steps)),
            measures=outcome.measures,
            path_m=path_m,
            box_path_m=box_path_m,
        )
        steps.append(step)
    if not steps or not isinstance(reset := steps[0].motion, Reset):
        raise JournalError("Expected a reset as the first step of the journal")
    return MissionRecord(scenario=reset.scenario, seed=reset.seed, plans=plans, steps=steps)


def _positions(waypoints: Iterable[Pose2]) -> Floats:
    return np.array([[pose.x_m, pose.y_m] for pose in waypoints])


def _ticks(trace: Trace | None, index: int) -> Ticks:
    if trace is None:
        raise JournalError(f"Expected a journal with the trace of each step, got step {index} without one")
    n = len(trace.tick)

    def rows(values: ArrayLike, *shape: int) -> Floats:
        return np.array(values, dtype=np.float64).reshape(n, *shape)

    def later(values: tuple[Any, ...], *shape: int) -> Floats:
        return rows(values, *shape) if values else np.full((n, *shape), np.nan)

    qpos = rows(trace.qpos, N_QPOS)
    box = qpos[:, BOX_QPOS]
    return Ticks(
        time_s=rows(trace.tick) * CONTROL_PERIOD_S,
        trunk_m=qpos[:, :2],
        roll_pitch_rad=rows(trace.roll_pitch_rad, 2),
        tips_m=rows(trace.tips_m, len(LEGS), 3),
        support_margin_m=rows(trace.support_margin_m),
        zmp_margin_m=later(trace.zmp_margin_m),
        capture_margin_m=later(trace.capture_margin_m),
        torques_n_m=np.abs(later(trace.joint_torques_n_m, len(LEGS), len(JOINTS))).max(axis=1),
        box=np.column_stack([box[:, :2], rpy_from_quaternion(box[:, 3:])[:, 2]]),
    )


def _join(parts: Iterable[Ticks]) -> Ticks:
    """Concatenate the rows of all parts."""
    parts = list(parts)
    return Ticks(
        **{field.name: np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Ticks)}
    )
