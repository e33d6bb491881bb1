"""States of generators: they draw the same again, and a state that is none is refused."""

import random

import msgspec
import numpy as np
import pytest
import torch
from msgspec.structs import replace

from agent_proc.learning.plain_array import to_plain
from agent_proc.learning.random_state import (
    GlobalRandomState,
    Pcg64State,
    global_random_state,
    set_global_random_state,
    set_state,
    state_of,
)


def global_draws() -> list[float]:
    return [random.random(), random.gauss(0.0, 1.0), np.random.random(), np.random.normal(), torch.rand(1).item()]  # noqa: NPY002


def test_the_generators_of_the_process_draw_the_same_again() -> None:
    global_draws()
    state = msgspec.msgpack.decode(msgspec.msgpack.encode(global_random_state()), type=GlobalRandomState)
    expected = [global_draws() for _ in range(3)]

    set_global_random_state(state)
    assert [global_draws() for _ in range(3)] == expected


def test_a_generator_draws_the_same_again() -> None:
    generator, other = np.random.default_rng(1), np.random.default_rng(2)
    generator.integers(5, dtype=np.uint32)
    state = msgspec.msgpack.decode(msgspec.msgpack.encode(state_of(generator)), type=Pcg64State)
    expected = generator.integers(5, size=9, dtype=np.uint32).tolist()

    set_state(other, state)
    assert other.integers(5, size=9, dtype=np.uint32).tolist() == expected


def test_a_generator_of_another_kind_has_no_such_state() -> None:
    with pytest.raises(ValueError, match="Expected a generator of the kind PCG64, got Philox"):
        state_of(np.random.Generator(np.random.Philox(1)))


@pytest.mark.parametrize("words", ["0" * 31, "g" * 32, "0" * 32 + "\n", "-" + "0" * 31])
def test_words_that_are_not_128_bits_are_refused(words: str) -> None:
    plain = {"state": words, "inc": "0" * 32, "has_uint32": 0, "uinteger": 0}

    with pytest.raises(msgspec.ValidationError, match=r"\$\.state"):
        msgspec.convert(plain, Pcg64State)


def test_bytes_that_are_no_state_of_torch_are_refused() -> None:
    zeros = to_plain(np.zeros_like(torch.get_rng_state().numpy()))

    with pytest.raises(ValueError, match=r"at `random\.torch`"):
        set_global_random_state(replace(global_random_state(), torch=zeros))
