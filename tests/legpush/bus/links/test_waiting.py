"""A client waits for a router: it goes on as soon as there is one, and ends at once when it is told to."""

import logging
import threading
import time

import pytest

from legpush.bus.links.waiting import NobodyThereError, open_when_there
from legpush.errors import EndpointError, StopRequestedError

ROUTERS = ("tcp/127.0.0.1:1", "tcp/127.0.0.1:2")


class Opening:
    """Fails some times, and then opens."""

    def __init__(self, *errors: Exception) -> None:
        self.errors = list(errors)

    def __call__(self) -> str:
        if self.errors:
            raise self.errors.pop(0)
        return "session"


def test_it_tries_until_a_router_is_there_and_tells_each_reason_once(caplog: pytest.LogCaptureFixture) -> None:
    opening = Opening(NobodyThereError("a"), NobodyThereError("a"), NobodyThereError("b"))
    caplog.set_level(logging.INFO)
    assert open_when_there(opening, ROUTERS, threading.Event()) == "session"
    assert [record.getMessage() for record in caplog.records] == [
        f"waiting for a router at {', '.join(ROUTERS)}: {why}" for why in "ab"
    ]


def test_another_error_is_raised_as_it_is() -> None:
    with pytest.raises(EndpointError, match="a port"):
        open_when_there(Opening(EndpointError("a port")), ROUTERS, threading.Event())


def test_a_stop_ends_an_attempt_that_hangs() -> None:
    stop, hangs, never = threading.Event(), threading.Event(), threading.Event()

    def open_once() -> None:
        hangs.set()
        stop.set()
        never.wait()

    with pytest.raises(StopRequestedError, match=r"interrupted while waiting for a router at tcp/127.0.0.1:1, tcp"):
        open_when_there(open_once, ROUTERS, stop)
    assert hangs.is_set()
    never.set()


def test_a_stop_leaves_an_attempt_the_time_to_end() -> None:
    stop, ended = threading.Event(), threading.Event()

    def open_once() -> None:
        stop.set()
        time.sleep(0.3)
        ended.set()
        raise NobodyThereError("nobody")

    with pytest.raises(StopRequestedError):
        open_when_there(open_once, ROUTERS, stop)
    assert ended.is_set()


def test_a_stop_ends_the_wait_between_attempts() -> None:
    stop, n_attempts = threading.Event(), list[int]()

    def open_once() -> None:
        n_attempts.append(1)
        stop.set()
        raise NobodyThereError("nobody")

    with pytest.raises(StopRequestedError):
        open_when_there(open_once, ROUTERS, stop)
    assert len(n_attempts) == 1
