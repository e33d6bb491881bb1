"""What makes a process of a mission faulty from within: its links, its messages, its clock or its disk.

It is called before the process begins, by the entry hook in the folder `hook`, and changes what the process uses, not
the process. A file `on` in the folder of the cell switches the fault on.
"""

import fcntl
import json
import os
import sys
import threading
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from itertools import cycle
from pathlib import Path
from typing import Any, Final, cast
from zlib import crc32

from legpush.soak.table import FaultRole, Kind

CELL_FILE: Final = "cell.json"
SWITCH: Final = "on"
HARMED: Final = "harmed"
"""A file that is made when a message was dropped, duplicated or reordered."""
SOCKETS: Final = "unixsock-stream/"
JUMP_S: Final = 3600.0
LOOK_S: Final = 0.005
MESSAGE_FAULTS: Final = ("drop", "duplicate", "reorder")
LINK_FAULTS: Final = ("cut", "stall", "delay", "slow_consumer", "corrupt")
PROBABILITY: Final = 0.5
"""Of a fault, for each message while it is switched on."""


def prepare(folder: Path, argv: list[str], words: Sequence[str]) -> None:
    """Make this process faulty if it has the role of the cell; `words` is its whole command line, `argv` its flags."""
    role = _role(words)
    if role is None:
        return
    cell = json.loads((folder / CELL_FILE).read_bytes())
    kind: Kind = cell["kind"]
    if kind in LINK_FAULTS and role == "agent":
        lead_through_proxies(folder, argv)
    elif role != cell["role"]:
        return
    elif kind in MESSAGE_FAULTS:
        spoil_messages(kind, folder / SWITCH)
    elif kind == "clock_back":
        move_clock(-JUMP_S, folder / SWITCH)
    elif kind == "clock_ahead":
        move_clock(JUMP_S, folder / SWITCH)
    elif kind == "disk_full":
        threading.Thread(target=fill_disk, args=(folder / SWITCH,), name="full disk", daemon=True).start()


def _role(words: Sequence[str]) -> FaultRole | None:
    """The role of a process by its command line."""
    start = words.index("-m") + 1 if "-m" in words else len(words)
    for word in words[start : start + 2]:  # the module itself, or one that starts it
        if word in ("planner_proc", "sim_proc", "agent_proc"):
            return cast(FaultRole, word.removesuffix("_proc"))
    return None


def proxy_path(folder: Path, role: FaultRole) -> Path:
    """Socket of the proxy before a planner or simulator."""
    return folder / f"{role}.proxy"


def target_path(folder: Path, role: FaultRole) -> Path:
    """A link to the socket of the planner or simulator itself."""
    return folder / f"{role}.target"


def lead_through_proxies(folder: Path, argv: list[str]) -> None:
    """Change the endpoints that an agent connects to, so that its links pass the proxies."""
    for role in ("planner", "sim"):
        for place, word in enumerate(argv):
            if word.startswith(SOCKETS) and word.endswith(f"/{role}.sock"):
                with suppress(FileExistsError):
                    target_path(folder, role).symlink_to(word.removeprefix(SOCKETS))
                argv[place] = f"{SOCKETS}{proxy_path(folder, role)}"


def spoil_messages(kind: Kind, switch: Path) -> None:
    """Drop, duplicate or reorder half of what this process publishes in the lockstep, while it is switched on."""
    from legpush.bus.faults import TABLE_ROWS, BadChannel, Fate, Faults, fate_table
    from legpush.bus.session import ZenohSession
    from legpush.bus.transport import Sender

    untouched = Fate(dropped=False, duplicated=False, delay_s=0.0, reordered=False)
    sound: Callable[..., Sender] = ZenohSession.publisher

    def publisher(session: ZenohSession, key: str, quality: Any) -> Sender:
        sender = sound(session, key, quality)
        if quality != "lockstep":
            return sender
        fates = fate_table(Faults(probability=PROBABILITY, seed=crc32(kind.encode())), key, TABLE_ROWS)
        table = [  # the first message always meets the fault: a planner sends few
            Fate(
                dropped=kind == "drop" and (fate.dropped or place == 0),
                duplicated=kind == "duplicate" and (fate.duplicated or place == 0),
                delay_s=0.0,
                reordered=kind == "reorder" and (fate.reordered or place == 0),
            )
            for place, fate in enumerate(fates)
        ]
        bad, rows = BadChannel(table, sender.send), cycle(fate != untouched for fate in table)

        def send(payload: bytes) -> None:
            if not switch.exists():
                sender.send(payload)
                return
            bad.send(payload)
            if next(rows):
                switch.with_name(HARMED).touch()

        return Sender(send, sender.undeclare)

    setattr(ZenohSession, "publisher", publisher)  # noqa: B010 - a type checker refuses the assignment


def move_clock(jump_s: float, switch: Path) -> None:
    """Let the clock on the wall jump when it is switched on; the monotonic clock goes on."""
    sound_s, sound_ns = time.time, time.time_ns

    def jumped_s() -> float:
        return sound_s() + (jump_s if switch.exists() else 0.0)

    def jumped_ns() -> int:
        return sound_ns() + (round(1e9 * jump_s) if switch.exists() else 0)

    time.time, time.time_ns = jumped_s, jumped_ns


def fill_disk(switch: Path) -> None:
    """When it is switched on, nothing more can be written to any file that is open then, neither journal nor log."""
    while not switch.exists():
        time.sleep(LOOK_S)
    full = os.open("/dev/full", os.O_WRONLY | os.O_CLOEXEC)
    # A full disk still syncs what it has, but this device cannot.
    setattr(os, "fdatasync", lambda file: None)  # noqa: B010 - a type checker refuses the assignment
    for number in os.listdir("/proc/self/fd"):
        with suppress(OSError):
            is_file = os.path.isfile(f"/proc/self/fd/{number}")
            writes = fcntl.fcntl(int(number), fcntl.F_GETFL) & os.O_ACCMODE != os.O_RDONLY
            if is_file and writes:
                os.dup2(full, int(number))


def main() -> None:
    """Prepare this process for the cell in the folder that the environment names."""
    folder = os.environ.get(ENVIRONMENT)
    if folder:
        prepare(Path(folder), sys.argv, sys.orig_argv)


ENVIRONMENT: Final = "LEGPUSH_SOAK_CELL"
"""Names the folder of the cell."""
