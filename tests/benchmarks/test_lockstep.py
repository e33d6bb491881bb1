"""The round trips of the benchmark: equal bytes on every transport, and what is made of their blocks."""

import os

import pytest

from benchmarks.bus import payloads
from benchmarks.bus.lockstep import Block, block, cpu_of, opened, reported, zenoh_settings
from benchmarks.bus.transports import TRANSPORTS
from legpush.messages import codec
from legpush.messages.stepping import Action, Observation, Walk


def test_the_question_is_a_walk_and_the_answers_have_about_the_sizes_asked_for() -> None:
    assert codec.decode(payloads.question(), Action).motion == Walk()
    for n_bytes in (10_000, 200_000):
        answer = payloads.answer(n_bytes)
        assert abs(len(answer) - n_bytes) < 0.05 * n_bytes
        assert codec.decode_own(answer, Observation) is not None


@pytest.mark.parametrize("name", ["legpush", "legpush router", "zenoh", "zenoh router", "zeromq", "grpc", "pipe"])
def test_a_transport_carries_the_bytes_of_the_answer(name: str) -> None:
    if (library := TRANSPORTS[name][2]) is not None:
        pytest.importorskip(library)
    with opened(name, 1_000) as (ask, pid):
        assert [ask() for _ in range(3)] == [0 if name.startswith("legpush") else len(payloads.answer(1_000))] * 3
        assert block(ask, pid, 3).cpu_us > 0.0


def test_ratios_are_those_of_blocks_of_the_same_round() -> None:
    blocks = {
        "legpush": [Block(30.0, 20.0), Block(60.0, 40.0)],
        "zenoh": [Block(15.0, 20.0), Block(30.0, 40.0)],
        "legpush tcp": [Block(30.0, 20.0), Block(60.0, 40.0)],
        "legpush tls": [Block(45.0, 20.0), Block(90.0, 40.0)],
        "legpush router": [Block(36.0, 20.0), Block(72.0, 40.0)],
        "zenoh router": [Block(30.0, 20.0), Block(60.0, 40.0)],
    }
    numbers = reported(blocks, 1_000)
    assert numbers["wall_over_zenoh"]["value"] == pytest.approx(2.0)
    assert numbers["cpu_over_zenoh"]["value"] == pytest.approx(1.0)
    assert numbers["wall_tls_over_tcp"]["value"] == pytest.approx(1.5)
    assert numbers["wall_over_zenoh_by_router"]["value"] == pytest.approx(1.2)
    assert not {"wall_over_legpush tls", "wall_over_legpush router", "wall_over_zenoh router"} & numbers.keys()


def test_the_settings_are_those_of_the_bus() -> None:
    settings = zenoh_settings()
    assert settings["publisher"]["express"] == "True"
    assert settings["session"]["transport"]["shared_memory"]["enabled"] is False


def test_the_cpu_time_of_a_process_grows() -> None:
    before = cpu_of(os.getpid())
    sum(range(1_000_000))
    assert cpu_of(os.getpid()) > before > 0.0
