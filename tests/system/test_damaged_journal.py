"""Every kind of damage to a journal leads on to the same state, or says from which step on it cannot be read."""

import struct
from collections.abc import Callable
from pathlib import Path

import pytest

from legpush.errors import JournalError
from legpush.history.journal import Journal, Reading
from legpush.history.mending import step_back
from legpush.lockstep.episode import Episode
from tests.legpush.examples import QUERY
from tests.legpush.fakes import agent, crc_after, mission, opened, planner, sim

MISSION = mission(4)
CRC = crc_after(MISSION)
N_BEFORE = 6
"""Number of steps before the journal was damaged."""


def go_on(directory: Path, path: Path, n_steps: int = len(MISSION)) -> int:
    """Run the mission, or the rest of it; the last state."""
    with agent(directory) as asking, Journal(path, opened()) as journal:
        episode = Episode(journal, asking.sim, asking.planner)
        episode.plan(QUERY)
        return [episode.step(motion).state_crc for motion in MISSION[:n_steps]][-1]


def ends(data: bytes) -> list[int]:
    """Where each entry ends."""
    found, at = [], 16
    while at < len(data):
        at += 12 + struct.unpack_from(">I", data, at)[0]
        found.append(at)
    return found


def flipped(data: bytes, at: int) -> bytes:
    return data[:at] + bytes([data[at] ^ 4]) + data[at + 1 :]


def without(data: bytes, begin: int, end: int) -> bytes:
    return data[:begin] + data[end:]


Damage = Callable[[bytes, list[int]], bytes]

LEADS_ON: dict[str, Damage] = {
    "intact": lambda data, at: data,
    "cut in the last entry": lambda data, at: data[: (at[-2] + at[-1]) // 2],
    "cut before the last entry": lambda data, at: data[: at[-2]],
    "cut in a head": lambda data, at: data[: at[-2] + 5],
    "cut in the middle": lambda data, at: data[: len(data) // 2],
    "junk behind the end": lambda data, at: data + b"junk",
    "more junk behind the end": lambda data, at: data + bytes(range(1, 200)),
    "zeros behind the end": lambda data, at: data + bytes(4096),
    "a torn block of zeros": lambda data, at: data[: at[-3] + 20] + bytes(len(data) - at[-3] - 20),
    "a bit in the last entry": lambda data, at: flipped(data, at[-1] - 20),
    "a bit in the last head": lambda data, at: flipped(data, at[-2] + 3),
    "a bit in the last CRC": lambda data, at: flipped(data, at[-1] - 1),
}
SAYS_WHERE: dict[str, tuple[Damage, str]] = {
    "a bit in an entry in the middle": (lambda data, at: flipped(data, at[8] + 12), "from step 2 on"),
    "a bit in a head in the middle": (lambda data, at: flipped(data, at[8] + 1), "from step 2 on"),
    "zeros in the middle": (lambda data, at: data[: at[8]] + bytes(at[10] - at[8]) + data[at[10] :], "from step 2 on"),
    "an entry twice": (lambda data, at: data[: at[9]] + data[at[8] : at[9]] + data[at[9] :], "from step 3 on"),
    "an entry missing": (lambda data, at: without(data, at[8], at[9]), "from step 2 on"),
}


@pytest.fixture(scope="module")
def before(tmp_path_factory: pytest.TempPathFactory) -> bytes:
    """The journal of an interrupted mission: 3 entries, then 2 for each step."""
    directory = tmp_path_factory.mktemp("j")
    with sim(directory), planner(directory):
        go_on(directory, directory / "j", N_BEFORE)
    return (directory / "j").read_bytes()


@pytest.mark.parametrize("kind", LEADS_ON)
def test_a_journal_that_is_damaged_at_its_end_leads_on_to_the_same_state(
    before: bytes, tmp_path: Path, kind: str, caplog: pytest.LogCaptureFixture
) -> None:
    path = tmp_path / "run" / "j"
    path.parent.mkdir()
    damaged = LEADS_ON[kind](before, ends(before))
    path.write_bytes(damaged)
    is_cut = kind not in ("intact", "cut before the last entry")
    with sim(tmp_path), planner(tmp_path):
        assert go_on(tmp_path, path) == CRC
    said = [each for each in caplog.messages if "cut off; it goes on from step" in each]
    assert len(said) == is_cut
    kept = [each.read_bytes() for each in path.parent.iterdir() if each != path]
    assert kept == [damaged] * is_cut


@pytest.mark.parametrize("kind", SAYS_WHERE)
def test_a_journal_that_is_damaged_in_the_middle_says_from_which_step_and_goes_on_from_there_when_told(
    before: bytes, tmp_path: Path, kind: str
) -> None:
    path = tmp_path / "run" / "j"
    path.parent.mkdir()
    damage, words = SAYS_WHERE[kind]
    damaged = damage(before, ends(before))
    path.write_bytes(damaged)
    with pytest.raises(JournalError, match=f"{words}; `legpush recover {path.parent}` goes back"):
        Journal(path, opened())
    assert path.read_bytes() == damaged
    first, done = step_back(path)
    assert first == opened()
    assert f"goes on {words.removesuffix(' on')}" in done
    assert (path.parent / "j.damaged").read_bytes() == damaged
    with sim(tmp_path), planner(tmp_path):
        assert go_on(tmp_path, path) == CRC


def test_a_bit_anywhere_never_leads_to_another_state(before: bytes, tmp_path: Path) -> None:
    path = tmp_path / "j"
    n_cut = 0
    said: list[str] = []
    for at in range(0, len(before), 61):
        path.write_bytes(flipped(before, at))
        try:
            with Journal(path, opened()), path.open("rb") as file:
                list(Reading(path, file.fileno()).ordered())
                assert before.startswith(path.read_bytes())
                n_cut += 1
        except JournalError as error:
            said.append(str(error))
        (tmp_path / "j.damaged").unlink(missing_ok=True)
    assert all("is damaged" in each or "is not an episode journal" in each for each in said)
    assert len(said) > n_cut > 0
