"""Where processes listen and connect."""

import os
import socket
from pathlib import Path

import pytest

from legpush.authority.carry_out import begin
from legpush.bus import endpoints
from legpush.bus.endpoints import Endpoints
from legpush.bus.secure.host_folder import read_credentials
from legpush.errors import EndpointError


def test_processes_started_alone_find_each_other() -> None:
    agent, sim, planner = (endpoints.local(role) for role in ("agent", "sim", "planner"))
    assert set(agent.connect) == {*sim.listen, *planner.listen}
    assert len({*agent.listen, *sim.listen, *planner.listen}) == 3
    assert all(locator.startswith(f"unixsock-stream/{endpoints.own_directory()}/") for locator in agent.connect)


def test_the_directory_of_a_user_is_made_so_that_nobody_else_can_enter_it(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(endpoints, "own_directory", lambda: tmp_path / "own")
    for _ in range(2):
        endpoints.prepare(endpoints.local("agent"))
    assert (tmp_path / "own").stat().st_mode & 0o777 == 0o700


def test_other_endpoints_need_no_directory_of_the_user(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(endpoints, "own_directory", lambda: tmp_path / "own")
    endpoints.prepare(Endpoints(listen=("tcp/127.0.0.1:17472",), connect=(f"unixsock-stream/{tmp_path}/sim.sock",)))
    assert not (tmp_path / "own").exists()


def test_a_directory_that_another_user_made_or_can_enter_is_refused(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(endpoints, "own_directory", lambda: tmp_path / "own")
    mine = endpoints.local("recorder")
    (tmp_path / "own").mkdir()
    (tmp_path / "own").chmod(0o770)
    with pytest.raises(EndpointError, match="mode 0700 for the sockets, got 0770"):
        endpoints.prepare(mine)
    (tmp_path / "own").chmod(0o700)
    monkeypatch.setattr(os, "getuid", lambda: (tmp_path / "own").stat().st_uid + 1)
    with pytest.raises(EndpointError, match="to be a directory of this user, got one of user"):
        endpoints.prepare(mine)
    (tmp_path / "own").rmdir()
    (tmp_path / "own").symlink_to(tmp_path)
    with pytest.raises(EndpointError, match="to be a directory of this user"):
        endpoints.prepare(mine)


def test_processes_in_one_directory_find_each_other(tmp_path: Path) -> None:
    tmp_path.chmod(0o700)
    agent, sim, launcher = (endpoints.in_directory(tmp_path, role) for role in ("agent", "sim", "launcher"))
    assert sim.listen[0] in agent.connect
    assert {*agent.listen, *sim.listen} < set(launcher.connect)
    assert launcher.listen == ()


def test_a_directory_that_others_may_enter_is_refused(tmp_path: Path) -> None:
    tmp_path.chmod(0o755)
    with pytest.raises(EndpointError, match=r"mode 0700 .* got 0755"):
        endpoints.in_directory(tmp_path, "sim")


def test_a_socket_path_that_the_system_cannot_hold_is_refused(tmp_path: Path) -> None:
    deep = tmp_path / ("x" * 110)
    deep.mkdir(mode=0o700)
    with pytest.raises(EndpointError, match=r"at most 107 bytes, got .* shorter path"):
        endpoints.in_directory(deep, "sim")


@pytest.mark.parametrize(
    "address", ["127.0.0.1", "127.0.0.1:", "127.0.0.1:99999", "[::1]:65536", "h:80x", ":80", "h:-1"]
)
def test_a_port_that_is_none_is_refused_before_anything_waits_for_it(address: str) -> None:
    for protocol in ("tcp", "tls"):
        locator, said = (
            (f"{protocol}/{address}",),
            f"Expected a host and a port from 0 to 65535, such as {protocol}/127",
        )
        with pytest.raises(EndpointError, match=said):
            Endpoints(listen=locator)
        with pytest.raises(EndpointError, match=said):
            Endpoints(connect=locator)


@pytest.mark.parametrize(
    "address", ["127.0.0.1:0", "[::]:65535", "host.name:07447", "10.0.0.1:1#iface=eth0", "h:1?a=b"]
)
def test_a_host_with_a_port_is_an_endpoint(address: str) -> None:
    assert Endpoints(listen=(f"tcp/{address}",)).listen == (f"tcp/{address}",)


@pytest.mark.parametrize("locator", ["", "tcp", "tcp/", "127.0.0.1:17472", "udp/127.0.0.1:17472"])
def test_an_endpoint_that_is_none_is_refused_with_an_example(locator: str) -> None:
    with pytest.raises(EndpointError, match=r"such as tcp/127\.0\.0\.1:17472"):
        Endpoints(listen=(locator,))


@pytest.fixture
def host(tmp_path: Path) -> Path:
    """The folder of a host with certificates."""
    begin(tmp_path / "lab", ["robot"], 90, 90)
    return tmp_path / "lab" / "robot"


def test_with_credentials_processes_started_alone_find_each_other_at_tls_ports(host: Path) -> None:
    at = {role: endpoints.local(role, read_credentials(host, role)) for role in endpoints.CONNECTS_TO}
    assert {role: at[role].listen for role in endpoints.LISTENING} == {
        "planner": ("tls/127.0.0.1:17471",),
        "sim": ("tls/127.0.0.1:17472",),
        "agent": ("tls/127.0.0.1:17473",),
    }
    assert set(at["agent"].connect) == {*at["planner"].listen, *at["sim"].listen}
    for watcher in ("launcher", "recorder"):
        assert at[watcher].listen == ()
        assert len(at[watcher].connect) == 3


def test_tls_needs_credentials_and_nothing_else_goes_with_them(host: Path) -> None:
    tls, credentials = "tls/127.0.0.1:17472", read_credentials(host, "sim")
    assert Endpoints(listen=(tls,), credentials=credentials).credentials == credentials
    with pytest.raises(EndpointError, match=r"Expected --secure DIR with tls/127\.0\.0\.1:17472, got no certificate"):
        Endpoints(connect=(tls,))
    for other in ("tcp/127.0.0.1:17472", "unixsock-stream//tmp/x.sock"):
        with pytest.raises(EndpointError, match=r"Expected endpoints such as tls/.* with --secure, got '"):
            Endpoints(listen=(other,), credentials=credentials)


def test_free_ports_are_different_and_nobody_listens_there() -> None:
    ports = endpoints.free_ports(endpoints.LISTENING)
    assert list(ports) == list(endpoints.LISTENING)
    assert len(set(ports.values())) == 3
    for port in ports.values():
        with socket.create_server(("127.0.0.1", port)):
            pass
