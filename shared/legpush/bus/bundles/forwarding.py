"""A session that hands on everything, and one that several buses of a process share."""

from legpush.bus.channels import Quality
from legpush.bus.transport import OnBytes, OnDamaged, OnToken, Sender, Session, Undeclare, ignore


class ForwardingSession:
    """A `legpush.bus.transport.Session` that hands on everything to another one."""

    def __init__(self, session: Session) -> None:
        self._session = session

    def close(self) -> None:
        """Close all links."""
        self._session.close()

    def linked(self) -> tuple[str, ...]:
        """Return the names in the certificates of all processes at the other ends of the links, if they have any."""
        return tuple(self._session.linked())

    def publisher(self, key: str, quality: Quality) -> Sender:
        """Sends bytes under `key`."""
        return self._session.publisher(key, quality)

    def put(self, key: str, payload: bytes) -> None:
        """Publish bytes once."""
        self._session.put(key, payload)

    def subscribe(self, key: str, on_bytes: OnBytes, on_damaged: OnDamaged = ignore) -> Undeclare:
        """Call `on_bytes` for everything that other processes publish under `key`."""
        return self._session.subscribe(key, on_bytes, on_damaged)

    def show_token(self, key: str) -> Undeclare:
        """Show a liveliness token."""
        return self._session.show_token(key)

    def watch_tokens(self, key: str, on_token: OnToken) -> Undeclare:
        """Call `on_token` for each token that lives now, and whenever one comes or goes."""
        return self._session.watch_tokens(key, on_token)


class SharedSession(ForwardingSession):
    """A session that several buses share: each of them takes back what it declared, and leaves it open.

    None of them sees the tokens of the others: they are this process itself, and tell nothing of the network.
    """

    def __init__(self, session: Session, own: set[str]) -> None:
        """`own` is the same set for all who share the session: it gets the tokens that they show."""
        super().__init__(session)
        self._own = own

    def close(self) -> None:
        """Leave it open for the others."""

    def show_token(self, key: str) -> Undeclare:
        """Show a liveliness token."""
        self._own.add(key)
        return super().show_token(key)

    def watch_tokens(self, key: str, on_token: OnToken) -> Undeclare:
        """Call `on_token` for each token of other processes that lives now, and whenever one comes or goes."""

        def tell_of_others(token: str, alive: bool) -> None:
            if token not in self._own:
                on_token(token, alive)

        return super().watch_tokens(key, tell_of_others)
