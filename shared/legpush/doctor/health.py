"""`legpush health`: whether a process is up, by what others see of it on the bus."""

import sys
import threading
from contextlib import closing
from typing import Final

from legpush.bus import endpoints, keys
from legpush.bus.endpoints import Endpoints, by_router, listing
from legpush.bus.secure.access_rules import VIEWS
from legpush.bus.secure.host_folder import Credentials, credentials_of
from legpush.bus.session import ZenohSession
from legpush.errors import ConfigError, StopRequestedError
from legpush.options.shell import HealthOptions
from legpush.output.reply import document

EVERY_INCARNATION: Final = "*"


def tell_health(options: HealthOptions) -> int:
    """Say whether the process is up; return 0 if it is, else 1.

    Raises:
        ConfigError: Nobody can be asked about a process of this role.
        EndpointError: An endpoint has another form, or TLS is missing on one side.
        CredentialsError: The certificate cannot be used, or is refused.
    """
    credentials = credentials_of(options.secure, options.role)
    at = asked(options, credentials)
    is_up = _answers(at, options.wait_s) if options.role == "router" else _is_seen(at, options)
    who = options.role if options.role in ("router", "viewer") else f"{options.role} {options.name}"
    sys.stdout.write(f"{who} is {'up' if is_up else 'not up'}, asked at {listing(at.connect)}\n")
    document({"role": options.role, "name": options.name, "run": options.run, "up": is_up, "asked_at": at.connect})
    return 0 if is_up else 1


def asked(options: HealthOptions, credentials: Credentials | None) -> Endpoints:
    """Return where the process, or a router that it is linked with, is asked.

    Raises:
        ConfigError: It listens nowhere by itself, and no endpoint is given.
    """
    if options.role == "router":
        return by_router(options.connect or options.router or (endpoints.of_router(credentials),), credentials)
    if options.router:
        return by_router(options.router, credentials)
    if options.connect:
        return Endpoints(connect=options.connect, credentials=credentials)
    for role in endpoints.LISTENING:
        if role == options.role:
            return Endpoints(connect=endpoints.local(role, credentials).listen, credentials=credentials)
    raise ConfigError(f"Expected --router or --connect for a {options.role}, which has no usual endpoint, got neither")


def _answers(at: Endpoints, wait_s: float) -> bool:
    """Whether a router opens a session within this time."""
    stop = threading.Event()
    timer = threading.Timer(wait_s, stop.set)
    timer.start()
    try:
        ZenohSession(at, "health", stop).close()
    except StopRequestedError:
        return False
    finally:
        timer.cancel()
    return True


def _is_seen(at: Endpoints, options: HealthOptions) -> bool:
    """Whether the liveliness token of the process is seen within this time."""
    seen, stop = threading.Event(), threading.Event()
    timer = threading.Timer(options.wait_s, stop.set)
    timer.start()
    try:
        with closing(ZenohSession(at, "health", stop)) as session:
            session.watch_tokens(_token(options), lambda _, lives: seen.set() if lives else None)
            while not seen.wait(0.02) and not stop.is_set():
                pass
    except StopRequestedError:
        return False
    finally:
        timer.cancel()
    return seen.is_set()


def _token(options: HealthOptions) -> str:
    """Return the tokens of the process; views are recorders that give themselves names."""
    role, name = ("recorder", VIEWS) if options.role == "viewer" else (options.role, options.name)
    return keys.liveliness(options.run, role, name, EVERY_INCARNATION)
