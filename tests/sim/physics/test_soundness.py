"""Numbers of a simulation that are not sound end its episode."""

import numpy as np
import pytest

from legpush.errors import LegpushError
from sim_proc.headless import mujoco
from sim_proc.physics.soundness import require_sound

WARNINGS = np.zeros(8, dtype=np.int64)


def test_finite_numbers_without_a_warning_are_sound() -> None:
    require_sound(WARNINGS, np.zeros((3, 26)), 7)


def test_a_warning_is_named_with_its_ticks() -> None:
    warned = WARNINGS.copy()
    warned[int(mujoco.mjtWarning.mjWARN_BADQACC)] = 1
    with pytest.raises(LegpushError, match="mjWARN_BADQACC between ticks 4 and 7"):
        require_sound(warned, np.zeros((3, 26)), 7)


def test_a_number_that_is_not_finite_is_named() -> None:
    with pytest.raises(LegpushError, match="qpos stopped being finite between ticks 6 and 7"):
        require_sound(WARNINGS, np.full((1, 26), np.nan), 7)
