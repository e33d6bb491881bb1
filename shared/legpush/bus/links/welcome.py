"""Asks the other side, with a handshake, whether it takes this process: Zenoh is silent where it does not."""

from legpush.bus.endpoints import Endpoints


def require_welcome(endpoints: Endpoints) -> tuple[str, ...]:
    """Check that what listens already takes the certificate of this process, if it has one.

    Of the routers of a client one has to. Returns what took a connection and did not answer.

    Raises:
        CredentialsError: It does not; says why, and under which name.
    """
    if endpoints.credentials is None:
        return ()
    from legpush.bus.secure.probe import require_accepted

    return require_accepted(endpoints.connect, endpoints.credentials, one_is_enough=endpoints.mode == "client")
