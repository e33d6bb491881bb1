"""The kind of cell that pushes a box of any mass 1 m ahead, with its force fed forward in three ways.

An episode ends as soon as the box is stuck, so that a box that is too heavy costs little time.
"""

from collections import deque
from collections.abc import Collection, Mapping
from math import degrees, inf
from typing import Any, Final, Literal

import numpy as np
from msgspec import Struct

from agent_proc.frames.poses import box_error
from agent_proc.frames.push_view import push_view
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.studies.cell_parts import policy_with, scenario_of, sha256_of_policy
from legpush.arrays import Floats
from legpush.bounds import BoxMass, Friction
from legpush.errors import LegpushError
from legpush.fields import Seed
from legpush.messages.poses import as_seen, planar_pose
from legpush.messages.stepping import Outcome, Reset
from legpush.policy_names import DEFAULT_POLICY
from legpush.realism.settings import Profile
from legpush.scene.pushing.bounds import least_force_n, most_force_n
from legpush.scene.scenario import Scenario
from legpush.study.cells import CellKind, Column
from sim_proc.control.resistance import Resistance
from sim_proc.simulator import SimulatedEpisode

MOST_CYCLES: Final = 100
STILL_CYCLES: Final = 8
"""An episode ends when as many pushes have moved the box by less than `STILL_M`."""
STILL_M: Final = 0.02

COLUMNS: Final = (
    Column(name="ending", unit="", about="done, stuck, fell, max_cycles, or the error that ended it"),
    Column(name="within", unit="", about="whether the box ended within the tolerances of its goal"),
    Column(name="n_cycles", unit="", about="number of pushes"),
    Column(name="position_error_m", unit="m", about="of the box at the end"),
    Column(name="angle_error_deg", unit="deg", about="of the box at the end"),
    Column(name="n_outside_support", unit="", about="physics steps with a negative support margin"),
    Column(name="min_support_margin_m", unit="m", about="least support margin at any physics step"),
    Column(name="max_abs_roll_deg", unit="deg", about="largest roll of the trunk"),
    Column(name="max_abs_pitch_deg", unit="deg", about="largest pitch of the trunk"),
    Column(name="peak_force_n", unit="N", about="largest force of the box on the foot"),
    Column(name="n_at_torque_limit", unit="", about="physics steps in which a servo was at its limit, over all joints"),
    Column(name="travel_share", unit="", about="way of the box over the depth of the pushes, all pushes together"),
    Column(name="least_force_n", unit="N", about="least force that can move the box, by the bound"),
    Column(name="most_force_n", unit="N", about="largest force that the robot can push with, by the bound"),
    Column(name="state_crc", unit="", about="CRC-32 of the simulator's last state"),
)


class Unfelt(Resistance):
    """A resistance that no push teaches anything: that of the scenario, sliding straight ahead."""

    def feel(self, forces_n: Floats) -> None:
        """Learn nothing."""


class HeavyPush(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A push of the built-in scenario `push` with another box and another floor."""

    seed: Seed
    mass_kg: BoxMass
    friction: Friction
    foot_friction: Friction = 1.0
    """Of feet and floor."""
    force: Literal["none", "known", "felt"] = "felt"
    """What is fed forward: nothing, the friction of the sliding box as the scenario states it, or what was felt."""
    realism: Profile = "ideal"
    policy: str = DEFAULT_POLICY


class ResolvedPush(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """A push that needs no other file than those of its policy."""

    seed: Seed
    scenario: Scenario
    force: Literal["none", "known", "felt"]
    policy: str
    policy_sha256: str


def resolve(cell: HeavyPush, allowed: Collection[str]) -> ResolvedPush:
    """Make the scenario and hash the policy.

    Raises:
        PolicyError: It cannot be used.
    """
    changes: dict[str, Any] = {
        "box.mass_kg": cell.mass_kg,
        "box.friction": cell.friction,
        "robot.legs.foot_friction": cell.foot_friction,
        "realism.profile": cell.realism,
    }
    if cell.force == "none":
        changes["robot.pushing.heavy_share"] = 1.0
    return ResolvedPush(
        seed=cell.seed,
        scenario=scenario_of("push", changes),
        force=cell.force,
        policy=cell.policy,
        policy_sha256=sha256_of_policy(cell.policy, allowed),
    )


def heavy_push(cell: ResolvedPush) -> Mapping[str, Any]:
    """Push until the policy is done, or nothing helps."""
    scenario, policy = cell.scenario, policy_with(cell.policy, cell.policy_sha256)
    episode = SimulatedEpisode(Reset(scenario=scenario, seed=cell.seed))
    if cell.force == "known":
        episode.pusher.resistance = Unfelt(scenario.box)
    outcome = episode.outcome([], with_trace=False)
    estimate, tally = PushEstimate(scenario.box), _Tally()
    last_m: deque[float] = deque(maxlen=STILL_CYCLES)
    ending = "max_cycles"
    while tally.n_cycles < MOST_CYCLES:
        seen = as_seen(outcome.world)
        push = policy.decide(push_view(seen, scenario, estimate.felt))
        if push is None:
            ending = "done"
            break
        try:
            outcome = episode.perform(push, with_trace=True)
        except LegpushError as refusal:
            ending = str(refusal)
            break
        moved = planar_pose(seen.box).inverse() @ planar_pose(as_seen(outcome.world).box)
        estimate.learn(planar_pose(seen.box), push, planar_pose(as_seen(outcome.world).box))
        tally.count(outcome, push.depth_m, moved.x_m)
        last_m.append(moved.x_m)
        if outcome.world.fallen:
            ending = "fell"
            break
        if len(last_m) == STILL_CYCLES and sum(last_m) < STILL_M:
            ending = "stuck"
            break
    error = box_error(outcome.world, scenario)
    return {
        "ending": ending,
        "within": error.within(scenario.goal),
        "position_error_m": error.position_m,
        "angle_error_deg": degrees(error.angle_rad),
        **tally.columns(),
        "least_force_n": least_force_n(scenario.robot, scenario.box, "rear", scenario.room.slope_deg),
        "most_force_n": most_force_n(scenario.robot, scenario.box, "rear"),
        "state_crc": f"{outcome.state_crc:08x}",
    }


class _Tally:
    """What is counted of the pushes of an episode."""

    def __init__(self) -> None:
        self.n_cycles = 0
        self._n_outside = self._n_at_limit = 0
        self._margin_m = inf
        self._tilts_deg = np.zeros(2)
        self._peak_n = self._depth_m = self._moved_m = 0.0

    def count(self, outcome: Outcome, depth_m: float, moved_m: float) -> None:
        """Count a push."""
        trace, measures, report = outcome.trace, outcome.measures, outcome.world.push
        if trace is None or measures is None or report is None:
            raise RuntimeError("Expected trace, measures and report of a push, got none")
        self.n_cycles += 1
        self._n_outside += measures.n_outside_support
        self._n_at_limit += sum(measures.n_at_torque_limit)
        self._margin_m = min(self._margin_m, measures.min_support_margin_m)
        self._tilts_deg = np.maximum(self._tilts_deg, np.degrees(np.abs(trace.roll_pitch_rad)).max(axis=0))
        self._peak_n = max(self._peak_n, report.peak_force_n)
        self._depth_m += depth_m
        self._moved_m += moved_m

    def columns(self) -> dict[str, Any]:
        """Return the columns of the tally."""
        roll_deg, pitch_deg = self._tilts_deg.tolist()
        return {
            "n_cycles": self.n_cycles,
            "n_outside_support": self._n_outside,
            "min_support_margin_m": self._margin_m if self.n_cycles else None,
            "max_abs_roll_deg": roll_deg,
            "max_abs_pitch_deg": pitch_deg,
            "peak_force_n": self._peak_n,
            "n_at_torque_limit": self._n_at_limit,
            "travel_share": self._moved_m / self._depth_m if self.n_cycles else None,
        }


HEAVY_PUSH: Final = CellKind(
    specification=HeavyPush, run=heavy_push, resolved=ResolvedPush, resolve=resolve, columns=COLUMNS
)
"""The kind of cell."""
