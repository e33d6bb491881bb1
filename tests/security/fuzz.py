"""Mutated messages for the decoder: `python -m tests.security.fuzz --frames 1000000` tries as many per message type.

Each mutated frame must be decoded to a message that survives the way through bytes, or be refused by a `MessageError`,
in a moment and with little memory. Anything else ends the run with the frame.
"""

import argparse
import random
import resource
import sys
from collections import Counter
from collections.abc import Callable, Sequence
from copy import deepcopy
from dataclasses import dataclass, field
from time import perf_counter
from typing import Any, Final

import msgpack
import msgspec

from legpush.errors import MessageError
from legpush.messages import codec
from legpush.messages.schemas import MESSAGES as KINDS
from tests.legpush.examples import MESSAGES

FRAME_S: Final = 5.0
"""Longest time that a frame may take on a busy machine."""
GROWTH_MB: Final = 200.0
"""Most memory that the process may grow by."""
MARK: Final = b"<here comes something else>"
ODD: Final[tuple[Any, ...]] = (
    *(None, True, False, 0, -1, 2**31, 2**53 + 1, 2**63 - 1, 2**64 - 1, -(2**63)),
    *(0.5, -0.0, 1e308, -1e308, 5e-324, float("nan"), float("inf"), float("-inf")),
    *("", "x" * 300, "\x00", "../..", "*", "main/x", b"", b"\x00" * 300),
    *([], {}, [[]], {"a": {}}, [None] * 100, {"__proto__": 1}),
    *(msgpack.ExtType(5, b"x"), msgpack.Timestamp(1, 2)),
)
"""Values for fields of other types."""
HUGE: Final = tuple(bytes([first]) + b"\xff\xff\xff\xff" for first in (0xDD, 0xDF, 0xDB, 0xC6, 0xC9))
"""Heads of an array, a map, a text, bytes and an extension that claim four billion elements."""
EXAMPLES: Final[dict[type, list[bytes]]] = {
    kind: [codec.encode(message) for message in MESSAGES.values() if type(message) is kind] for kind in KINDS
}
ALL: Final = [payload for payloads in EXAMPLES.values() for payload in payloads]
PLAIN: Final[dict[bytes, Any]] = {payload: msgpack.unpackb(payload) for payload in ALL}
Mutate = Callable[[random.Random, bytes], bytes]


@dataclass
class Outcomes:
    """What happened to the frames of one message type."""

    kind: str
    n_frames: int = 0
    n_accepted: int = 0
    refused: Counter[str] = field(default_factory=Counter)
    longest_s: float = 0.0
    growth_mb: float = 0.0

    def __str__(self) -> str:
        """One line."""
        causes = ", ".join(f"{n} {cause}" for cause, n in sorted(self.refused.items()))
        return (
            f"{self.kind:<12} {self.n_frames} frames: {self.n_accepted} decoded, {causes}; "
            f"longest {1000 * self.longest_s:.1f} ms, memory +{self.growth_mb:.0f} MB"
        )


def flip(rng: random.Random, payload: bytes) -> bytes:
    """Flip some bits."""
    data = bytearray(payload)
    for _ in range(rng.randint(1, 8)):
        data[rng.randrange(len(data))] ^= 1 << rng.randrange(8)
    return bytes(data)


def cut(rng: random.Random, payload: bytes) -> bytes:
    """Cut the end off, or a piece out of it."""
    begin = rng.randrange(len(payload))
    return payload[:begin] + (payload[rng.randint(begin, len(payload)) :] if rng.random() < 0.5 else b"")


def splice(rng: random.Random, payload: bytes) -> bytes:
    """Put a piece of any message into this one, in place of a piece or between two."""
    other = rng.choice(ALL)
    begin, end = sorted(rng.randrange(len(other) + 1) for _ in range(2))
    at = rng.randrange(len(payload) + 1)
    return payload[:at] + other[begin:end] + payload[at + (end - begin if rng.random() < 0.5 else 0) :]


def scatter(rng: random.Random, payload: bytes) -> bytes:
    """Put random bytes somewhere."""
    at = rng.randrange(len(payload) + 1)
    return payload[:at] + rng.randbytes(rng.randint(1, 12)) + payload[at + rng.randint(0, 12) :]


def claim(rng: random.Random, payload: bytes) -> bytes:
    """Put a head that claims four billion elements somewhere."""
    at = rng.randrange(len(payload) + 1)
    return payload[:at] + rng.choice(HUGE) + payload[at + rng.choice((0, 1, 5)) :]


def retype(rng: random.Random, payload: bytes) -> bytes:
    """Give one to three fields a value of another type, or take them away."""
    return retyped(rng, deepcopy(PLAIN[payload]))


def retyped(rng: random.Random, plain: Any) -> bytes:
    """The same of a message as maps and arrays, which is changed."""
    for _ in range(rng.randint(1, 3)):
        holder, key = _place(rng, plain)
        if isinstance(holder, dict) and rng.random() < 0.2:
            del holder[key]
            holder[rng.choice(("__proto__", "", "x", "header"))] = 1
        else:
            holder[key] = deepcopy(rng.choice(ODD))
    return bytes(msgpack.packb(plain))


def repeat_key(rng: random.Random, payload: bytes) -> bytes:
    """Name a field of a map twice."""
    plain = deepcopy(PLAIN[payload])
    holder, key = _place(rng, {"top": plain})
    while not isinstance(holder[key], dict) or not holder[key]:
        holder, key = _place(rng, {"top": plain})
    fields = list(holder[key].items())
    fields.insert(rng.randint(0, len(fields)), (rng.choice(fields)[0], rng.choice(ODD)))
    twice = msgpack.Packer().pack_map_pairs(fields)
    if holder[key] is plain:
        return bytes(twice)
    holder[key] = MARK
    return bytes(msgpack.packb(plain)).replace(msgpack.packb(MARK), twice)


def nest(rng: random.Random, payload: bytes) -> bytes:
    """Put arrays or maps into each other, deeper than anything that a message has."""
    plain = deepcopy(PLAIN[payload])
    holder, key = _place(rng, plain)
    holder[key] = MARK
    depth = rng.choice((10, 100, 500, 1000, 1100, 3000))
    deep = rng.choice((b"\x91", b"\x81\xa1a", b"\xdc\x00\x01")) * depth + rng.choice((b"\xc0", b""))
    return bytes(msgpack.packb(plain)).replace(msgpack.packb(MARK), deep)


MUTATIONS: Final[tuple[Mutate, ...]] = (flip, cut, splice, scatter, claim, retype, retype, repeat_key, nest)


def mutated(rng: random.Random, payload: bytes) -> bytes:
    """The payload after one mutation of its fields, or one to three of its bytes."""
    mutate = rng.choice(MUTATIONS)
    payload = mutate(rng, payload)
    while payload and rng.random() < 0.2:
        payload = rng.choice((flip, cut, splice, scatter, claim))(rng, payload)
    return payload


def fuzz(kind: type[msgspec.Struct], n_frames: int, seed: int = 0) -> Outcomes:
    """Decode mutated frames of one message type.

    Raises:
        AssertionError: A frame has another end than a message or a `MessageError`, or takes long.
    """
    rng = random.Random(f"{kind.__name__} {seed}")
    outcomes, before_kb = Outcomes(kind.__name__), resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    for _ in range(n_frames):
        payload = mutated(rng, rng.choice(EXAMPLES[kind]))
        begin = perf_counter()
        try:
            message = codec.decode(payload, kind)
            is_sound = type(message) is kind and codec.decode(codec.encode(message), kind) == message
        except MessageError as error:
            outcomes.refused[error.cause] += 1
            message, is_sound = None, True
        except Exception as error:
            raise AssertionError(f"{type(error).__name__}: {error}; the frame is {payload.hex()}") from error
        assert is_sound, f"decoded to {message!r}: {payload.hex()}"
        outcomes.n_accepted += message is not None
        outcomes.longest_s = max(outcomes.longest_s, perf_counter() - begin)
        outcomes.n_frames += 1
    outcomes.growth_mb = (resource.getrusage(resource.RUSAGE_SELF).ru_maxrss - before_kb) / 1024
    assert outcomes.longest_s < FRAME_S, outcomes
    assert outcomes.growth_mb < GROWTH_MB, outcomes
    return outcomes


def _place(rng: random.Random, plain: Any) -> tuple[Any, Any]:
    """A map or array somewhere in a message, and a key or index of it."""
    holder, key = plain, rng.choice(list(plain))
    while isinstance(holder[key], dict | list) and holder[key] and rng.random() < 0.8:
        holder = holder[key]
        key = rng.choice(list(holder)) if isinstance(holder, dict) else rng.randrange(len(holder))
    return holder, key


def main(argv: Sequence[str] | None = None) -> int:
    """Fuzz each message type, and print a line for each."""
    parser = argparse.ArgumentParser(prog="python -m tests.security.fuzz", description=main.__doc__)
    parser.add_argument("--frames", type=int, default=10_000, help="mutated frames of each message type")
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--kind", choices=[kind.__name__ for kind in KINDS], help="this message type alone")
    options = parser.parse_args(argv)
    for kind in KINDS:
        if options.kind in (None, kind.__name__):
            sys.stdout.write(f"{fuzz(kind, options.frames, options.seed)}\n")
            sys.stdout.flush()
    return 0


if __name__ == "__main__":
    sys.exit(main())
