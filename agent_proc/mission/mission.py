"""The mission (Fig. 5): plan, walk to the box, hand over, approach it, push it to its goal.

It depends on nothing but the answers of a `World`: the same answers lead to the same motions. So a mission that was
interrupted can go on from the journal of the answers it got before.
"""

from agent_proc.endings import REASON_OF, MissionEndedError, MissionResult
from agent_proc.policies.learned import require_single_face
from agent_proc.policies.policy import Policy
from agent_proc.push_model.map import PushMap
from agent_proc.pushing.box_route import BoxRoute
from agent_proc.pushing.calibrating import Calibration
from agent_proc.pushing.pushes import Pushes
from agent_proc.pushing.pushing import Pushing
from agent_proc.walking.actor import Actor, Revise, as_it_is, nobody
from agent_proc.walking.route_planner import RoutePlanner
from agent_proc.walking.walker import Walker
from legpush.lockstep.mission import Tell
from legpush.lockstep.world import World
from legpush.messages.stepping import Reset
from legpush.runs.reasons import REASONS
from legpush.scene.pushing.bounds import cannot_push
from legpush.scene.scenario import Scenario


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

    `push_map` is the measured effect of pushes on the scenario's box; without it, that on the default box is scaled.
    `revise` returns the scenario that holds after a step. `tell` gets the progress of the mission. An error of
    `REASON_OF` after the reset ends the mission, and the result has it.

    Raises:
        PolicyError: The policy chooses the face.
        LegpushError: The reset failed, or another error that a second try may not meet.
    """
    require_single_face(policy)
    actor = Actor(world, scenario, revise, tell)
    planner = RoutePlanner(world, actor, seed)
    walker = Walker(actor, planner)
    pushes = Pushes(actor, walker, world.tell_reward, push_map)
    route = BoxRoute(actor, planner, walker, pushes)
    pushing = Pushing(actor, walker, route, pushes, Calibration(actor, planner, pushes), policy)
    handover_distance_m, error, has_begun = None, None, False
    try:
        actor.step(Reset(scenario=scenario, seed=seed))
        has_begun = True
        _require_light_enough(actor)
        if actor.standing_at() is None:
            _walk_to_handover(actor, walker, route)
        handover_distance_m = actor.box_distance_m()
        pushing.run()
        _judge(actor)
    except MissionEndedError as end:
        success, reason, detail, remedy = False, end.reason, str(end), end.remedy
    except tuple(REASON_OF) as fault:
        if not has_begun:
            raise
        error = fault
        success, detail = False, str(fault)
        reason = next(reason for kind, reason in REASON_OF.items() if isinstance(fault, kind))
        remedy = REASONS[reason].remedy
    else:
        success, reason, detail, remedy = True, "success", f"box error {actor.true_box_error()}", ""
    return MissionResult(
        success=success,
        reason=reason,
        detail=detail,
        remedy=remedy,
        handover_distance_m=handover_distance_m,
        n_push_cycles=pushes.n_cycles,
        n_better_paths=planner.n_better_paths,
        n_replans=planner.n_replans,
        error=error,
    )


def _require_light_enough(actor: Actor) -> None:
    """Check that the robot can move the box of its scenario, if the box has to move.

    Raises:
        MissionEndedError: It cannot.
    """
    why = cannot_push(actor.scenario)
    if why is not None and not actor.box_error().within(actor.scenario.goal):
        raise MissionEndedError("too_heavy", why)


def _judge(actor: Actor) -> None:
    """Check that a box that is perceived at its goal is there.

    Raises:
        MissionEndedError: It is not.
    """
    if not (error := actor.true_box_error()).within(actor.scenario.goal):
        raise MissionEndedError(
            "tolerance_missed",
            f"box error {error}, perceived as {actor.box_error()}",
            "lower the noise in `realism.box_pose`",
        )


def _walk_to_handover(actor: Actor, walker: Walker, route: BoxRoute) -> None:
    """Walk towards the nominal box until the real one is near enough to be measured, or the path ends."""
    near_m, nominal = actor.scenario.mission.handover_distance_m, actor.scenario.box.pose.pose()
    while actor.box_distance_m() > near_m:
        _, plan = route.way_to_push(nominal, walker.query_behind_nominal, "the way to the box")
        if plan is None or walker.walk_plan("walking", plan, until_m=near_m):
            return
