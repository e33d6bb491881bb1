"""The stroke that pushes a heavy box: how far the foot is along its curve at each tick, and when its force acts.

The foot comes up to the box and rests there, presses it ahead, and stays in its place while the force goes. A foot that
came as fast as to a light box would set the robot swinging on its legs. One that went away while it still pressed would
let it spring forward.
"""

from typing import Final

import numpy as np

from legpush.arrays import Floats
from legpush.scene.robot_motion import PushMotion
from sim_proc.control.swing import minimum_jerk

RISE_SHARE: Final = 0.25
"""Share of the press in which the force rises."""


def heavy_ticks(motion: PushMotion) -> int:
    """Duration of the stroke."""
    return motion.approach_ticks + motion.press_ticks + motion.unload_ticks


def heavy_way(motion: PushMotion, meets: float) -> Floats:
    """Parameter of the curve at the end of each tick, (n,). The foot meets the box at the parameter `meets`."""
    approach, press = minimum_jerk(motion.approach_ticks), minimum_jerk(motion.press_ticks)
    return np.concatenate([meets * approach, meets + (1.0 - meets) * press, np.ones(motion.unload_ticks)])


def heavy_force(motion: PushMotion) -> Floats:
    """Share of the force of the push at the end of each tick, (n,)."""
    n_rising = max(round(RISE_SHARE * motion.press_ticks), 1)
    shares = np.ones(heavy_ticks(motion))
    shares[: motion.approach_ticks] = 0.0
    shares[motion.approach_ticks :][:n_rising] = minimum_jerk(n_rising)
    shares[-motion.unload_ticks :] = 1.0 - minimum_jerk(motion.unload_ticks)
    return shares
