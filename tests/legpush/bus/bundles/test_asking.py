"""A learner asks simulators of one process together, gets the same states, and falls back where bundles do not pass."""

from concurrent.futures import ThreadPoolExecutor

import pytest

from legpush.bus import keys
from legpush.bus.endpoints import Endpoints
from legpush.lockstep.bus_world import BusWorld
from legpush.messages import codec
from legpush.messages.bundle import Bundle, Part
from legpush.messages.stepping import Action, Motion, Walk
from legpush.soak.stub_simulator import chained
from tests.legpush.bus.bundles.lab import Network, learner, question, simulators, worlds
from tests.legpush.bus.memory_session import RUN
from tests.legpush.examples import RESET, header
from tests.legpush.fakes import eventually

N_STEPS = 12
LONG = b"x" * 100_000


@pytest.fixture
def network() -> Network:
    """Nobody is there yet."""
    return Network()


def step_together(some: list[BusWorld], n_steps: int = N_STEPS) -> list[list[int]]:
    """Step all worlds in the same moment, as a learner does; returns their states."""
    motions: list[Motion] = [RESET, *(Walk() for _ in range(n_steps - 1))]
    with ThreadPoolExecutor(len(some)) as threads:
        return [
            [each.state_crc for each in threads.map(lambda world, motion=motion: world.step(motion), some)]
            for motion in motions
        ]


def expected(n: int, n_steps: int = N_STEPS) -> list[list[int]]:
    """The states that follow from the motions alone."""
    crcs, crc = [], 0
    motions: list[Motion] = [RESET, *(Walk() for _ in range(n_steps - 1))]
    for motion in motions:
        crc = chained(crc, motion)
        crcs.append([crc] * n)
    return crcs


def test_simulators_of_a_process_are_asked_and_answer_together_with_the_same_states(network: Network) -> None:
    with (
        simulators(network, "host", 4),
        learner(network) as (bus, _),
        worlds(bus, *(f"host-{number}" for number in range(1, 5))) as some,
    ):
        assert step_together(some) == expected(4)
    sizes = [len(codec.decode(payload, Bundle).parts) for payload in network.bundles("action")]
    assert sum(sizes) == 4 * N_STEPS
    assert max(sizes) == 4
    assert network.alone("action") == []
    assert sum(len(codec.decode(payload, Bundle).parts) for payload in network.bundles("observation")) == 4 * N_STEPS


def test_simulators_of_several_processes_each_have_bundles_of_their_own(network: Network) -> None:
    with (
        simulators(network, "one", 2),
        simulators(network, "two", 2),
        learner(network) as (bus, _),
        worlds(bus, "one-1", "two-1", "one-2", "two-2") as some,
    ):
        assert step_together(some) == expected(4)
    for payload in network.bundles("action"):
        named = {part.key.split("/")[4].partition("-")[0] for part in codec.decode(payload, Bundle).parts}
        assert len(named) == 1


def test_an_agent_that_knows_no_bundles_is_answered_alone(network: Network) -> None:
    with simulators(network, "host", 2), network.bus("agent") as bus:
        bus.announce()
        with worlds(bus, "host-1", "host-2") as some:
            assert step_together(some) == expected(2)
    assert network.bundles("observation") == []


def test_an_agent_without_bundles_misses_no_answer_after_a_bundle_of_an_agent_that_is_gone(network: Network) -> None:
    with simulators(network, "host", 2) as members, network.bus("agent") as bus:
        bus.announce()
        process = keys.process_of(members[0].incarnation)
        assert process is not None
        gone = codec.encode(Action(header=header("agent", "gone"), episode=1, step=0, motion=RESET, with_trace=False))
        bundle = codec.encode(Bundle(parts=(Part(key=keys.action(RUN, "host-1"), payload=gone),)))
        network.open_session(Endpoints(), "gone").put(keys.bundled_actions(RUN, process), bundle)
        assert eventually(lambda: members[0].tally.as_dict() == {"no_token": 1})
        with worlds(bus, "host-1", "host-2") as some:
            assert step_together(some, 2) == expected(2, 2)
    assert network.bundles("observation") == []


def test_a_process_that_gets_no_bundles_is_asked_alone_after_a_while(
    network: Network, caplog: pytest.LogCaptureFixture
) -> None:
    network.loses_bundles = True
    with simulators(network, "host", 2), learner(network) as (bus, _), worlds(bus, "host-1", "host-2") as some:
        assert step_together(some) == expected(2)
    assert "is asked alone from now on: its process does not get bundles" in caplog.text
    assert 3 <= len(network.bundles("action")) <= 6


def test_a_far_process_is_asked_in_bundles_although_each_question_is_asked_again(
    network: Network, caplog: pytest.LogCaptureFixture
) -> None:
    """A round trip takes longer than a learner waits before it asks again, so each question is answered twice."""
    with (
        simulators(network, "host", 4),
        learner(network) as (bus, _),
        worlds(bus, *(f"host-{number}" for number in range(1, 5))) as some,
    ):
        network.delay_s = 0.08
        assert step_together(some, 4) == expected(4, 4)
        network.delay_s = 0.0
    assert len(network.alone("action")) >= 4 * 3
    assert sum(len(codec.decode(payload, Bundle).parts) for payload in network.bundles("action")) == 4 * 4
    assert "asked alone from now on" not in caplog.text


def test_a_bundle_that_was_lost_changes_nothing_for_those_after_it(
    network: Network, caplog: pytest.LogCaptureFixture
) -> None:
    """As with a link that broke: it counts once, however many simulators were asked in it."""
    with (
        simulators(network, "host", 4),
        learner(network) as (bus, _),
        worlds(bus, *(f"host-{number}" for number in range(1, 5))) as some,
    ):
        network.loses_bundles = True
        step_together(some, 1)
        network.loses_bundles = False
        n_alone = len(network.alone("action"))
        assert step_together(some, 3) == expected(4, 3)
        assert len(network.alone("action")) == n_alone == 4
    assert "asked alone from now on" not in caplog.text


def test_a_process_in_the_place_of_another_is_asked_in_bundles_of_its_own(network: Network) -> None:
    with learner(network) as (bus, session), worlds(bus, "host-1", "host-2") as some:
        for _ in range(3):
            with simulators(network, "host", 2):
                assert step_together(some) == expected(2)
        assert len({key for key, _ in network.put if key.endswith("/action") and "/bundle/" in key}) == 3
        assert len(session._processes) == 1


def test_two_processes_of_one_name_are_asked_alone_or_not_at_all(network: Network) -> None:
    with simulators(network, "host", 1), learner(network) as (_, session):
        assert session._process_to_ask("host-1", question(0)) is not None
        network.open_session(Endpoints(), "rival").show_token(keys.liveliness(RUN, "sim", "host-1", "other"))
        assert session._process_to_ask("host-1", question(1)) is None


def test_what_is_long_or_asked_again_goes_alone(network: Network) -> None:
    with simulators(network, "host", 2), learner(network) as (_, session):
        assert session._process_to_ask("host-1", question(0) + LONG) is None
        assert session._process_to_ask("host-2", question(0)) is not None
        session._note_answer("host-2", has_arrived=False)
        assert session._process_to_ask("host-2", question(0)) is None
        assert session._process_to_ask("host-2", question(1)) is not None
        assert session._process_to_ask("host-2", b"no question") is None


@pytest.mark.parametrize(
    "payload",
    [
        b"",
        b"\xc1",
        codec.encode(Part(key="a", payload=b"")),
        b"\x81\xa5parts\x90",
        codec.encode(Bundle(parts=tuple(Part(key="k", payload=b"") for _ in range(257)))),
    ],
)
def test_what_is_no_bundle_is_counted_and_nothing_else_happens(network: Network, payload: bytes) -> None:
    with (
        simulators(network, "host", 2) as members,
        learner(network) as (bus, session),
        worlds(bus, "host-1", "host-2") as some,
    ):
        step_together(some, 2)
        process = keys.process_of(members[0].incarnation)
        assert process is not None
        stranger = network.open_session(Endpoints(), "stranger")
        stranger.put(keys.bundled_answers(RUN, process), payload)
        stranger.put(keys.bundled_actions(RUN, process), payload)
        assert sum(session.tally.as_dict().values()) == 1
        assert step_together(some) == expected(2)


def test_a_bundle_brings_nothing_but_what_it_is_for(network: Network) -> None:
    """A part under another key, such as that of a plan, is not handed on."""
    with (
        simulators(network, "host", 2) as members,
        learner(network) as (bus, _),
        worlds(bus, "host-1", "host-2") as some,
    ):
        step_together(some, 2)
        process = keys.process_of(members[0].incarnation)
        assert process is not None
        strange = [keys.plan_result(RUN, "main"), keys.observation("other", "host-1"), keys.action(RUN, "host-1")]
        bundle = Bundle(parts=tuple(Part(key=key, payload=b"\xc1") for key in strange))
        network.open_session(Endpoints(), "stranger").put(keys.bundled_answers(RUN, process), codec.encode(bundle))
        assert bus.tally.as_dict() == {}
        wrong = Bundle(parts=(Part(key=keys.observation(RUN, "host-1"), payload=b"\xc1"),))
        network.open_session(Endpoints(), "stranger").put(keys.bundled_answers(RUN, process), codec.encode(wrong))
        assert eventually(lambda: sum(bus.tally.as_dict().values()) == 1)
        assert step_together(some) == expected(2)
