"""Recordings as the page reads them."""

from pathlib import Path

from legpush.history.run_history import RunHistory
from legpush.messages.stepping import Reset
from legpush.messages.telemetry import Copy, Fact
from legpush.runs.folder import SCENARIO_FILE
from legpush.scenarios.file import dump_scenario
from sim_proc.view.sources import RecordedSource
from tests.legpush.recording.recordings import write
from tests.sim.conftest import MOTIONS


def read(path: Path) -> RunHistory:
    history = RunHistory()
    with RecordedSource([path]) as run:
        while run.is_reading:
            run.pump(history, 0.02)
    return history


def test_a_recording_that_began_late_has_the_scenario_of_its_files(
    tmp_path: Path, messages: tuple[list[Copy], list[Copy]]
) -> None:
    reset = MOTIONS[0]
    assert isinstance(reset, Reset)
    late = messages[0][1:], messages[1][1:]
    scenario = Fact(name=SCENARIO_FILE, media_type="application/toml", data=dump_scenario(reset.scenario).encode())

    write(tmp_path / "without.mcap", *late)
    write(tmp_path / "with.mcap", *late, facts=(scenario,))

    assert read(tmp_path / "without.mcap").episodes == {}
    (timeline,) = read(tmp_path / "with.mcap").episodes.values()
    assert timeline.scenario == reset.scenario
    assert [step.number for step in timeline.steps] == [1, 2]
