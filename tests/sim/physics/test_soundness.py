"""Simulations that cannot go on."""

import numpy as np
import pytest

from legpush.errors import LegpushError
from sim_proc.physics.soundness import require_sound

NO_WARNING = np.zeros(8, dtype=np.int64)


def test_a_warning_and_a_number_that_is_none_are_told_with_their_ticks() -> None:
    require_sound(NO_WARNING, np.zeros((2, 26)), 10)
    with pytest.raises(LegpushError, match="qpos stopped being finite between ticks 8 and 10"):
        require_sound(NO_WARNING, np.array([[0.0], [np.nan]]), 10)
    warned = NO_WARNING.copy()
    warned[5] = 1
    with pytest.raises(LegpushError, match=r"MuJoCo warned of mjWARN_\w+ between ticks 8 and 10"):
        require_sound(warned, np.zeros((2, 26)), 10)
