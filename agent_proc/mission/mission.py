"""The mission (Fig. 5): plan, walk to the box, hand over, approach it, push it to its goal.

It depends on nothing but the answers of a `World`: the same answers lead to the same motions, so that a mission which
was interrupted goes on from the journal of what it was answered before.
"""

from dataclasses import dataclass

from agent_proc.policies.policy import Policy
from agent_proc.push_model.map import PushMap
from agent_proc.pushing.pushing import Pushing
from agent_proc.walking.actor import Actor, MissionEndedError, Reason, Revise, World, as_it_is
from agent_proc.walking.queries import query_to_nominal_box
from legpush.messages.planning import PlanQuery
from legpush.messages.stepping import Reset
from legpush.scene.scenario import Face, Scenario


@dataclass(frozen=True, kw_only=True)
class MissionResult:
    """How a mission ended."""

    success: bool
    """The box is within the tolerances of its goal and the robot stands."""
    reason: Reason
    """`success`, or what ended it without: the robot `fell` or is `stuck`, the `box_tipped` over, the planner knew
    `no_path`, the approach `missed_station`, the box `left_reference`, `max_push_cycles` were not enough, or pushing
    ended with the `tolerance_missed`."""
    detail: str
    """One sentence for people."""
    handover_distance_m: float | None
    """Trunk to box where walking along the map ended; None if it did not come to that."""
    n_push_cycles: int
    n_better_paths: int
    """How often a better path was taken while walking."""
    n_replans: int
    """How often an obstacle appeared in the way, so that another one was planned, or tried to be."""


def run_mission(
    world: World,
    scenario: Scenario,
    seed: int,
    policy: Policy,
    push_map: PushMap | None = None,
    revise: Revise = as_it_is,
) -> MissionResult:
    """Run a mission from its reset to its end: the step order of Fig. 5.

    `push_map` is of the scenario's box; without one, what pushes do to it is guessed from what they do to the default
    one. `revise` is asked after each step what the mission goes by from then on.
    """
    actor = Actor(world, scenario, seed, revise)
    pushing = Pushing(actor, policy, push_map)
    handover_distance_m = None
    try:
        actor.step(Reset(scenario=scenario, seed=seed))
        if actor.standing_at() is None:
            _walk_to_handover(actor, pushing)
        handover_distance_m = actor.box_distance_m()
        pushing.run()
    except MissionEndedError as end:
        success, reason, detail = False, end.reason, str(end)
    else:
        success, reason, detail = True, "success", f"box error {actor.box_error()}"
    return MissionResult(
        success=success,
        reason=reason,
        detail=detail,
        handover_distance_m=handover_distance_m,
        n_push_cycles=pushing.n_cycles,
        n_better_paths=actor.n_better_paths,
        n_replans=actor.n_replans,
    )


def _walk_to_handover(actor: Actor, pushing: Pushing) -> None:
    """Walk towards the nominal box until the real one is near enough to be measured, or the path ends."""
    near_m, nominal = actor.scenario.mission.handover_distance_m, actor.scenario.box.pose.pose()

    def way(face: Face) -> PlanQuery:
        return query_to_nominal_box(actor.scenario, actor.seed, actor.trunk(), face)

    while actor.box_distance_m() > near_m:
        _, plan = pushing.way_to_push(nominal, way, "the way to the box")
        if plan is None or actor.walk_plan("walking", plan, until_m=near_m):
            return
