"""Memory, threads and open files of processes while they work, and whether these stay flat."""

from collections.abc import Mapping, Sequence
from statistics import median
from typing import Final

import psutil
from msgspec import Struct

WARM_UP: Final = 0.2
"""Share of the samples in which memory may still grow."""
FLAT: Final = 0.01
LEAST_SAMPLES: Final = 10


class Sample(Struct, frozen=True, kw_only=True):
    """What a process holds at some time."""

    memory_mb: float
    """Resident."""
    n_threads: int
    n_files: int


class Growth(Struct, frozen=True, kw_only=True):
    """How much more a process held in the last quarter of the time than in the first one after it was warm."""

    n_samples: int
    memory_mb: float
    """Median of the last quarter."""
    memory: float
    """Share by which the median grew."""
    threads: int
    files: int

    @property
    def is_flat(self) -> bool:
        """Whether nothing grew, but memory by less than 1 %."""
        return self.memory < FLAT and self.threads <= 0 and self.files <= 0


def sample(process: psutil.Process) -> Sample:
    """Return what a process holds now.

    Raises:
        psutil.Error: There is no such process any more.
    """
    with process.oneshot():
        return Sample(
            memory_mb=round(process.memory_info().rss / 1e6, 3),
            n_threads=process.num_threads(),
            n_files=process.num_fds(),
        )


def growth(samples: Sequence[Sample]) -> Growth | None:
    """Return how much a process grew; None for too few samples."""
    warm = samples[round(WARM_UP * len(samples)) :]
    quarter = len(warm) // 4
    if len(samples) < LEAST_SAMPLES or quarter == 0:
        return None
    first, last = warm[:quarter], warm[-quarter:]
    before_mb, after_mb = (median(one.memory_mb for one in part) for part in (first, last))
    return Growth(
        n_samples=len(samples),
        memory_mb=after_mb,
        memory=round(after_mb / before_mb - 1.0, 5),
        threads=round(median(one.n_threads for one in last) - median(one.n_threads for one in first)),
        files=round(median(one.n_files for one in last) - median(one.n_files for one in first)),
    )


def growths(samples: Mapping[str, Sequence[Sample]]) -> dict[str, Growth | None]:
    """Return the growth of each process."""
    return {name: growth(each) for name, each in samples.items()}
