"""The settings of Zenoh: nothing is discovered, nobody asks the admin space, and `zenohd` reads the same text."""

import json
from contextlib import ExitStack
from pathlib import Path
from typing import Any

import pytest
import zenoh

from legpush.bus.endpoints import Endpoints, Mode
from legpush.bus.links.configuration import configuration, configuration_text
from legpush.bus.secure.host_folder import read_credentials
from tests.legpush.fakes import eventually
from tests.ports import free_ports
from tests.security.hosts import HOST, made


@pytest.mark.parametrize("mode", ["peer", "client", "router"])
def test_nothing_is_discovered(mode: Mode) -> None:
    found = configuration(Endpoints(connect=("tcp/127.0.0.1:1",), mode=mode))
    assert found["scouting"] == {"multicast": {"enabled": False}, "gossip": {"enabled": False}}
    assert found["mode"] == mode
    assert "access_control" not in found


def test_a_client_tries_all_its_routers_and_others_try_for_ever() -> None:
    waits = {
        mode: configuration(Endpoints(mode=mode))["connect"]["timeout_ms"] for mode in ("peer", "client", "router")
    }
    assert waits == {"peer": -1, "client": 0, "router": -1}


@pytest.mark.parametrize("secure", [False, True])
def test_zenoh_takes_the_text_and_gives_nobody_its_admin_space_even_where_it_is_enabled(
    secure: bool, tmp_path: Path
) -> None:
    """As `zenohd` does: it enables the admin space whatever its file says."""
    host = made(tmp_path / "lab", routers=(HOST,)) if secure else None
    at = f"{'tls' if secure else 'tcp'}/127.0.0.1:{free_ports(1)[0]}"
    of: dict[str, Any] = {role: None if host is None else read_credentials(host, role) for role in ("router", "sim")}
    text = configuration_text(Endpoints(listen=(at,), credentials=of["router"], mode="router"))
    assert json.loads(text)["adminspace"]["permissions"] == {"read": False, "write": False}
    as_zenohd = zenoh.Config.from_json5(text)
    as_zenohd.insert_json5("adminspace/enabled", "true")
    with ExitStack() as stack:
        router = stack.enter_context(zenoh.open(as_zenohd))
        client = Endpoints(connect=(at,), credentials=of["sim"], mode="client")
        session = stack.enter_context(zenoh.open(zenoh.Config.from_json5(configuration_text(client))))
        assert eventually(lambda: bool(session.info.links()))
        own = str(session.info.zid())
        found = [str(reply.ok.key_expr) for reply in session.get("@/**", timeout=1.0) if reply.ok is not None]
        assert [key for key in found if own not in key] == []
        assert len(router.info.links()) == 1
