"""Clients with access to a bus that mean harm: a raw Zenoh session that listens to everything, and the attacks."""

import json
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager
from time import monotonic
from typing import Any, Final

import msgpack
import zenoh

from legpush.bounds import MAX_COUNT
from legpush.bus import keys
from legpush.messages import codec
from legpush.messages.common import PROTOCOL_VERSION, Role
from tests.legpush.examples import RESET
from tests.legpush.fakes import eventually

EVIL: Final = "evil"
"""Incarnation of the client."""
PUSH: Final = {"kind": "push", "w1": 0.1, "w2": 0.9, "leg": "FR", "depth_m": 0.2}
FLOOD_S: Final = 2.0


class Hostile:
    """A client that knows what is said in a run, and who is there."""

    def __init__(self, session: zenoh.Session, run: str) -> None:
        self.run = run
        self._session = session
        self._live: dict[str, str] = {}
        self._heard: dict[str, Any] | None = None
        self._publishers: dict[str, zenoh.Publisher] = {}
        self._tokens: list[zenoh.LivelinessToken] = []
        everybody = keys.liveliness(run, "*", "*", "*")
        self._watching = [
            session.liveliness().declare_subscriber(everybody, self._see, history=True),
            session.declare_subscriber(keys.observation(run, "main"), self._hear, allowed_origin=zenoh.Locality.REMOTE),
        ]

    def incarnation(self, role: Role) -> str:
        """Of the process with this role and the name `main`."""
        prefix = f"{role}/main/"

        def found() -> list[str]:
            live = [key.removeprefix(prefix) for key in self._live if key.startswith(prefix)]
            return [incarnation for incarnation in live if not incarnation.startswith(EVIL)]

        assert eventually(lambda: len(found()) == 1), self._live
        return found()[0]

    def heard(self) -> dict[str, Any]:
        """The last observation that was heard."""
        assert eventually(lambda: self._heard is not None)
        assert self._heard is not None
        return self._heard

    def show(self, role: Role, name: str = "main", incarnation: str = EVIL) -> zenoh.LivelinessToken:
        """Show a liveliness token until the end."""
        token = self._session.liveliness().declare_token(keys.liveliness(self.run, role, name, incarnation))
        self._tokens.append(token)
        return token

    def header(self, role: Role, name: str = "main", incarnation: str = EVIL, sequence: int = 0) -> dict[str, Any]:
        """A header that claims to be of this process."""
        sender = {"role": role, "name": name, "incarnation": incarnation, "sequence": sequence}
        return {"protocol": PROTOCOL_VERSION, "run": self.run, **sender}

    def act(self, motion: Any, *, to_step: int = 1, to_episode: int = 0, key: str | None = None, **who: Any) -> None:
        """Send an action: by default the next step of the present episode."""
        done = self.heard()
        step = 0 if motion["kind"] == "reset" else done["step"] + to_step
        action = {"header": self.header("agent", **who), "step": step, "motion": motion}
        episode = min(done["episode"] + to_episode, MAX_COUNT)
        self.put(key or keys.action(self.run, "main"), {**action, "episode": episode})

    def put(self, key: str, message: dict[str, Any] | bytes) -> None:
        """Publish a message, or bytes, to somebody who listens."""
        if key not in self._publishers:
            publisher = self._session.declare_publisher(key, congestion_control=zenoh.CongestionControl.BLOCK)
            assert eventually(lambda: publisher.matching_status.matching)  # type: ignore[attr-defined]
            self._publishers[key] = publisher
        self._publishers[key].put(message if isinstance(message, bytes) else msgpack.packb(message))

    def _see(self, sample: zenoh.Sample) -> None:
        token = "/".join(str(sample.key_expr).split("/")[-3:])
        if sample.kind == zenoh.SampleKind.PUT:
            self._live[token] = token
        else:
            self._live.pop(token, None)

    def _hear(self, sample: zenoh.Sample) -> None:
        message = msgpack.unpackb(sample.payload.to_bytes())
        if message["kind"] == "observation":
            self._heard = message


@contextmanager
def hostile(connect: Sequence[str], run: str) -> Iterator[Hostile]:
    """A hostile client that is connected to these endpoints."""
    config = zenoh.Config()
    settings: dict[str, Any] = {
        "mode": "peer",
        "listen/endpoints": [],
        "connect/endpoints": list(connect),
        "connect/retry": {"period_init_ms": 20, "period_max_ms": 20},
        "connect/timeout_ms": -1,
        "connect/exit_on_failure": False,
        "scouting/multicast/enabled": False,
        "scouting/gossip/enabled": False,
        "open/return_conditions/connect_scouted": False,
    }
    for path, value in settings.items():
        config.insert_json5(path, json.dumps(value))
    with zenoh.open(config) as session:
        yield Hostile(session, run)


def reset(client: Hostile, to_episode: int) -> None:
    """Begin another episode, as an agent with a token of its own."""
    client.show("agent", "evil")
    client.act(msgpack.unpackb(codec.encode(RESET)), to_episode=to_episode, name="evil")


def next_reset(client: Hostile) -> None:
    """Begin the next episode."""
    reset(client, 1)


def last_reset(client: Hostile) -> None:
    """Begin the last episode that has a number."""
    reset(client, MAX_COUNT)


def count_too_high(client: Hostile) -> None:
    """Begin an episode beyond that."""
    action = {"header": client.header("agent", "evil"), "episode": 2**64 - 1, "step": 0}
    client.put(keys.action(client.run, "main"), {**action, "motion": msgpack.unpackb(codec.encode(RESET))})


def extra_push(client: Hostile) -> None:
    """Push as the next step of the mission's episode."""
    client.show("agent", "evil")
    client.act(PUSH, name="evil")


def extreme_motions(client: Hostile) -> None:
    """Motions whose numbers physics cannot carry."""
    client.show("agent", "evil")
    far = {"x_m": 1e308, "y_m": -1e308, "yaw_rad": 0.0}
    client.act({"kind": "follow", "waypoints": [far]}, name="evil")
    client.act({"kind": "alter", "box_mass_kg": 1e308, "box_friction": 1e308}, name="evil")


def second_sim(client: Hostile) -> None:
    """Another simulator of the same name."""
    client.show("sim")


def second_planner(client: Hostile) -> None:
    """Another planner of the same name, and one of another name."""
    client.show("planner")
    client.show("planner", "other", "evil-2")


def second_agent(client: Hostile) -> None:
    """Another agent of the same name, which steps, plans, and takes plans back."""
    client.show("agent")
    client.act(PUSH)
    client.put(keys.plan_cancel(client.run, "main"), {"header": client.header("agent"), "request_id": MAX_COUNT})


def stale_incarnation(client: Hostile) -> None:
    """An agent that is gone."""
    client.act(PUSH, incarnation="stale0000000")


def other_name(client: Hostile) -> None:
    """The incarnation of the agent, with another name."""
    client.act(PUSH, name="evil", incarnation=client.incarnation("agent"), sequence=MAX_COUNT)


def old_sequence(client: Hostile) -> None:
    """The agent itself, by its header; but the number of the message was used before.

    If the agent is quicker, the step is done already, and this push is another motion for it.
    """
    client.act(PUSH, incarnation=client.incarnation("agent"), sequence=0)


def wildcard_key(client: Hostile) -> None:
    """An action for every simulator."""
    client.show("agent", "evil")
    client.act(PUSH, key=keys.action(client.run, "*"), name="evil")


def duplicate_keys(client: Hostile) -> None:
    """A map with the same key twice."""
    done = client.heard()
    fields = {"header": client.header("agent"), "episode": done["episode"], "step": 777, "motion": PUSH}
    pairs = [*fields.items(), ("step", done["step"] + 1)]
    packed = b"".join(msgpack.packb(part) for pair in pairs for part in pair)
    client.put(keys.action(client.run, "main"), bytes([0x80 + len(pairs)]) + packed)


def repeated_sequence(client: Hostile) -> None:
    """The answer to the next step under the simulator's incarnation, with a number that was used before."""
    answer = client.heard()
    outcome = {**answer["outcome"], "state_crc": 0xDEADBEEF}
    client.put(keys.observation(client.run, "main"), {**answer, "step": answer["step"] + 1, "outcome": outcome})


def tokens_of_other_roles(client: Hostile) -> None:
    """A token with the agent's incarnation and another role comes and goes."""
    token: Any = client.show("launcher", "evil", client.incarnation("agent"))
    token.undeclare()


def junk(client: Hostile) -> None:
    """Rubbish on every key, as fast as it goes."""
    targets = (keys.action(client.run, "main"), keys.observation(client.run, "main"))
    until = monotonic() + FLOOD_S
    while monotonic() < until:
        for key in targets:
            client.put(key, b"\xc1" * 100)
        client.put(targets[0], {"header": client.header("agent"), "episode": 1})


ATTACKS: Final[dict[Callable[[Hostile], None], dict[str, set[str]]]] = {
    next_reset: {"sim": {"conflict", "no_token"}},
    last_reset: {"sim": {"conflict", "no_token"}},
    count_too_high: {"sim": {"malformed"}},
    extra_push: {"sim": {"conflict", "no_token"}},
    extreme_motions: {"sim": {"conflict", "no_token", "malformed"}},
    second_sim: {},
    second_planner: {},
    second_agent: {"sim": {"conflict", "no_token"}},
    stale_incarnation: {"sim": {"no_token"}},
    other_name: {"sim": {"no_token"}},
    old_sequence: {"sim": {"repeated", "conflict"}},
    wildcard_key: {"sim": {"sender"}},
    duplicate_keys: {"sim": {"malformed"}},
    repeated_sequence: {"agent": {"repeated"}},
    tokens_of_other_roles: {},
    junk: {"sim": {"malformed"}, "agent": {"malformed"}},
}
"""Each attack, and for which of these causes its messages are counted, where it sends some."""
