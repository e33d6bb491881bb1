"""The agent on a real bus, with a simulator and a planner without physics."""

import json
import subprocess
import sys
import threading
from collections.abc import Callable
from errno import ENOSPC
from math import inf
from pathlib import Path

import pytest
from msgspec.structs import replace

from agent_proc.mission.process import AgentConfig, work, writable_folder
from agent_proc.reporting.mission_picture import picture
from legpush.errors import ConfigError, JournalError, LegpushError, MotionError, StopRequestedError
from legpush.messages.planning import Plan, PlanQuery, TrunkPathQuery
from legpush.messages.stepping import Motion, Outcome, Push
from legpush.runs.reasons import REASONS, Reason
from legpush.scenarios.file import dump_scenario
from tests.agent.fake_world import KinematicSimulator, make_scenario, straight_plan
from tests.legpush.fakes import bus, planner, sim


@pytest.fixture
def scenario_file(tmp_path: Path) -> Path:
    """A scenario of the fake world."""
    path = tmp_path / "fake.toml"
    path.write_text(dump_scenario(make_scenario()), encoding="utf-8")
    return path


@pytest.fixture
def sockets(tmp_path: Path) -> Path:
    """A directory for sockets."""
    path = tmp_path / "s"
    path.mkdir(mode=0o700)
    return path


def config(scenario_file: Path, out: Path, seed: int = 0) -> AgentConfig:
    return AgentConfig(scenario=str(scenario_file), out=out, seed=seed)


def run_agent(sockets: Path, options: AgentConfig, stop: threading.Event | None = None) -> int:
    with bus(sockets, "agent") as opened:
        return work(options, opened, stop or threading.Event())


def report(out: Path) -> dict[str, object]:
    return dict(json.loads((out / "report.json").read_text(encoding="utf-8")))


def test_a_mission_leaves_journal_report_and_picture(sockets: Path, scenario_file: Path, tmp_path: Path) -> None:
    out = tmp_path / "deep" / "out"
    with sim(sockets, KinematicSimulator()), planner(sockets, straight_plan):
        code = run_agent(sockets, config(scenario_file, out, seed=4))

    assert code == 0
    assert sorted(path.name for path in out.iterdir()) == ["episode-0000.journal", "mission.png", "report.json"]
    written = report(out)
    assert (written["success"], written["seed"]) == (True, 4)
    assert isinstance(written["wall_time_s"], float)
    assert written["wall_time_s"] > 0.0


def test_a_picture_that_fails_costs_neither_report_nor_result(
    sockets: Path, scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise RuntimeError("no font\nat all")

    monkeypatch.setattr(picture, "save_picture", fail)
    with sim(sockets, KinematicSimulator()), planner(sockets, straight_plan):
        code = run_agent(sockets, config(scenario_file, tmp_path / "out"))

    assert code == 0
    assert report(tmp_path / "out")["success"]
    assert report(tmp_path / "out")["notes"] == ["no mission.png: RuntimeError: no font at all"]


def test_a_disk_too_full_for_the_picture_is_a_full_disk(
    sockets: Path, scenario_file: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def fail(*_: object) -> None:
        raise OSError(ENOSPC, "No space left on device")

    monkeypatch.setattr(picture, "save_picture", fail)
    with (
        sim(sockets, KinematicSimulator()),
        planner(sockets, straight_plan),
        pytest.raises(OSError, match="No space left"),
    ):
        run_agent(sockets, config(scenario_file, tmp_path / "out"))

    assert report(tmp_path / "out")["success"]


def test_a_mission_without_success_ends_with_1(sockets: Path, scenario_file: Path, tmp_path: Path) -> None:
    with sim(sockets, KinematicSimulator()), planner(sockets, lambda _: Plan(status="failed", reason="nothing found")):
        code = run_agent(sockets, config(scenario_file, tmp_path / "out"))

    assert code == 1
    assert report(tmp_path / "out")["reason"] == "no_path"


def refuse_pushes(motion: Motion) -> None:
    """Refuse what a simulator may refuse."""
    if isinstance(motion, Push):
        raise MotionError("too far away")


def break_at_pushes(motion: Motion) -> None:
    """Fail as a simulator may fail."""
    if isinstance(motion, Push):
        raise ZeroDivisionError("float division by zero")


def keep_the_box(query: PlanQuery) -> Plan:
    """Plans that do not move the box, which is not at its goal."""
    plan = straight_plan(query)
    return plan if isinstance(query, TrunkPathQuery) else replace(plan, waypoints=(query.start,) * 50)


class Refusing(KinematicSimulator):
    """Raises an exception in some motions."""

    def __init__(self, refuse: Callable[[Motion], None]) -> None:
        super().__init__()
        self._refuse = refuse

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        self._refuse(motion)
        return super().perform(motion, with_trace=with_trace)


@pytest.mark.parametrize(
    ("simulator", "plan", "reason", "words"),
    [
        (Refusing(refuse_pushes), straight_plan, "motion_refused", "too far away"),
        (Refusing(break_at_pushes), straight_plan, "episode_broken", "float division by zero"),
        (KinematicSimulator(), keep_the_box, "bad_answer", "the path of the box: .*the box does not move"),
    ],
)
def test_an_error_that_a_second_try_meets_again_ends_the_mission_with_a_report_and_exit_code_2(
    simulator: KinematicSimulator,
    plan: Callable[[PlanQuery], Plan],
    reason: Reason,
    words: str,
    sockets: Path,
    scenario_file: Path,
    tmp_path: Path,
) -> None:
    with (
        sim(sockets, simulator),
        planner(sockets, plan),
        pytest.raises(LegpushError, match=words) as raised,
    ):
        run_agent(sockets, config(scenario_file, tmp_path / "out"))

    assert raised.value.exit_code == 2, "the launcher does not start it again"
    written = report(tmp_path / "out")
    assert (written["success"], written["reason"], written["detail"]) == (False, reason, str(raised.value))
    assert written["remedy"] == REASONS[reason].remedy


class Interrupting(KinematicSimulator):
    """Asks the agent to stop in its n-th step, and does not answer that before the agent has."""

    def __init__(self, at_step: int) -> None:
        super().__init__()
        self.stop, self.stopped = threading.Event(), threading.Event()
        self._left = at_step

    def perform(self, motion: Motion, *, with_trace: bool) -> Outcome:
        self._left -= 1
        if self._left == 0:
            self.stop.set()
            self.stopped.wait(20.0)
        return super().perform(motion, with_trace=with_trace)


@pytest.mark.parametrize("at_step", [1, 6, 20])
def test_an_interrupted_mission_goes_on_from_its_journal_to_the_same_state(
    at_step: int, sockets: Path, scenario_file: Path, tmp_path: Path
) -> None:
    with planner(sockets, straight_plan):
        with sim(sockets, KinematicSimulator()):
            run_agent(sockets, config(scenario_file, tmp_path / "whole"))
        stopping = Interrupting(at_step)
        with sim(sockets, stopping):
            with pytest.raises(StopRequestedError):
                run_agent(sockets, config(scenario_file, tmp_path / "parts"), stopping.stop)
            stopping.stopped.set()
        assert not (tmp_path / "parts" / "report.json").exists()
        with sim(sockets, KinematicSimulator()):
            code = run_agent(sockets, config(scenario_file, tmp_path / "parts"))

    assert code == 0
    whole, parts = report(tmp_path / "whole"), report(tmp_path / "parts")
    assert whole["state_crc"] == parts["state_crc"]
    assert whole["n_push_cycles"] == parts["n_push_cycles"]


def test_a_mission_that_is_over_gets_its_report_again_without_a_peer(
    sockets: Path, scenario_file: Path, tmp_path: Path
) -> None:
    options = config(scenario_file, tmp_path / "out")
    with sim(sockets, KinematicSimulator()), planner(sockets, straight_plan):
        run_agent(sockets, options)
    before = report(tmp_path / "out")
    (tmp_path / "out" / "report.json").unlink()

    assert run_agent(sockets, options) == 0
    assert report(tmp_path / "out") == before


def test_the_journal_of_another_seed_or_scenario_is_refused(sockets: Path, scenario_file: Path, tmp_path: Path) -> None:
    with sim(sockets, KinematicSimulator()), planner(sockets, straight_plan):
        run_agent(sockets, config(scenario_file, tmp_path / "out"))

    with pytest.raises(JournalError, match="expected a journal of seed 1, got one of 0"):
        run_agent(sockets, config(scenario_file, tmp_path / "out", seed=1))
    scenario_file.write_text(dump_scenario(make_scenario((1.0, 3.0, 0.0))), encoding="utf-8")
    with pytest.raises(JournalError, match="the journal is of another mission"):
        run_agent(sockets, config(scenario_file, tmp_path / "out"))


@pytest.mark.parametrize(
    ("options", "message"),
    [
        ({"seed": -1}, "Expected a seed from 0 to 4294967295 for --seed, got -1"),
        ({"seed": 2**32}, "Expected a seed from 0 to 4294967295"),
        ({"deadline_s": 0.0}, "Expected 0.001 to 1e\\+06 seconds for --deadline"),
        ({"deadline_s": inf}, "Expected 0.001 to 1e\\+06 seconds for --deadline"),
        ({"sim": "a/b"}, "for --sim, got 'a/b'"),
        ({"name": ""}, "for --name"),
    ],
)
def test_a_wrong_option_is_named(options: dict[str, object], message: str) -> None:
    with pytest.raises(ConfigError, match=message):
        AgentConfig(**options)  # type: ignore[arg-type]


def test_a_folder_that_cannot_be_made_is_named(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("", encoding="utf-8")

    with pytest.raises(ConfigError, match=r"Expected a folder that can be made for --out, got .*file/out"):
        writable_folder(tmp_path / "file" / "out", private=True)


def test_the_scripted_policy_needs_neither_torch_nor_the_libraries_of_the_other_processes() -> None:
    code = (
        "import sys, agent_proc.mission.process as s; s.make_policy('scripted'); "
        "import agent_proc.reporting.mission_picture.picture; "
        "print([m for m in ('torch', 'stable_baselines3', 'gymnasium', 'mujoco', 'ompl', 'scipy') if m in sys.modules])"
    )

    done = subprocess.run([sys.executable, "-c", code], capture_output=True, text=True, check=True)

    assert done.stdout == "[]\n"
