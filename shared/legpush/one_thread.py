"""One thread per numerical library, for every process that simulates: set it before NumPy is imported.

Arrays here are small, more threads only get in each other's way; and sums that several threads share are rounded
otherwise, so that a simulation would end in another state.
"""

from typing import Final

ONE_THREAD: Final = {f"{library}_NUM_THREADS": "1" for library in ("OMP", "OPENBLAS", "MKL")}
"""Environment variables."""
