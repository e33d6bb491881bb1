"""What is sent in the same moment travels together, and nothing waits for long or is lost."""

import threading
from collections import Counter
from concurrent.futures import ThreadPoolExecutor

import pytest

from legpush.bus.bundles.collector import MAX_BUNDLE_PARTS, MOST_VAIN_WAITS, Collector
from legpush.messages.bundle import Bundle, Part
from tests.legpush.fakes import eventually

LONG_S = 60.0


def part(text: str) -> Part:
    """A message."""
    return Part(key=text, payload=text.encode())


def keys_of(bundle: Bundle) -> list[str]:
    return [each.key for each in bundle.parts]


@pytest.fixture
def sent() -> list[Bundle]:
    """What was sent."""
    return []


def test_a_message_goes_at_once_when_nobody_else_is_expected(sent: list[Bundle]) -> None:
    collector = Collector(sent.append, LONG_S)
    collector.expect("a")
    collector.put("a", part("a"))
    assert [keys_of(bundle) for bundle in sent] == [["a"]]


def test_messages_of_all_who_are_expected_go_together_with_the_last_of_them(sent: list[Bundle]) -> None:
    collector = Collector(sent.append, LONG_S)
    for name in ("a", "b", "c"):
        collector.expect(name)
    first = threading.Thread(target=collector.put, args=("a", part("a")))
    first.start()
    assert eventually(lambda: bool(collector._parts))
    collector.put("b", part("b"))
    assert not sent
    collector.put("c", part("c"))
    first.join(10.0)
    assert [keys_of(bundle) for bundle in sent] == [["a", "b", "c"]]


def test_a_message_waits_no_longer_than_it_may(sent: list[Bundle]) -> None:
    collector = Collector(sent.append, 0.001)
    collector.expect("nobody")
    collector.put("a", part("a"))
    collector.put("b", part("b"))
    assert [keys_of(bundle) for bundle in sent] == [["a"], ["b"]]


def test_who_never_comes_is_not_waited_for_any_more_after_a_while(sent: list[Bundle]) -> None:
    collector = Collector(sent.append, 0.0001)
    collector.expect("nobody")
    for _ in range(MOST_VAIN_WAITS):
        assert collector._expected
        collector.put("a", part("a"))
    assert not collector._expected
    collector.expect("nobody")
    collector.forget("nobody")
    assert not collector._expected


def test_a_full_bundle_does_not_wait(sent: list[Bundle]) -> None:
    collector = Collector(sent.append, LONG_S)
    collector.expect("nobody")
    first = threading.Thread(target=collector.put, args=("0", part("0")))
    first.start()
    assert eventually(lambda: bool(collector._parts))
    for number in range(1, MAX_BUNDLE_PARTS):
        collector.put(str(number), part(str(number)))
    first.join(10.0)
    assert [len(bundle.parts) for bundle in sent] == [MAX_BUNDLE_PARTS]


def test_every_message_of_many_threads_is_sent_once(sent: list[Bundle]) -> None:
    collector = Collector(sent.append, 0.0005)
    names = [f"s{number}" for number in range(8)]

    def put_some(name: str) -> None:
        for number in range(50):
            collector.expect(name)
            collector.put(name, part(f"{name}/{number}"))

    with ThreadPoolExecutor(len(names)) as threads:
        for each in [threads.submit(put_some, name) for name in names]:
            each.result()
    found = Counter(key for bundle in sent for key in keys_of(bundle))
    assert found == Counter(f"{name}/{number}" for name in names for number in range(50))
