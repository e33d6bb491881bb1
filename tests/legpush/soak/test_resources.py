"""What counts as flat: a warm-up may grow, and afterwards memory may by less than 1 %, threads and files not at all."""

import os
from collections.abc import Callable

import psutil
import pytest

from legpush.soak.resources import Sample, growth, sample


def samples(memory: Callable[[int], float], threads: Callable[[int], int] = lambda _: 5) -> list[Sample]:
    return [Sample(memory_mb=memory(i), n_threads=threads(i), n_files=9) for i in range(100)]


@pytest.mark.parametrize(
    ("series", "flat"),
    [
        (samples(lambda i: 100.0), True),
        (samples(lambda i: 50.0 + min(i, 15)), True),
        (samples(lambda i: 100.0 + 0.01 * i), True),
        (samples(lambda i: 100.0 + 0.05 * i), False),
        (samples(lambda i: 100.0 - 0.05 * i), True),
        (samples(lambda i: 100.0, lambda i: 5 + i // 50), False),
        (samples(lambda i: 100.0 + 400.0 * (i == 90)), True),
    ],
    ids=["constant", "warm-up", "a little", "leak", "shrinks", "threads", "one peak"],
)
def test_what_grows_after_the_warm_up_is_not_flat(series: list[Sample], flat: bool) -> None:
    found = growth(series)
    assert found is not None
    assert found.is_flat is flat, found


def test_too_few_samples_say_nothing() -> None:
    assert growth(samples(lambda i: 1.0)[:9]) is None


def test_a_sample_is_of_the_process() -> None:
    before = sample(psutil.Process())
    pipes = os.pipe()
    after = sample(psutil.Process())
    for pipe in pipes:
        os.close(pipe)
    assert after.n_files == before.n_files + 2
    assert after.memory_mb > 10.0
    assert after.n_threads >= 1
