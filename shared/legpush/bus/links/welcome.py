"""Asks the other side, with a handshake, whether it takes this process: Zenoh is silent where it does not."""

from legpush.bus.endpoints import Endpoints


def require_welcome(endpoints: Endpoints) -> None:
    """Check that what listens already takes the certificate of this process, if it has one.

    Raises:
        CredentialsError: It does not; says why, and under which name.
    """
    if endpoints.credentials is not None:
        from legpush.bus.secure.probe import require_accepted

        require_accepted(endpoints.connect, endpoints.credentials)
