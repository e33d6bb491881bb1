"""Which stages the box is pushed along next, how the robot comes to the first of them, and whether they are free."""

from collections.abc import Callable, Sequence
from math import hypot

from agent_proc.endings import MissionEndedError
from agent_proc.pushing.obstacles import is_in_push
from agent_proc.pushing.pushes import Pushes
from agent_proc.pushing.queries import closer, query_for_box
from agent_proc.pushing.reference_stage import reference_path
from agent_proc.pushing.stage import Stage
from agent_proc.pushing.stage import stages as path_stages
from agent_proc.walking.actor import Actor
from agent_proc.walking.obstacles import in_words
from agent_proc.walking.route_planner import RoutePlanner
from agent_proc.walking.walker import Walker
from legpush.geometry import Pose2
from legpush.messages.planning import Plan, PlanQuery
from legpush.scene.names import Face
from legpush.scene.reference import Reference, least_radius_m


class BoxRoute:
    """The reference of the scenario until it has been followed, after that planned paths of the box."""

    def __init__(self, actor: Actor, planner: RoutePlanner, walker: Walker, pushes: Pushes) -> None:
        self._actor = actor
        self._planner = planner
        self._walker = walker
        self._pushes = pushes
        self.reference: Reference | None = actor.scenario.reference
        """None once it is being followed."""
        self.calibration_is_due = actor.scenario.pushing.calibration_pushes > 0
        """Whether the estimates may still change before the reference is followed."""
        self._n_cleared = 0
        """Number of appeared obstacles that are known not to be in the way of the present stages."""

    def begin_reference(self) -> list[Stage]:
        """Come to where the reference is pushed from; from now on paths of the box are planned."""
        stages = self.come_to_push()
        self.reference = None
        return stages

    def come_to_push(self) -> list[Stage]:
        """Find the next stages, and walk to the face where they begin.

        Raises:
            MissionEndedError: There is no path for the box or the robot, or what walking raises.
        """
        while True:
            stages, plan = self.way_to_push(self._actor.box(), self._walker.query_behind, "the way behind the box")
            if plan is None or self._walker.walk_behind(stages[0].face, plan):
                return stages

    def way_to_push(self, box: Pose2, query: Callable[[Face], PlanQuery], what: str) -> tuple[list[Stage], Plan | None]:
        """The next stages of a box, and the robot's path to the first face, or None if it stands there already.

        Among the box's paths whose first face the robot can reach, the one that the planner prefers is chosen. If there
        is none, the error is that of the preferred face, which the robot could not reach. `query` makes the query for
        the robot's path to a face, `what` names that path for people.

        Raises:
            MissionEndedError: There is no path for the box or the robot, or the push cycles cannot do for that path.
        """
        faces = self._actor.faces() if self.reference is None else ("rear",)
        out_of_reach: MissionEndedError | None = None
        while True:
            try:
                stages = self._stages(box, faces)
            except MissionEndedError as none_from_the_rest:
                raise out_of_reach or none_from_the_rest from none_from_the_rest
            first = stages[0].face
            if self._actor.at_station(first):
                return stages, None
            if self._pushes.n_cycles == 0:
                self._pushes.budget.require_enough(box, stages, is_reference=self.reference is not None)
            self._walker.back_off()
            asked = query(first)
            plan = self._planner.ask(asked, what)
            if plan.status == "exact":
                return stages, plan
            out_of_reach = out_of_reach or self._planner.no_path(f"{what}, to its {first} face", asked, plan)
            faces = tuple(face for face in faces if face != first)
            if not faces:
                raise out_of_reach

    def is_free(self, stages: Sequence[Stage], from_m: float = 0.0) -> bool:
        """Whether nothing has appeared in the way of box and robot, from a place on the first stage on."""
        for new in self._actor.appeared_since(self._n_cleared):
            for index, stage in enumerate(stages):
                if is_in_push(new, self._actor.scenario, stage, 0.0 if index else from_m):
                    return False
        self._n_cleared = self._actor.n_appeared()
        return True

    def require_free(self, stages: Sequence[Stage], from_m: float = 0.0) -> None:
        """Do nothing if the stages of a reference are free.

        Raises:
            MissionEndedError: An obstacle has appeared in their way, and there is no other reference.
        """
        if not self.is_free(stages, from_m):
            new = in_words(self._actor.state.appeared[self._n_cleared :])
            raise MissionEndedError(
                "no_path",
                f"the reference is not free any more; appeared: {new}",
                "leave out `reference`, so that paths around obstacles are planned, or move these `room.obstacles`",
            )

    def give_up(self) -> None:
        """Count that the present stages are given up because an obstacle has appeared in their way."""
        self._planner.give_up("the box", self._n_cleared)

    def _stages(self, box: Pose2, faces: tuple[Face, ...]) -> list[Stage]:
        """The reference, or the planned path of the box, pushed at some of these faces."""
        if self.reference is not None:
            stages = [self._reference_stage(self.reference)]
            self.require_free(stages)
            return stages
        self._n_cleared = self._actor.n_appeared()
        estimates = {face: self._pushes.estimates[face] for face in faces}
        query = query_for_box(self._actor.scenario, self._planner.seed, box, estimates, self._actor.standing_at())
        plan = self._planner.ask(query, "the path of the box")
        if plan.status in ("invalid", "failed") and self._pushes.n_cycles and query.clearance_m > 0.0:
            # Pushes have brought the box closer to something than planned, or to where no way is wide enough.
            plan = self._planner.ask(closer(query, self._actor.scenario), "the path of the box, closer to obstacles")
        if plan.status != "exact":
            raise self._planner.no_path("the path of the box", query, plan)
        return path_stages(plan, {face: estimate.axle_m for face, estimate in estimates.items()})

    def _reference_stage(self, reference: Reference) -> Stage:
        """The reference from the nominal pose of the box on, wherever the box is."""
        estimate = self._pushes.estimates["rear"]
        tightest_m, radius_m = least_radius_m(reference), hypot(estimate.turning_radius_m, estimate.axle_m)
        if tightest_m < radius_m and not self.calibration_is_due:
            raise MissionEndedError(
                "no_path",
                f"the reference turns on a radius of {tightest_m:.2f} m, the box on no less than {radius_m:.2f} m",
                "widen the curves of `reference`, or measure the box first with `pushing.calibration_pushes`",
            )
        return reference_path(reference, self._actor.scenario.box.pose.pose(), estimate.axle_m)
