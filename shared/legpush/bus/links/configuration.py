"""The settings of Zenoh for a process or a router, as plain data: what a session gets, and what a `zenohd` reads."""

import json
from typing import Any, Final

from legpush.bus.endpoints import Endpoints
from legpush.bus.liveliness import LEASE_S
from legpush.bus.secure.access_rules import access_control
from legpush.bus.secure.host_folder import Credentials

RETRY: Final = {"period_init_ms": 50, "period_max_ms": 500, "period_increase_factor": 1.5}


def configuration(endpoints: Endpoints) -> dict[str, Any]:
    """Return the settings of a session.

    A client of routers tries each of its endpoints once: to try again and again would be to try the first one alone,
    and to block the process meanwhile.
    """
    transport: dict[str, Any] = {
        "shared_memory": {"enabled": False},
        "link": {"tx": {"lease": round(1e3 * LEASE_S)}},
    }
    settings: dict[str, Any] = {
        "mode": endpoints.mode,
        "listen": {"endpoints": list(endpoints.listen), "timeout_ms": 0, "exit_on_failure": True},
        "connect": {
            "endpoints": list(endpoints.connect),
            "timeout_ms": 0 if endpoints.mode == "client" else -1,
            "exit_on_failure": False,
            "retry": RETRY,
        },
        "scouting": {"multicast": {"enabled": False}, "gossip": {"enabled": False}},
        "open": {"return_conditions": {"connect_scouted": False}},
        "transport": transport,
        # `zenohd` enables the admin space whatever is said here; then nobody may read or write it.
        "adminspace": {"enabled": False, "permissions": {"read": False, "write": False}},
    }
    if endpoints.credentials is not None:
        transport["link"]["tls"] = _tls(endpoints.credentials)
        settings["access_control"] = access_control(endpoints.credentials.names, endpoints.credentials.role)
    return settings


def configuration_text(endpoints: Endpoints) -> str:
    """Return the settings as the text of a file for `zenohd --config`."""
    return json.dumps(configuration(endpoints), indent=2) + "\n"


def _tls(credentials: Credentials) -> dict[str, Any]:
    """Return settings for TLS with certificates on both sides."""
    certificate, key = str(credentials.certificate), str(credentials.key)
    return {
        "root_ca_certificate": str(credentials.authority),
        "enable_mtls": True,
        "listen_certificate": certificate,
        "listen_private_key": key,
        "connect_certificate": certificate,
        "connect_private_key": key,
        "verify_name_on_connect": True,
        "close_link_on_expiration": True,
    }
