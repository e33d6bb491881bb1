"""`legpush router`: Zenoh's router, and which certificates are linked with it."""

import logging
import sys
from contextlib import ExitStack, closing

from legpush.bus.endpoints import Endpoints, listing, of_router
from legpush.bus.links.configuration import configuration_text
from legpush.bus.secure.host_folder import credentials_of
from legpush.bus.session import ZenohSession, log_refused_links
from legpush.options.run import RouterOptions
from legpush.service import start_log, stop_on_signals

log = logging.getLogger(__name__)


def run_router(options: RouterOptions) -> int:
    """Route until a signal comes, or print the configuration; returns the exit code.

    Raises:
        EndpointError: It cannot listen there.
        CredentialsError: Its certificate cannot be used, or another router refuses it.
    """
    credentials = credentials_of(options.secure, "router")
    at = Endpoints(
        listen=options.listen or (of_router(credentials),),
        connect=options.connect,
        credentials=credentials,
        mode="router",
    )
    if options.print_config:
        sys.stdout.write(configuration_text(at))
        return 0
    stop = stop_on_signals()
    start_log("router", "warning" if options.output.quiet else options.log_level)
    with ExitStack() as stack:
        if credentials is not None:
            from legpush.bus.secure.link_watch import SHOWN, LinkWatch

            log_refused_links()
        session = stack.enter_context(closing(ZenohSession(at, "router")))
        log.info("routing, listening on %s, connecting to %s", listing(at.listen), listing(at.connect))
        if credentials is not None:
            log.info("taking part as %s", credentials.name)
            stack.enter_context(LinkWatch(credentials, at.connect, session.linked, lambda: SHOWN))
        stop.wait()
    log.info("done")
    return 0
