"""The key space: `legpush/v<protocol version>/<run>/...`, one key per message type and peer."""

import re
from typing import Final

from msgspec import Struct

from legpush.errors import MessageError
from legpush.fields import Name
from legpush.messages import codec
from legpush.messages.common import PROTOCOL_VERSION, Role

APPLICATION: Final = "legpush"
TOKEN_KEY: Final = re.compile(
    rf"{APPLICATION}/v(?P<protocol>\d{{1,9}})/[^/]+/live/(?P<role>[^/]+)/(?P<name>[^/]+)/(?P<incarnation>[^/]+)"
)

SIMULATOR_KEY: Final = re.compile(rf"{APPLICATION}/v\d{{1,9}}/[^/]+/sim/(?P<name>[^/*]+)/(action|observation)")
MEMBER: Final = re.compile(r"(?P<process>bundle[0-9a-f]{12})-\d{1,3}")


def prefix(run: str) -> str:
    """What every key of a run begins with."""
    return f"{APPLICATION}/v{PROTOCOL_VERSION}/{run}"


def plan_request(run: str, client: str) -> str:
    """Where `client` asks for plans; `*` for all clients."""
    return f"{prefix(run)}/plan/{client}/request"


def plan_cancel(run: str, client: str) -> str:
    """Where `client` takes a request back; `*` for all clients."""
    return f"{prefix(run)}/plan/{client}/cancel"


def plan_result(run: str, client: str) -> str:
    """Where the planner answers `client`."""
    return f"{prefix(run)}/plan/{client}/result"


def action(run: str, sim: str) -> str:
    """Where the simulator named `sim` gets its actions."""
    return f"{prefix(run)}/sim/{sim}/action"


def observation(run: str, sim: str) -> str:
    """Where the simulator named `sim` answers with observations and refusals."""
    return f"{prefix(run)}/sim/{sim}/observation"


def simulator_of(key: str) -> str | None:
    """Name of the simulator that a key of actions or answers names; None for any other key."""
    match = SIMULATOR_KEY.fullmatch(key)
    return None if match is None else match["name"]


def bundled_actions(run: str, process: str) -> str:
    """Where several simulators of one `process` get actions together; `*` for all processes."""
    return f"{prefix(run)}/bundle/{process}/action"


def bundled_answers(run: str, process: str) -> str:
    """Where several simulators of one `process` answer together; `*` for all processes."""
    return f"{prefix(run)}/bundle/{process}/observation"


def incarnation_of_member(process: str, number: int) -> str:
    """Incarnation of a simulator that shares a process with others: it tells an agent that they can be asked together.

    `process` is `bundle` and 12 hexadecimal digits.
    """
    return f"{process}-{number}"


def process_of(incarnation: str) -> str | None:
    """Process of a simulator that shares one; None if it does not."""
    match = MEMBER.fullmatch(incarnation)
    return None if match is None else match["process"]


def job_request(run: str, worker: str) -> str:
    """Where the worker named `worker` gets its jobs; `*` for all workers."""
    return f"{prefix(run)}/job/{worker}/request"


def job_result(run: str, worker: str) -> str:
    """Where the worker named `worker` answers; `*` for all workers."""
    return f"{prefix(run)}/job/{worker}/result"


def reward(run: str, sim: str) -> str:
    """Where an agent says what the steps of the simulator named `sim` earned."""
    return f"{prefix(run)}/sim/{sim}/reward"


def status(run: str, role: Role | str, name: str) -> str:
    """Where a process tells people what it is doing."""
    return f"{prefix(run)}/tap/{role}/{name}/status"


def copies(run: str, role: Role | str, name: str) -> str:
    """Where a process hands copies of what it publishes to recorders."""
    return f"{prefix(run)}/tap/{role}/{name}/copies"


def taken(run: str, role: Role | str, name: str) -> str:
    """Where recorders tell a process which of its copies they have."""
    return f"{prefix(run)}/tap/{role}/{name}/taken"


def liveliness(run: str, role: Role | str, name: str, incarnation: str) -> str:
    """Liveliness token of one incarnation of a process; `*` for any."""
    return f"{prefix(run)}/live/{role}/{name}/{incarnation}"


def liveliness_of_any_version(run: str, role: Role | str, name: str, incarnation: str) -> str:
    """The same, whatever protocol the process speaks: one that cannot be talked to can still be named."""
    return f"{APPLICATION}/*/{run}/live/{role}/{name}/{incarnation}"


class Token(Struct, frozen=True, kw_only=True):
    """What a liveliness key says."""

    protocol: int
    role: Role
    name: Name
    incarnation: Name


def parse_token(key: str) -> Token:
    """Parse a liveliness key.

    Raises:
        MessageError: It names no process.
    """
    match = TOKEN_KEY.fullmatch(key)
    if match is None:
        words = f"{APPLICATION}/v<protocol>/<run>/live/<role>/<name>/<incarnation>"
        raise MessageError(f"expected {words}, got {key}")
    return codec.convert({**match.groupdict(), "protocol": int(match["protocol"])}, Token)
