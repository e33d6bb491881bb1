"""Checks `realism` against the robot and the room of its scenario."""

from collections.abc import Iterator
from math import ceil
from typing import Final

from legpush.realism.profiles import stated
from legpush.realism.settings import interval
from legpush.scene.scenario import Scenario

MAX_TILES: Final = 5000
"""Most tiles of a floor. More of them take longer to build than to walk on."""


def realism_faults(scenario: Scenario) -> Iterator[str]:
    """Yield what keeps the realism of a scenario from being simulated."""
    realism = stated(scenario.realism)
    if realism.floor.height_m is None or realism.floor.size_m is None:
        return
    height_m, step_m = interval(realism.floor.height_m)[1], scenario.robot.rough.step_height_m
    if height_m > step_m:
        yield (
            f"at `realism.floor.height_m`: expected at most the step height of the robot, {step_m:g} m "
            f"(`robot.rough.step_height_m`), got {height_m:g} m"
        )
    if height_m > 0.0:
        side_m, (width_m, depth_m) = interval(realism.floor.size_m)[0], scenario.room.size_m
        if (n_tiles := ceil(width_m / side_m) * ceil(depth_m / side_m)) > MAX_TILES:
            yield (
                f"at `realism.floor.size_m`: expected at most {MAX_TILES} tiles in {width_m:g} x {depth_m:g} m, got "
                f"{n_tiles} of {side_m:g} m"
            )
