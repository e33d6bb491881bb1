"""An episode of a policy in a world, with what the response map would have said about each push."""

from dataclasses import dataclass
from math import degrees
from typing import Final

import numpy as np
from msgspec.structs import replace

from agent_proc.frames.poses import box_error
from agent_proc.frames.push_view import push_view
from agent_proc.map_world.random_pushes import displacement
from agent_proc.map_world.response_map import ResponseMap, load_response_map
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.push_model.model import MIRROR
from agent_proc.studies.cell_parts import new_simulator
from benchmarks.map_world.policies import policy_of
from legpush.errors import MotionError
from legpush.lockstep.local import LocalWorld
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, Reset, WorldState
from legpush.scenarios.file import load_scenario
from legpush.scene.scenario import Scenario

MAX_CYCLES: Final = 60


@dataclass(frozen=True, kw_only=True)
class Episode:
    """How an episode ended, and the errors of the map in each of its pushes."""

    policy: str
    seed: int
    world: str
    ending: str
    position_error_m: float
    angle_error_deg: float
    n_cycles: int
    x_m: float
    """End pose of the box, like the next two."""
    y_m: float
    yaw_deg: float
    push_errors: tuple[tuple[float, float, float], ...]
    """Measured minus mapped displacement: forward [m], left [m] and turn [rad], mirrored for FR."""
    within: tuple[bool, ...]
    """Whether the error of each push is in the ellipsoid that should hold 95 % of them."""


CHI_SQUARE_95: Final = 7.815
"""The 95 % quantile of the chi-square distribution with three degrees of freedom."""


def run(policy: str, seed: int, world: str) -> Episode:
    """Run an episode of at most `MAX_CYCLES` push cycles from a seeded start in the scenario `push`."""
    scenario, response_map = load_scenario("push"), load_response_map()
    scenario = replace(scenario, mission=replace(scenario.mission, max_push_cycles=MAX_CYCLES))
    local, deciding = LocalWorld(new_simulator(world)), policy_of(policy, seed)
    outcome = local.step(Reset(scenario=scenario, seed=seed))
    estimate = PushEstimate(scenario.box)
    errors: list[tuple[float, float, float]] = []
    within: list[bool] = []
    ending = "max_cycles"
    for n_before in range(MAX_CYCLES):
        push = deciding.decide(push_view(outcome.world, scenario, estimate.felt))
        if push is None:
            ending = "done"
            break
        before = outcome.world
        try:
            outcome = local.step(push)
        except MotionError:
            ending = "out of reach"
            break
        estimate.learn(planar_pose(before.box), push, planar_pose(outcome.world.box))
        error, inside = _error(response_map, before, push, outcome.world, first=n_before == 0)
        errors.append(error)
        within.append(inside)
        if outcome.world.fallen:
            ending = "fell"
            break
    return _episode(policy, seed, world, ending, scenario, outcome.world, errors, within)


def _error(
    response_map: ResponseMap, before: WorldState, push: Push, after: WorldState, *, first: bool
) -> tuple[tuple[float, float, float], bool]:
    """Error of the map in one push, and whether its covariance allows for it."""
    surface, mirror = response_map.surface(push.face), np.array([MIRROR[push.leg]])
    depth_m, w1, w2 = (np.array([value]) for value in (push.depth_m, push.w1, push.w2))
    mapped = surface.displacement(mirror, depth_m, w1, w2, first=first)[0]
    moved = displacement(before, push, after)
    signs = np.array([1.0, mirror[0], mirror[0]])
    error = signs * (np.array([moved.x_m, moved.y_m, moved.yaw_rad]) - mapped)
    part = next((p for p in surface.residuals if push.depth_m <= p.to_depth_m), surface.residuals[-1])
    distance = float(error @ np.linalg.solve(part.covariance, error))
    forward_m, left_m, turn_rad = error.tolist()
    return (forward_m, left_m, turn_rad), distance <= CHI_SQUARE_95


def _episode(
    policy: str,
    seed: int,
    world: str,
    ending: str,
    scenario: Scenario,
    last: WorldState,
    errors: list[tuple[float, float, float]],
    within: list[bool],
) -> Episode:
    error, box = box_error(last, scenario), planar_pose(last.box)
    return Episode(
        policy=policy,
        seed=seed,
        world=world,
        ending=ending,
        position_error_m=error.position_m,
        angle_error_deg=degrees(error.angle_rad),
        n_cycles=len(errors),
        x_m=box.x_m,
        y_m=box.y_m,
        yaw_deg=degrees(box.yaw_rad),
        push_errors=tuple(errors),
        within=tuple(within),
    )
