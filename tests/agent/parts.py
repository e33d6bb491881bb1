"""The parts of a mission, put together in a world without physics, after the reset."""

from dataclasses import dataclass

from agent_proc.push_model.map import PushMap
from agent_proc.pushing.box_route import BoxRoute
from agent_proc.pushing.calibrating import Calibration
from agent_proc.pushing.pushes import Pushes
from agent_proc.walking.actor import Actor
from agent_proc.walking.route_planner import RoutePlanner
from agent_proc.walking.walker import Walker
from legpush.messages.stepping import Reset
from legpush.scene.scenario import Scenario
from tests.agent.fake_world import FakeWorld

SEED = 7


@dataclass(frozen=True, kw_only=True)
class Parts:
    """What `run_mission` makes, but for the loop of pushing."""

    world: FakeWorld
    actor: Actor
    planner: RoutePlanner
    walker: Walker
    pushes: Pushes
    route: BoxRoute
    calibration: Calibration


def parts_in(world: FakeWorld, scenario: Scenario, push_map: PushMap | None = None) -> Parts:
    """The parts of a mission that has just begun."""
    actor = Actor(world, scenario, tell=world.tell)
    planner = RoutePlanner(world, actor, SEED)
    walker = Walker(actor, planner)
    pushes = Pushes(actor, walker, world.tell_reward, push_map)
    actor.step(Reset(scenario=scenario, seed=SEED))
    return Parts(
        world=world,
        actor=actor,
        planner=planner,
        walker=walker,
        pushes=pushes,
        route=BoxRoute(actor, planner, walker, pushes),
        calibration=Calibration(actor, planner, pushes),
    )
