"""Footprints to test with."""

from math import pi

import numpy as np
from hypothesis import strategies as st

from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.scene.footprints import Footprint

LENGTH = st.floats(0.1, 3.0)
COORDINATE = st.floats(-1.0, 6.0)
FOOTPRINT = st.builds(
    Footprint,
    pose=st.builds(Pose2, x_m=COORDINATE, y_m=COORDINATE, yaw_rad=st.floats(-pi, pi)),
    length_m=LENGTH,
    width_m=LENGTH,
)


def samples_in(footprint: Footprint) -> Floats:
    """Points strictly inside, also near its border and corners, (n, 2)."""
    ticks = np.linspace(-0.4999, 0.4999, 41)
    u, v = np.meshgrid(ticks * footprint.length_m, ticks * footprint.width_m)
    return footprint.pose.apply(np.stack([u.ravel(), v.ravel()], axis=-1))
