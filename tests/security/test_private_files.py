"""Files that can hold a secret of their user can be read by that user alone, and folders that legpush names, too."""

import os
import stat
from collections.abc import Callable, Iterator
from pathlib import Path
from subprocess import run

import pytest

from agent_proc.learning.plan_file import write_plan
from agent_proc.learning.training_plan import TrainingPlan
from agent_proc.mission.process import writable_folder
from agent_proc.task.file import load_task
from legpush.files import make_folder, new_file, write_whole
from legpush.history.entries import Opened
from legpush.history.journal import Journal
from legpush.history.mending import mend
from legpush.messages.common import PROTOCOL_VERSION
from legpush.processes.child import Command
from legpush.processes.crew import Crew
from legpush.recording.recover import recover
from legpush.runs.folder import run_folder
from legpush.runs.report import write_report
from legpush.scenarios.file import load_scenario
from legpush.study.folder import FailedCell
from tests.agent.learning.small_training import small_profile
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import a_recording
from tests.legpush.study.parts import begun, study_of
from tests.system.missions import LEGPUSH, LIMIT_S

OPENED = Opened(protocol=PROTOCOL_VERSION, run="run", seed=0, versions={}, began_unix_s=0.0)


def mode(path: Path) -> int:
    return stat.S_IMODE(path.stat().st_mode)


@pytest.fixture(autouse=True)
def open_umask() -> Iterator[None]:
    """The umask of a user who shares everything, so that a mode is what the code asked for."""
    before = os.umask(0)
    yield
    os.umask(before)


def log(folder: Path) -> Path:
    path = folder / "planner.log"
    with Crew() as crew:
        crew.start(Command(role="planner", argv=("true",), log=path, environment=dict(os.environ)))
        crew.next_event(10.0)
    return path


def report(folder: Path) -> Path:
    write_report({"command": "legpush run"}, folder)
    return folder / "report.json"


def journal(folder: Path) -> Path:
    with Journal(folder / "episode-0000.journal", OPENED) as begun_now:
        return begun_now.path


def original_of_a_mended_journal(folder: Path) -> Path:
    path = journal(folder)
    path.write_bytes(path.read_bytes() + b"\0\0\0\7")
    mend(path)
    return folder / "episode-0000.journal.damaged"


def recording(folder: Path) -> Path:
    return a_recording(folder / "a.mcap", mission(4))


def recovered_recording(folder: Path) -> Path:
    path = recording(folder)
    path.write_bytes(path.read_bytes()[:-100])
    recover(path, folder / "b.mcap")
    return folder / "b.mcap"


def plan_of_a_training(folder: Path) -> Path:
    task = load_task("tuned")
    plan = TrainingPlan(profile=small_profile(), task=task, seed=1, n_simulators=1, command="legpush", versions={})
    write_plan(folder, plan)
    return folder / "config.json"


def record_of_a_study(folder: Path) -> Path:
    return begun(folder / "study", study_of()).path / "study.json"


def failure_of_a_cell(folder: Path) -> Path:
    study = begun(folder / "study", study_of())
    study.keep_failure(FailedCell(cell="a", inputs={}, own=True, error="KeyError", traceback="TOKEN=1"))
    return study.failed / "a.json"


KINDS: tuple[Callable[[Path], Path], ...] = (
    log,
    report,
    journal,
    original_of_a_mended_journal,
    recording,
    recovered_recording,
    plan_of_a_training,
    record_of_a_study,
    failure_of_a_cell,
)


@pytest.mark.parametrize("make", KINDS, ids=lambda make: make.__name__)
def test_what_can_hold_a_secret_is_readable_by_its_user_alone(make: Callable[[Path], Path], tmp_path: Path) -> None:
    assert oct(mode(make(tmp_path))) == "0o600"


def test_files_are_private_only_if_asked_for_and_a_shared_one_becomes_private_when_written_again(
    tmp_path: Path,
) -> None:
    write_whole(tmp_path / "a", b"")
    with new_file(tmp_path / "b") as scratch:
        scratch.touch()
    assert [oct(mode(tmp_path / name)) for name in "ab"] == ["0o666"] * 2
    write_whole(tmp_path / "a", b"", private=True)
    (tmp_path / "c.part").touch()
    write_whole(tmp_path / "c", b"", private=True)
    assert [oct(mode(tmp_path / name)) for name in "ac"] == ["0o600"] * 2


@pytest.mark.parametrize(("private", "expected"), [(True, "0o700"), (False, "0o777")])
def test_a_folder_is_private_unless_the_user_chose_it_and_its_logs_in_any_case(
    tmp_path: Path, private: bool, expected: str
) -> None:
    folder = tmp_path / "runs" / "a"
    with run_folder(folder, load_scenario("push"), private=private):
        assert (oct(mode(folder)), oct(mode(folder / "logs"))) == (expected, "0o700")
    assert oct(mode(writable_folder(tmp_path / "runs" / "b", private=private))) == expected
    assert oct(mode(tmp_path / "runs")) == "0o777"


def test_a_folder_that_is_there_keeps_its_mode(tmp_path: Path) -> None:
    tmp_path.chmod(0o750)
    make_folder(tmp_path, private=True)
    assert oct(mode(tmp_path)) == "0o750"


def test_an_evaluation_in_a_folder_of_its_own_is_private(tmp_path: Path) -> None:
    words = ("evaluate", "scripted", "--world", "map", "--simulators", "1", "--episodes", "1")
    run([*LEGPUSH, *words], check=True, timeout=LIMIT_S, cwd=tmp_path, capture_output=True)
    (folder,) = (tmp_path / "runs").iterdir()
    private = {folder: 0o700, folder / "logs": 0o700, folder / "summary.json": 0o600}
    private[folder / "logs" / "command.txt"] = 0o600
    assert {path: mode(path) for path in private} == private


def test_a_mission_and_its_recording_leave_no_private_file_open(scripted_mission: Path) -> None:
    out = scripted_mission / "run"
    secret = [*out.glob("*.journal"), *(out / "logs").iterdir(), out / "report.json", scripted_mission / "mission.mcap"]
    assert {f"{path.name} {oct(mode(path))}" for path in secret} == {f"{path.name} 0o600" for path in secret}
    assert {"planner.log", "sim.log", "agent.log", "recorder.log", "command.txt"} <= {path.name for path in secret}
    assert oct(mode(out / "logs")) == "0o700"
