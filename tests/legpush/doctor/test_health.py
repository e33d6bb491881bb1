"""Whether a process is up: routers that answer, tokens that are seen, and what cannot be asked."""

import json
from collections.abc import Iterator
from contextlib import ExitStack, closing
from pathlib import Path

import pytest

from legpush.bus.bus import Bus
from legpush.bus.endpoints import Endpoints, by_router
from legpush.bus.secure.certificate_names import CertificateRole
from legpush.bus.secure.host_folder import read_credentials
from legpush.bus.session import ZenohSession
from legpush.cli import command as cli
from legpush.messages.common import Role
from tests.ports import free_ports
from tests.security.hosts import free_endpoint, made

SOON: tuple[str, ...] = ("--wait", "0.3")


@pytest.fixture
def stack() -> Iterator[ExitStack]:
    """Ends what a test started."""
    with ExitStack() as stack:
        yield stack


def free_tcp() -> str:
    return f"tcp/127.0.0.1:{free_ports(1)[0]}"


def router(stack: ExitStack, at: str) -> None:
    stack.enter_context(closing(ZenohSession(Endpoints(listen=(at,), mode="router"), "router")))


def process(stack: ExitStack, role: Role, name: str, at: Endpoints) -> Bus:
    """A process that is ready."""
    bus = stack.enter_context(Bus("local", role, name, at))
    bus.announce()
    return bus


def test_a_router_is_up_once_it_answers(stack: ExitStack, capsys: pytest.CaptureFixture[str]) -> None:
    at = free_tcp()
    assert cli.main(["health", "router", "--router", at, *SOON]) == 1
    assert capsys.readouterr().out == f"router is not up, asked at {at}\n"
    router(stack, at)
    assert cli.main(["health", "router", "--router", at]) == 0
    assert capsys.readouterr().out == f"router is up, asked at {at}\n"


def test_a_process_is_up_while_its_token_is_seen_behind_a_router(
    stack: ExitStack, capsys: pytest.CaptureFixture[str]
) -> None:
    at = free_tcp()
    router(stack, at)
    with ExitStack() as inner:
        process(inner, "sim", "a", by_router((at,)))
        assert cli.main(["health", "sim", "--name", "a", "--router", at]) == 0
        for other in (["sim"], ["planner", "--name", "a"], ["sim", "--name", "a", "--run", "other"]):
            assert cli.main(["health", *other, "--router", at, *SOON]) == 1, other
    capsys.readouterr()
    assert cli.main(["health", "sim", "--name", "a", "--router", at, "--json", *SOON]) == 1
    told = json.loads(capsys.readouterr().out)
    assert told == {"role": "sim", "name": "a", "run": "local", "up": False, "asked_at": [at]}


def test_a_process_is_asked_where_it_listens(stack: ExitStack, tmp_path: Path) -> None:
    at = f"unixsock-stream/{tmp_path}/sim.sock"
    assert cli.main(["health", "sim", "--connect", at, *SOON]) == 1
    process(stack, "sim", "main", Endpoints(listen=(at,)))
    assert cli.main(["health", "sim", "--connect", at]) == 0


def test_a_viewer_is_a_recorder_whose_name_nobody_knows(stack: ExitStack) -> None:
    at = free_tcp()
    router(stack, at)
    process(stack, "recorder", "main", by_router((at,)))
    assert cli.main(["health", "viewer", "--router", at, *SOON]) == 1
    process(stack, "recorder", "view-a1b2c3", by_router((at,)))
    assert cli.main(["health", "viewer", "--router", at]) == 0


@pytest.mark.parametrize("role", ["router", "planner", "sim", "agent", "launcher", "recorder", "viewer"])
def test_each_role_can_ask_about_itself_with_its_own_certificate(
    role: CertificateRole, stack: ExitStack, tmp_path: Path
) -> None:
    host, at = made(tmp_path / "lab", routers=("robot",)), free_endpoint()
    own = Endpoints(listen=(at,), credentials=read_credentials(host, "router"), mode="router")
    stack.enter_context(closing(ZenohSession(own, "router")))
    shown = {"viewer": ("recorder", "view-1"), "router": ("sim", "main")}.get(role, (role, "main"))
    certificate = read_credentials(host, "sim" if role == "router" else role)
    process(stack, shown[0], shown[1], by_router((at,), certificate))  # type: ignore[arg-type]
    assert cli.main(["health", role, "--router", at, "--secure", str(host)]) == 0


@pytest.mark.parametrize(
    ("words", "told"),
    [
        (["recorder"], "Expected --router or --connect for a recorder, which has no usual endpoint, got neither"),
        (["sim", "--name", "a b"], "--name"),
        (["sim", "--wait", "0"], "--wait"),
        (["sim", "--router", "tcp/a:1", "--connect", "tcp/a:2"], "Expected either --router or --listen and --connect"),
        (["sim", "--router", "udp/a:1"], "(protocols: unixsock-stream, tcp, tls), got 'udp/a:1'"),
        (["sim", "--secure", "nowhere"], "Expected the folder of a host for --secure"),
    ],
)
def test_bad_input_is_one_sentence(words: list[str], told: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["health", *words]) == 2
    said = capsys.readouterr().err
    assert told in said
    assert said.count("\n") == 1
