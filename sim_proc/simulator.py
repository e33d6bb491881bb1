"""The simulator: carries out motions one by one and reports their outcomes. Without a motion nothing moves."""

from collections.abc import Sequence
from typing import TYPE_CHECKING, Final

from msgspec.structs import replace
from threadpoolctl import threadpool_limits

from legpush.errors import MotionError
from legpush.messages.stepping import Alter, Follow, Motion, Outcome, Push, PushReport, Reset, Walk
from legpush.realism.reality import Reality, drawn_reality
from legpush.scenarios.start import drawn_poses
from legpush.scene.conventions import FrontLeg
from sim_proc.control.gait import PathWalk
from sim_proc.control.plant import TickLog
from sim_proc.control.posture import Posture
from sim_proc.control.push_cycle import Pusher
from sim_proc.control.steps import Steps
from sim_proc.measures.motion import Meter
from sim_proc.observation import trace, world_state
from sim_proc.physics.contacts import require_apart
from sim_proc.physics.physics import Physics
from sim_proc.physics.senses import OwnSenses

if TYPE_CHECKING:
    from sim_proc.estimated_robot import EstimatedRobot

SETTLE_TICKS: Final = 25
"""How long robot and box stand before an episode begins, until the floor carries them."""


class Simulator:
    """A world that a `Reset` builds and the other motions move.

    Creating one limits BLAS to a single thread in this process. A sum that several threads share is rounded
    differently, so equal motions would not lead to the same state in every process.
    """

    def __init__(self) -> None:
        """Limit BLAS to one thread. There is no world before the first `Reset`."""
        threadpool_limits(limits=1, user_api="blas")
        self.episode: SimulatedEpisode | None = None
        """The present episode; None before the first `Reset`."""

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Carry out one motion.

        Raises:
            MotionError: The present state does not allow the motion.
        """
        if isinstance(motion, Reset):
            self.episode = SimulatedEpisode(motion)
            return self.episode.outcome([], with_trace=with_trace)
        if self.episode is None:
            raise MotionError(
                f"Expected `reset` as the first motion of an episode, got `{motion.__struct_config__.tag}`"
            )
        return self.episode.perform(motion, with_trace=with_trace)


class SimulatedEpisode:
    """One episode: a world and the robot in it."""

    def __init__(self, reset: Reset) -> None:
        """Build the world of a reset and stand the robot in it.

        Raises:
            MotionError: Robot, box and walls are in one another.
        """
        trunk, box = drawn_poses(reset.scenario, reset.seed)
        self._reality: Reality | None = drawn_reality(reset.scenario.realism, reset.seed)
        self._scenario = reset.scenario
        self.physics = Physics(reset.scenario, trunk, box, self._reality)
        require_apart(self.physics.model, self.physics.data, reset.scenario.robot.legs.foot_radius_m)
        self.physics.tick = -SETTLE_TICKS
        self._meter = Meter(self.physics.actual_robot, self.physics.actual_downhill)
        self._meter.measure([Posture(self.physics).stand(SETTLE_TICKS)], n_footsteps=0)
        self.physics.begin()
        self._estimated = _estimated(self.physics)
        self._steps = Steps(Posture(self._estimated or self.physics))
        self.pusher = Pusher(self._steps, reset.scenario.box)
        """Carries out its pushes."""
        self._walk: PathWalk | None = None
        self._push: PushReport | None = None
        self._n_footsteps = 0
        """Number of steps of single feet that have been measured."""

    def perform(self, motion: Follow | Walk | Push | Alter, *, with_trace: bool) -> Outcome:
        """Carry out a motion other than a reset.

        Raises:
            MotionError: The present state does not allow the motion.
        """
        if isinstance(motion, Push):
            return self.push(motion, (motion.w1, motion.w2), with_trace=with_trace)
        self._begin_motion(pushing=None)
        logs: list[TickLog] = []
        if isinstance(motion, Follow):
            self._walk = PathWalk(self._steps, motion.waypoints)
        elif isinstance(motion, Alter):
            self._alter(motion)
        else:
            logs = self._walk_cycle()
        return self.outcome(logs, with_trace=with_trace)

    def push(self, push: Push, weights: Sequence[float], *, with_trace: bool) -> Outcome:
        """Push along a curve of any degree: the `weights` place its inner control points, in place of `w1` and `w2`.

        Raises:
            MotionError: The present state does not allow the motion.
        """
        self._begin_motion(pushing=push.leg)
        done = self.pusher.cycle(push, weights)
        self._walk = None
        self._push = PushReport(leg=push.leg, touched=done.peak_force_n > 0.0, peak_force_n=done.peak_force_n)
        return self.outcome(done.logs, with_trace=with_trace)

    def _begin_motion(self, pushing: FrontLeg | None) -> None:
        if self.physics.fallen:
            raise MotionError("The robot has fallen: only `reset` is possible")
        self.physics.contacts.expect(pushing)

    def _walk_cycle(self) -> list[TickLog]:
        if self._walk is None:
            raise MotionError("Expected `follow` with a path before `walk`")
        if self._walk.progress().done:
            raise MotionError("The path is walked to its end: expected another `follow` before `walk`")
        return self._walk.cycle()

    def _alter(self, motion: Alter) -> None:
        """Change mass or friction of the box and keep the state."""
        changes = {
            "mass_kg": motion.box_mass_kg,
            "friction": motion.box_friction,
            "foot_friction": motion.box_foot_friction,
        }
        box = replace(self._scenario.box, **{name: value for name, value in changes.items() if value is not None})
        self._scenario = replace(self._scenario, box=box)
        self.physics.alter(self._scenario)

    def outcome(self, logs: list[TickLog], *, with_trace: bool) -> Outcome:
        """The present state as the outcome of a motion, with the trace of its logs if asked for."""
        path = None if self._walk is None else self._walk.progress()
        physics, contacts = self.physics, self.physics.contacts
        measured = None
        if logs:
            n_before, self._n_footsteps = self._n_footsteps, self._steps.n_footsteps
            measured = self._meter.measure(
                logs,
                n_footsteps=self._n_footsteps - n_before,
                n_unexpected_steps=contacts.n_steps,
                unexpected=contacts.found(),
            )
        estimated = self._estimated
        perceived = (
            estimated.perceived() if estimated else physics.perception.perceived(physics.data.qpos, physics.tick)
        )
        return Outcome(
            world=world_state(physics, self._steps.n_footsteps, path, self._push, perceived),
            state_crc=physics.state_crc(estimated.as_bytes() if estimated else b""),
            trace=trace(logs, physics.tick, measured) if with_trace else None,
            measures=None if measured is None else measured.measures,
            reality=self._told_once(),
        )

    def _told_once(self) -> Reality | None:
        """What the seed drew, in the outcome of the reset, if it differs from what is assumed and known."""
        reality, self._reality = self._reality, None
        return None if reality is None or reality.ideal else reality


def _estimated(physics: Physics) -> "EstimatedRobot | None":
    """The robot as its own sensors tell it; None if they are exact. Only estimates need compiled functions."""
    if not isinstance(physics.senses, OwnSenses):
        return None
    from sim_proc.estimated_robot import EstimatedRobot

    return EstimatedRobot(physics, physics.senses)
