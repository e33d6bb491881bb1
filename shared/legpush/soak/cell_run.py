"""Runs one cell of the table: a mission, its fault, and what came of it."""

import shutil
import tempfile
from collections.abc import Iterator
from contextlib import ExitStack, contextmanager, suppress
from pathlib import Path
from time import monotonic
from typing import Final

from msgspec import Struct

from legpush.errors import DISK_FULL, PeerError
from legpush.files import write_whole
from legpush.history.journal import read_entries
from legpush.soak.check import differences, recorded_wrongs, report_of, steps_of
from legpush.soak.inject import injector
from legpush.soak.mission import JOURNAL, RECORDING, running
from legpush.soak.table import Cell
from legpush.soak.timing import KillWatch, Times

MAX_TRIES: Final = 3
"""How often a mission is run again that was over before the fault, or was in another phase by then."""


class CellResult(Struct, frozen=True, kw_only=True):
    """What came of a cell."""

    name: str
    seed: int
    expected: str
    survived: bool
    """Whether the mission ended with success, after the same command once more if that is expected."""
    same: bool
    """Whether journal, recordings and report are those of the undisturbed mission."""
    state_crc: str | None
    exit_codes: tuple[int, ...]
    took_s: float
    wrong: tuple[str, ...]
    times: Times | None = None
    """Of a kill."""

    @property
    def is_as_expected(self) -> bool:
        """Whether everything is as the table wants it."""
        return self.survived and self.same and not self.wrong


def undisturbed(folder: Path, seed: int) -> Path:
    """Run the mission without a fault, and return its folder.

    Raises:
        PeerError: It does not succeed.
    """
    out = folder / "undisturbed" / "run"
    if not report_of(out):
        shutil.rmtree(out.parent, ignore_errors=True)
        out.parent.mkdir(parents=True)
        with running(out, seed=seed) as mission:
            code = mission.end()
            if code != 0:
                raise PeerError(f"The undisturbed mission ended with {code}:\n{mission.said()}")
    return out


def run_cell(cell: Cell, folder: Path, expected: Path, seed: int) -> CellResult:
    """Run a cell in a new folder, which is removed again if everything is as expected."""
    began_s = monotonic()
    for _ in range(MAX_TRIES):
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        codes, times, hit, said = _disturbed(cell, folder / "run", seed)
        if hit or codes[-1] != 0:
            break
    wrong = [] if hit else ["the mission was in another phase when the fault came, or the fault met nothing"]
    out = folder / "run"
    if cell.expected == "goes_on":
        if not _is_one_error(codes[0], said):
            wrong.append(f"expected exit code {DISK_FULL} and one error, got {codes[0]}: {said}")
        with running(out, seed=seed) as again:
            codes = (*codes, again.end())
            said += again.said()
    survived = codes[-1] == 0
    found = differences(out, expected)
    wrong += found
    recordings = sorted(folder.glob(f"*{RECORDING}"))
    if survived and not found:
        wrong += recorded_wrongs(recordings, steps_of(list(read_entries(out / JOURNAL))))
    if not survived:
        wrong.append(f"the mission ended with {codes[-1]}: {said[-600:]}")
    result = CellResult(
        name=cell.name,
        seed=seed,
        expected=cell.expected,
        survived=survived,
        same=not found,
        state_crc=report_of(out).get("state_crc"),
        exit_codes=codes,
        took_s=round(monotonic() - began_s, 2),
        wrong=tuple(wrong),
        times=times,
    )
    if result.is_as_expected:
        shutil.rmtree(folder)
    else:
        write_whole(folder / "said.log", said.encode(), private=True)
    return result


def _disturbed(cell: Cell, out: Path, seed: int) -> tuple[tuple[int, ...], Times | None, bool, str]:
    """Run the mission with its fault: its exit code, times, whether the fault came in its phase, what was said."""
    times: Times | None = None
    hit = False
    with short_folder() as place, injector(cell, place, seed) as fault:
        with running(out, seed=seed, faults=fault.folder) as mission, ExitStack() as stack:
            with suppress(PeerError):  # the mission ended before; its exit code says how
                mission.wait_for("planning")
                victim = mission.process(cell.role)
                watch = stack.enter_context(KillWatch(mission, cell.role)) if cell.kind == "kill" else None
                mission.wait_for(cell.phase)
                if watch is None:
                    hit = mission.journal.phase() == cell.phase
                    fault.strike(mission, victim)
                    hit = hit and fault.has_harmed
                else:
                    killed_s = watch.kill(victim)
                    hit = mission.journal.phase() == cell.phase
                    times = watch.times(killed_s, victim)
            code = mission.end()
        return (code,), times, hit, mission.said()


def _is_one_error(code: int, said: str) -> bool:
    """Whether a mission ended as on a full disk: one error, and the command that goes on."""
    errors = [line for line in said.splitlines() if line.startswith("error: ")]
    return code == DISK_FULL and len(errors) == 1 and "to go on: legpush run" in " ".join(said.split())


@contextmanager
def short_folder() -> Iterator[Path]:
    """A folder of mode 0700 whose path is short enough for sockets."""
    with tempfile.TemporaryDirectory(prefix="soak-") as folder:
        yield Path(folder)
