"""Response maps that are made without physics."""

from functools import cache
from typing import Any

import numpy as np

from agent_proc.map_world.fit import ENDS_M, ROWS_M
from agent_proc.map_world.random_pushes import MeasuredPush, MeasuredSeries, RandomSeries, Stance, measure_series
from agent_proc.map_world.response_map import ResponseMap, Stances, make_response_map
from agent_proc.map_world.surface import Quality, Residuals, ResponseSurface
from agent_proc.push_model.map import measured_faces
from agent_proc.push_model.model import MIRROR, NOMINAL
from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.scene.names import Face
from tests.agent.fake_world import FakeWorld
from tests.robots import ROBOT

N_SERIES = 12
STANCE = Stance(
    trunk=Pose2(x_m=0.02, y_m=-0.01, yaw_rad=0.0),
    trunk_height_m=0.5,
    tips_m=((0.3, 0.2, 0.02), (0.3, -0.2, 0.02), (-0.3, 0.2, 0.02), (-0.3, -0.2, 0.02)),
    joint_positions_rad=(0.0,) * 12,
)
NO_QUALITY = Quality(
    n=0,
    r_squared=(1.0, 1.0, 1.0),
    cross_validated_rmse=(0.0, 0.0, 0.0),
    leg_difference=(0.0, 0.0, 0.0),
    leg_difference_error=(0.0, 0.0, 0.0),
)


def known_surface(face: Face = "rear", scatter: float = 1.0) -> ResponseSurface:
    """A surface with every term, and residuals that correlate."""
    depth = np.array([0.0, *ROWS_M])
    past = np.maximum(depth - ROWS_M[0], 0.0)
    factor = scatter * np.array([[4e-4, 0.0, 0.0], [-2e-4, 6e-4, 0.0], [1e-3, 5e-4, 2e-3]])
    return ResponseSurface(
        face=face,
        depth_m=tuple(depth.tolist()),
        forward_m=tuple((0.78 * past).tolist()),
        left_m=tuple((-0.25 * past).tolist()),
        turn_rad=tuple((-1.35 * past).tolist()),
        curve=((0.01, 0.02, -0.05, 0.03, -0.1), (0.02, -0.03, 0.08, 0.01, 0.2), (0.1, 0.2, -0.4, -0.2, -0.9)),
        first=(1e-3, -5e-4, 2e-3),
        residuals=tuple(
            Residuals(to_depth_m=end_m, n=100, factor=_rows((1.0 + index) * factor))
            for index, end_m in enumerate(ENDS_M)
        ),
        quality=NO_QUALITY,
    )


def _rows(factor: Floats) -> Any:
    return tuple(map(tuple, factor.tolist()))


def drawn_series(surface: ResponseSurface, n_series: int, *, residuals: bool = True) -> list[MeasuredSeries]:
    """Random pushes with the displacements that a surface says."""
    normal = np.random.default_rng(3)
    found = []
    for seed in range(n_series):
        pushes = RandomSeries(face=surface.face, seed=seed).pushes()
        mirror, depth, w1, w2 = np.array([(MIRROR[p.leg], p.depth_m, p.w1, p.w2) for p in pushes]).T
        moved = surface.displacement(mirror, depth, w1, w2, first=np.arange(len(pushes)) == 0)
        if residuals:
            moved = moved + surface.residual(mirror, depth, normal.standard_normal((len(pushes), 3)))
        measured = tuple(
            MeasuredPush(
                leg=push.leg,
                w1=push.w1,
                w2=push.w2,
                depth_m=push.depth_m,
                forward_m=forward,
                left_m=left,
                turn_rad=turn,
                n_ticks=140,
                n_footsteps=4,
                peak_force_n=3.0,
                after=STANCE,
            )
            for push, (forward, left, turn) in zip(pushes, moved.tolist(), strict=True)
        )
        found.append(MeasuredSeries(face=surface.face, before=STANCE, pushes=measured))
    return found


def known_map(scatter: float = 1.0) -> ResponseMap:
    """A map of the default box with the known surface at every measured face."""
    return ResponseMap(
        box=NOMINAL,
        robot=ROBOT,
        surfaces=tuple(known_surface(face, scatter) for face in measured_faces(NOMINAL)),
        stances=Stances(start=STANCE, FL=STANCE, FR=STANCE),
        ticks_per_push=140,
        footsteps_per_push=4,
        peak_force_n=3.0,
        command="test",
    )


@cache
def fake_world_map() -> ResponseMap:
    """The map of what the fake world does."""
    series = [
        measure_series(FakeWorld(), ROBOT, NOMINAL, RandomSeries(face=face, seed=seed))
        for face in measured_faces(NOMINAL)
        for seed in range(N_SERIES)
    ]
    return make_response_map(ROBOT, NOMINAL, series, "test", {})
