"""The mission (Fig. 5): plan, walk to the box, hand over, approach it, push it to its goal.

It depends on nothing but the answers of a `World`: the same answers lead to the same motions, so that a mission which
was interrupted goes on from the journal of what it was answered before.
"""

from agent_proc.endings import MissionEndedError, MissionResult
from agent_proc.policies.policy import Policy
from agent_proc.push_model.map import PushMap
from agent_proc.pushing.pushing import Pushing
from agent_proc.walking.actor import Actor, Revise, Tell, as_it_is, nobody
from legpush.lockstep.world import World
from legpush.messages.planning import PlanQuery
from legpush.messages.stepping import Reset
from legpush.plans.trunk_queries import query_to_nominal_box
from legpush.scene.scenario import Face, Scenario


def run_mission(
    world: World,
    scenario: Scenario,
    seed: int,
    policy: Policy,
    push_map: PushMap | None = None,
    revise: Revise = as_it_is,
    tell: Tell = nobody,
) -> MissionResult:
    """Run a mission from its reset to its end: the step order of Fig. 5.

    `push_map` is of the scenario's box; without one, what pushes do to it is guessed from what they do to the default
    one. `revise` is asked after each step what the mission goes by from then on. `tell` gets its progress.
    """
    actor = Actor(world, scenario, seed, revise, tell)
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
