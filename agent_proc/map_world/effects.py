"""What pushes do to a box in a world without physics: as a map was measured, or as drawn for each episode."""

from typing import Final, Protocol

import numpy as np
from msgspec.structs import asdict, replace

from agent_proc.map_world.response_map import ResponseMap
from agent_proc.push_model.drawn_response import drawn_response
from agent_proc.push_model.model import MIRROR, nearest_model
from agent_proc.push_model.response import Response, kind_of
from legpush.errors import ConfigError, MotionError, ScenarioError
from legpush.geometry import Pose2
from legpush.messages.stepping import Push
from legpush.scene.faces import FACES, pushed_box
from legpush.scene.names import Face
from legpush.scene.scenario import Scenario

RESIDUALS_KEY: Final = 1
BOX_KEY: Final = 2
"""Set the residuals of a seed, and the box that it draws, apart from the offsets that the same seed draws."""


class Effects(Protocol):
    """What pushes do."""

    def require_described(self, scenario: Scenario) -> None:
        """Require what pushes are known for.

        Raises:
            ScenarioError: The box, the robot or the floor is another one.
        """

    def begin(self, scenario: Scenario, seed: int) -> None:
        """Begin an episode; all that is drawn follows from the seed."""

    def after(self, before: Pose2, push: Push, *, first: bool) -> Pose2:
        """The pose of the pushed frame after a push, which is the first one since the robot walked or not.

        Raises:
            MotionError: Nothing is known of such pushes.
        """


class MeasuredEffects:
    """Those of a response map."""

    def __init__(self, response_map: ResponseMap, *, residuals: bool = True) -> None:
        """Without `residuals`, pushes are mean ones."""
        self._map = response_map
        self._residuals = residuals

    def require_described(self, scenario: Scenario) -> None:
        """Require what the map was measured with (`ScenarioError`)."""
        box, mine = replace(scenario.box, pose=self._map.box.pose), self._map.box
        if box != mine:
            was, expected = asdict(box), asdict(mine)
            differing = [name for name in was if was[name] != expected[name]]
            raise ScenarioError(
                f"{scenario.name}: expected the box of the response map, "
                f"{', '.join(f'{name} {expected[name]}' for name in differing)}, got "
                f"{', '.join(f'{name} {was[name]}' for name in differing)}; `legpush calibrate --random-pushes` "
                "measures another box"
            )
        _require_robot(self._map, scenario)
        if scenario.room.slope_deg != 0.0:
            raise ScenarioError(
                f"{scenario.name}: expected a level floor for a response map, got a slope of "
                f"{scenario.room.slope_deg:g}°"
            )

    def begin(self, scenario: Scenario, seed: int) -> None:
        """Begin with the residuals of the seed."""
        self._normal = _residuals_of(seed)

    def after(self, before: Pose2, push: Push, *, first: bool) -> Pose2:
        """The pose by the surface of the face."""
        try:
            surface = self._map.surface(push.face)
        except ConfigError as error:
            raise MotionError(str(error)) from error
        _require_push(push, surface.deepest_m)
        after = self._map.push(
            np.array([[before.x_m, before.y_m, before.yaw_rad]]),
            np.array([MIRROR[push.leg]]),
            np.array([push.depth_m]),
            np.array([push.w1]),
            np.array([push.w2]),
            face=push.face,
            first=first,
            normal=self._normal.standard_normal((1, 3)) if self._residuals else None,
        )
        x_m, y_m, yaw_rad = after[0].tolist()
        return Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)


class DrawnEffects:
    """Those of a box of which only the size is known: each episode draws what it does.

    It draws from what the estimate of a mission expects of such boxes. A slope is one of the reasons for which boxes
    differ, so the floor may have any.
    """

    def __init__(self, response_map: ResponseMap) -> None:
        self._map = response_map

    def require_described(self, scenario: Scenario) -> None:
        """Require the robot of the map (`ScenarioError`)."""
        _require_robot(self._map, scenario)

    def begin(self, scenario: Scenario, seed: int) -> None:
        """Begin with another box."""
        self._scenario, self._seed = scenario, seed
        self._normal = _residuals_of(seed)
        self._responses: dict[Face, Response] = {}

    def after(self, before: Pose2, push: Push, *, first: bool) -> Pose2:
        """The pose by the response that was drawn for the face, with a residual."""
        response, box = self._response(push.face), pushed_box(self._scenario.box, push.face)
        _require_push(push, response.depth_m[-1])
        depth_m = np.array([max(push.depth_m - response.lost_depth_m, 0.0)])
        mean = np.concatenate(response.displacement(np.array([MIRROR[push.leg]]), depth_m))
        by_curve = np.concatenate(nearest_model(box).beyond_usual_curve(push, depth_m))
        kind = kind_of(box)
        sds = np.sqrt(np.concatenate([each.variance(depth_m) for each in (kind.forward, kind.left, kind.turn)]))
        x_m, y_m, yaw_rad = (mean + by_curve + sds * self._normal.standard_normal(3)).tolist()
        return before @ Pose2(x_m=x_m, y_m=y_m, yaw_rad=yaw_rad)

    def _response(self, face: Face) -> Response:
        if face not in self._responses:
            sequence = np.random.SeedSequence(self._seed, spawn_key=(BOX_KEY, FACES.index(face)))
            box = pushed_box(self._scenario.box, face)
            self._responses[face] = drawn_response(box, np.random.default_rng(sequence))
        return self._responses[face]


def _residuals_of(seed: int) -> np.random.Generator:
    return np.random.default_rng(np.random.SeedSequence(seed, spawn_key=(RESIDUALS_KEY,)))


def _require_robot(response_map: ResponseMap, scenario: Scenario) -> None:
    if scenario.robot != response_map.robot:
        raise ScenarioError(f"{scenario.name}: expected the robot of the response map, got another one")


def _require_push(push: Push, deepest_m: float) -> None:
    if push.depth_m > deepest_m or push.locus != "swing":
        raise MotionError(
            f"Expected a push of at most {deepest_m:g} m with the locus `swing`, which the map describes, got "
            f"{push.depth_m:g} m with the locus `{push.locus}`"
        )
