"""States of the random generators that a training draws from, as plain data."""

import random
from typing import Annotated

import numpy as np
import torch
from msgspec import Meta, Struct

from agent_proc.learning.plain_array import PlainArray, from_plain, to_plain

N_WORDS = 624
"""Number of words in the state of a Mersenne Twister."""
Hex128 = Annotated[str, Meta(pattern=r"\A[0-9a-f]{32}\Z")]
"""128 bits, which are more than an integer of MessagePack has."""
Word = Annotated[int, Meta(ge=0, lt=2**32)]
Bit = Annotated[int, Meta(ge=0, le=1)]


class Pcg64State(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """State of a NumPy generator of the kind PCG64."""

    state: Hex128
    inc: Hex128
    has_uint32: Bit
    uinteger: Word


def state_of(generator: np.random.Generator) -> Pcg64State:
    """The present state of the generator.

    Raises:
        ValueError: It is of another kind.
    """
    state = generator.bit_generator.state
    if state["bit_generator"] != "PCG64":
        raise ValueError(f"Expected a generator of the kind PCG64, got {state['bit_generator']}")
    words = {name: f"{state['state'][name]:032x}" for name in ("state", "inc")}
    return Pcg64State(has_uint32=int(state["has_uint32"]), uinteger=int(state["uinteger"]), **words)


def set_state(generator: np.random.Generator, state: Pcg64State) -> None:
    """Return a generator of the kind PCG64 to a state."""
    generator.bit_generator.state = {
        "bit_generator": "PCG64",
        "state": {"state": int(state.state, 16), "inc": int(state.inc, 16)},
        "has_uint32": state.has_uint32,
        "uinteger": state.uinteger,
    }


class GlobalRandomState(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """States of the generators that Python, NumPy and PyTorch share among all callers in a process."""

    python: PlainArray
    """The words and the position among them, (625,)."""
    python_gauss: float | None
    numpy: PlainArray
    """The words, (624,)."""
    numpy_position: Annotated[int, Meta(ge=0, le=N_WORDS)]
    numpy_has_gauss: Bit
    numpy_gauss: float
    torch: PlainArray


def global_random_state() -> GlobalRandomState:
    """The present states."""
    _, words, gauss = random.getstate()
    _, numpy_words, position, has_gauss, numpy_gauss = np.random.get_state(legacy=True)  # noqa: NPY002 - SB3 draws from it
    return GlobalRandomState(
        python=to_plain(np.array(words, dtype=np.uint32)),
        python_gauss=gauss,
        numpy=to_plain(np.asarray(numpy_words)),
        numpy_position=int(position),
        numpy_has_gauss=int(has_gauss),
        numpy_gauss=float(numpy_gauss),
        torch=to_plain(torch.get_rng_state().numpy()),
    )


def set_global_random_state(state: GlobalRandomState) -> None:
    """Return the generators to their states.

    Raises:
        ValueError: A state has another shape than that of its generator, or cannot be one.
    """
    python = from_plain(state.python, np.zeros(N_WORDS + 1, dtype=np.uint32), "random.python")
    numpy = from_plain(state.numpy, np.zeros(N_WORDS, dtype=np.uint32), "random.numpy")
    of_torch = from_plain(state.torch, torch.get_rng_state().numpy(), "random.torch")
    random.setstate((3, tuple(python.tolist()), state.python_gauss))
    np.random.set_state(("MT19937", numpy, state.numpy_position, state.numpy_has_gauss, state.numpy_gauss))  # noqa: NPY002
    try:
        torch.set_rng_state(torch.from_numpy(of_torch))
    except RuntimeError as error:
        raise ValueError(f"at `random.torch`: {error}") from error
