"""Array types for all packages; the docstring of a function has the shape."""

import numpy as np
from numpy.typing import NDArray

Floats = NDArray[np.float64]
"""Float64, of any shape."""
Flags = NDArray[np.bool_]
"""Booleans, of any shape."""
Integers = NDArray[np.int64]
"""Int64, of any shape."""
Indices = NDArray[np.intp]
"""Indices into another array, of any shape."""
