"""`legpush router` as a process: it routes, says what is wrong, and its clients wait for it and find it again."""

import json
import signal
import subprocess
import sys
from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path

import pytest
import zenoh

from legpush.bus.endpoints import Endpoints, by_router, of_router
from legpush.bus.links.configuration import configuration
from legpush.bus.session import ZenohSession
from legpush.cli import command as cli
from legpush.options.run import RouterOptions
from tests.legpush.fakes import eventually
from tests.ports import free_ports
from tests.system.missions import LEGPUSH, LIMIT_S


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    """Ends what a test started."""
    with ExitStack() as stack:
        yield stack


def free_tcp() -> str:
    return f"tcp/127.0.0.1:{free_ports(1)[0]}"


def started(stack: ExitStack, log: Path, words: list[str], *, until: str) -> "subprocess.Popen[bytes]":
    """Start a process, and wait for what it writes."""
    with log.open("wb") as output:
        process = subprocess.Popen(words, stdout=output, stderr=subprocess.STDOUT)
    stack.callback(process.wait)
    stack.callback(process.kill)
    assert eventually(lambda: until in log.read_text(), LIMIT_S), log.read_text()
    return process


def test_clients_find_each_other_through_it_and_again_after_it_was_killed(stack: ExitStack, tmp_path: Path) -> None:
    at, log, tokens = free_tcp(), tmp_path / "router.log", list[tuple[str, bool]]()
    words = [*LEGPUSH, "router", "--listen", at]
    router = started(stack, log, words, until="routing")
    first, second = (stack.enter_context(closing(ZenohSession(by_router((at,)), "sim"))) for _ in range(2))
    kept = (first.show_token("a/b"), second.watch_tokens("a/*", lambda key, lives: tokens.append((key, lives))))
    assert eventually(lambda: tokens == [("a/b", True)])
    router.kill()
    assert eventually(lambda: tokens[-1] == ("a/b", False))
    again = started(stack, log, words, until="routing")
    assert eventually(lambda: tokens[-1] == ("a/b", True))
    again.send_signal(signal.SIGTERM)
    assert again.wait(LIMIT_S) == 0
    assert kept


def test_a_client_goes_over_to_another_router(stack: ExitStack) -> None:
    first, second = free_tcp(), free_tcp()
    routers = [ZenohSession(Endpoints(listen=(at,), mode="router"), "router") for at in (first, second)]
    stack.callback(routers[1].close)
    client = stack.enter_context(closing(ZenohSession(by_router((first, second)), "sim")))
    heard = list[str]()
    kept = [client.subscribe("a/b", lambda key, _: heard.append(key))]
    routers[0].close()

    def heard_by_the_other() -> bool:
        routers[1].put("a/b", b"")
        return bool(heard)

    assert eventually(heard_by_the_other)
    assert kept


@pytest.mark.parametrize("number", [signal.SIGINT, signal.SIGTERM])
@pytest.mark.parametrize("role", ["planner", "sim", "agent"])
def test_a_process_whose_router_is_not_there_ends_at_once(
    role: str, number: signal.Signals, stack: ExitStack, tmp_path: Path
) -> None:
    at, log = free_tcp(), tmp_path / "log"
    words = [sys.executable, "-P", "-m", f"{role}_proc", "--router", at]
    words += ["--out", str(tmp_path / "run")] if role == "agent" else []
    process = started(stack, log, words, until=f"waiting for a router at {at}: none can be reached")
    process.send_signal(number)
    assert process.wait(LIMIT_S) == 130
    assert log.read_text().endswith(f"error: interrupted while waiting for a router at {at}\n")


def test_the_printed_configuration_is_its_own_and_zenoh_takes_it(capsys: pytest.CaptureFixture[str]) -> None:
    at, other = free_tcp(), free_tcp()
    assert cli.main(["router", "--listen", at, "--connect", other, "--print-config"]) == 0
    printed = capsys.readouterr().out
    assert json.loads(printed) == configuration(Endpoints(listen=(at,), connect=(other,), mode="router"))
    with zenoh.open(zenoh.Config.from_json5(printed)), closing(ZenohSession(by_router((at,)), "sim")) as client:
        assert eventually(lambda: len(client.linked()) == 0)


def test_the_usual_place_is_a_socket_of_this_user() -> None:
    assert RouterOptions().listen == ()
    assert of_router().startswith("unixsock-stream//tmp/legpush.")


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["--listen", "udp/1.2.3.4:1"], "(protocols: unixsock-stream, tcp, tls), got 'udp/1.2.3.4:1'"),
        (["--listen", "tls/127.0.0.1:1"], "Expected --secure DIR with tls/127.0.0.1:1, got no certificate"),
        (["--secure", "nowhere"], "Expected the folder of a host for --secure"),
    ],
)
def test_bad_input_is_one_sentence(words: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["router", *words]) == 2
    said = capsys.readouterr().err
    assert told in said
    assert said.count("\n") == 1


def test_a_port_that_is_taken_is_told(capsys: pytest.CaptureFixture[str]) -> None:
    at = free_tcp()
    with closing(ZenohSession(Endpoints(listen=(at,), mode="router"), "router")):
        assert cli.main(["router", "--listen", at]) == 2
    assert f"Expected to listen on {at} as router, but that is not possible" in capsys.readouterr().err
