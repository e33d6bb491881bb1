"""A world to move step by step: reset, plan, follow, walk and push, each with its outcome."""

from collections.abc import Sequence

from msgspec.structs import replace

from legpush.fields import Seed, require
from legpush.geometry import Pose2
from legpush.lockstep.world import World
from legpush.messages.planning import BoxPathQuery, Plan, PlanQuery, TrunkPathQuery
from legpush.messages.poses import as_seen, planar_pose
from legpush.messages.stepping import Alter, Follow, Motion, Outcome, Push, Reset, Walk, WorldState
from legpush.plans.trunk_queries import query_to_measured_box, query_to_pose
from legpush.scene.conventions import FrontLeg
from legpush.scene.faces import pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.scenario import Scenario
from legpush.scene.station import last_stretch


class StepwiseWorld:
    """Moves a robot beside a box, motion by motion; poses are in the world frame."""

    def __init__(self, world: World, scenario: Scenario, seed: int, *, with_trace: bool = False) -> None:
        """Reset the world; with `with_trace`, every outcome has a trace of its ticks."""
        self.scenario = scenario
        self.seed = seed
        self._world = world
        self._with_trace = with_trace
        self.outcome = self.reset()
        """The outcome of the last motion."""

    @property
    def state(self) -> WorldState:
        """The world after the last motion."""
        return self.outcome.world

    @property
    def trunk(self) -> Pose2:
        """Pose of the trunk as the robot is located, projected to the floor. The true one is in `state`."""
        return planar_pose(as_seen(self.state).trunk)

    @property
    def box(self) -> Pose2:
        """Pose of the box as it is perceived, projected to the floor. The true one is in `state`."""
        return planar_pose(as_seen(self.state).box)

    def reset(self, seed: int | None = None) -> Outcome:
        """Begin an episode; `seed` draws the offsets of robot and box. If it is None, the last seed is used.

        Raises:
            ConfigError: The seed is out of range.
        """
        if seed is not None:
            require(Seed, seed, "seed")
            self.seed = seed
        return self.step(Reset(scenario=self.scenario, seed=self.seed))

    def plan(self, to: Face | Pose2 | PlanQuery = "rear") -> Plan:
        """Plan a path for the trunk, around obstacles and the box where it is now.

        Args:
            to: A face of the box, whose path ends at the station to push it from; a pose of the trunk; or a query.
        """
        if isinstance(to, (TrunkPathQuery, BoxPathQuery)):
            return self._world.plan(to)
        if isinstance(to, Pose2):
            return self._world.plan(query_to_pose(self.scenario, self.seed, self.trunk, to, self.box))
        plan = self._world.plan(query_to_measured_box(self.scenario, self.seed, self.trunk, self.box, to))
        if plan.status != "exact":
            return plan
        box = pushed_box(self.scenario.box, to)
        return replace(plan, waypoints=plan.waypoints + last_stretch(self.scenario, box, pushed_pose(self.box, to)))

    def follow(self, path: Plan | Sequence[Pose2]) -> Outcome:
        """Take a path to walk along; the robot does not move yet.

        Raises:
            MotionError: The path does not begin where the robot stands, or cannot be walked.
        """
        return self.step(Follow(waypoints=path.waypoints if isinstance(path, Plan) else tuple(path)))

    def walk(self) -> Outcome:
        """Walk one gait cycle along the path; `outcome.world.path.done` says whether its end is reached.

        Raises:
            MotionError: There is no path, or the robot has fallen.
        """
        return self.step(Walk())

    def push(
        self, w1: float = 0.5, w2: float = 0.5, *, leg: FrontLeg = "FL", depth_m: float = 0.05, face: Face = "rear"
    ) -> Outcome:
        """Push the box once with a front foot, and step up to it again.

        Args:
            w1: Height of the first inner control point of the foot's curve, from 0 to 1.
            w2: Height of the second one, from 0 to 1.
            leg: The leg that pushes, `FL` or `FR`.
            depth_m: How far the foot goes beyond the face, in m, up to 0.25.
            face: The face of the box that is pushed.

        Raises:
            MotionError: The robot does not stand at its station behind the face, or has fallen.
        """
        return self.step(Push(w1=w1, w2=w2, leg=leg, depth_m=depth_m, face=face))

    def alter(
        self,
        *,
        box_mass_kg: float | None = None,
        box_friction: float | None = None,
        box_foot_friction: float | None = None,
    ) -> Outcome:
        """Change mass or friction of the box from now on."""
        return self.step(Alter(box_mass_kg=box_mass_kg, box_friction=box_friction, box_foot_friction=box_foot_friction))

    def step(self, motion: Motion) -> Outcome:
        """Carry out any motion.

        Raises:
            MotionError: The motion cannot be carried out; the state is unchanged.
            BrokenEpisodeError: The simulator failed in it.
        """
        self.outcome = self._world.step(motion, with_trace=self._with_trace)
        return self.outcome
