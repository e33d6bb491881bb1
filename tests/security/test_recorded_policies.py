"""A recording names the policy that made it, and never runs code by that."""

import os
import shutil
import subprocess
from pathlib import Path
from typing import Final

import pytest

from tests.security.evil import IMPORTED, RAN, forged, marks, write_model, write_module, write_plug_in
from tests.system.missions import LEGPUSH, LIMIT_S, crc_of

KINDS: Final = ("module", "module without a hash", "model", "plug-in")
COMMANDS: Final = ("branch", "replay --as planner", "replay --as sim", "resume")


def policy_of(kind: str, folder: Path) -> tuple[str, str]:
    """Name and right SHA-256 of a policy that is code, whose files lie in `folder` and `folder/site`."""
    if kind == "model":
        return str(folder / "evil.zip"), write_model(folder / "evil.zip")
    if kind == "plug-in":
        return "foreign", write_plug_in(folder / "site", "foreign")
    sha256 = write_module(folder, "evil")
    return "evil:go", "" if kind.endswith("hash") else sha256


def legpush(folder: Path, *words: str) -> subprocess.CompletedProcess[str]:
    """Run the command in that working directory, with what is in `site` installed."""
    path = os.pathsep.join(filter(None, (str(folder / "site"), os.environ.get("PYTHONPATH", ""))))
    environment = {**os.environ, "PYTHONPATH": path}
    return subprocess.run(
        [*LEGPUSH, *words], cwd=folder, env=environment, capture_output=True, text=True, check=False, timeout=LIMIT_S
    )


def words_of(command: str, recording: Path) -> tuple[str, ...]:
    if command.startswith("replay"):
        return (*command.split(), str(recording), "--out", "again")
    return ("branch", str(recording), "--at", "0:3", "--out", "again", "--record", "again.mcap")


@pytest.mark.parametrize("command", COMMANDS)
@pytest.mark.parametrize("kind", KINDS)
def test_code_that_a_recording_names_does_not_run(
    scripted_mission: Path, tmp_path: Path, kind: str, command: str
) -> None:
    name, sha256 = policy_of(kind, tmp_path)
    recording = forged(scripted_mission / "mission.mcap", tmp_path / "evil.mcap", name, sha256)
    if command == "resume":
        shutil.copytree(scripted_mission / "run", tmp_path / "again")
        (tmp_path / "again" / "report.json").unlink()

    done = legpush(tmp_path, *words_of(command, recording))

    assert done.returncode == 2, done.stdout + done.stderr
    assert f"made with the policy {name}, which runs code: repeat it with --policy {name} if you trust" in done.stderr
    assert marks(tmp_path) == set()


@pytest.mark.parametrize("command", COMMANDS[:3])
def test_code_that_is_repeated_runs_and_the_mission_is_the_same(
    scripted_mission: Path, tmp_path: Path, command: str
) -> None:
    name, sha256 = policy_of("module", tmp_path)
    recording = forged(scripted_mission / "mission.mcap", tmp_path / "good.mcap", name, sha256)

    done = legpush(tmp_path, *words_of(command, recording), "--policy", name)

    assert done.returncode == 0, done.stdout + done.stderr
    assert marks(tmp_path) == {IMPORTED, RAN}
    assert crc_of(tmp_path / "again") == crc_of(scripted_mission / "run")


@pytest.mark.parametrize("kind", ["module without a hash", "plug-in"])
def test_code_without_a_hash_and_plug_ins_can_be_repeated_as_well(
    scripted_mission: Path, tmp_path: Path, kind: str
) -> None:
    name, sha256 = policy_of(kind, tmp_path)
    recording = forged(scripted_mission / "mission.mcap", tmp_path / "good.mcap", name, sha256)

    done = legpush(tmp_path, *words_of("branch", recording), "--past-policy", name, "--policy", "scripted")

    assert done.returncode == 0, done.stdout + done.stderr
    assert marks(tmp_path) == {IMPORTED, RAN}


def test_a_model_file_also_needs_trust(scripted_mission: Path, tmp_path: Path) -> None:
    name, sha256 = policy_of("model", tmp_path)
    recording = forged(scripted_mission / "mission.mcap", tmp_path / "evil.mcap", name, sha256)

    repeated = (*words_of("branch", recording), "--policy", name)
    done = legpush(tmp_path, *repeated)
    assert done.returncode == 2, done.stdout + done.stderr
    assert "expected --trust-policy-file" in done.stderr
    assert marks(tmp_path) == set()

    done = legpush(tmp_path, *repeated, "--trust-policy-file")
    assert done.returncode == 2, done.stdout + done.stderr
    assert "expected a model saved by Stable-Baselines3" in done.stderr
    assert marks(tmp_path) == {RAN}


@pytest.mark.parametrize("command", COMMANDS[:3])
def test_repeated_code_that_has_changed_does_not_run(scripted_mission: Path, tmp_path: Path, command: str) -> None:
    name, _ = policy_of("module", tmp_path)
    recording = forged(scripted_mission / "mission.mcap", tmp_path / "good.mcap", name, "0" * 64)

    done = legpush(tmp_path, *words_of(command, recording), "--policy", name)

    assert done.returncode == 2, done.stdout + done.stderr
    assert "Expected the policy evil:go of the recording, SHA-256 0000000000000000" in done.stderr
    assert marks(tmp_path) == set()


def test_another_policy_is_no_leave_for_the_recorded_one(scripted_mission: Path, tmp_path: Path) -> None:
    name, sha256 = policy_of("module", tmp_path)
    recording = forged(scripted_mission / "mission.mcap", tmp_path / "evil.mcap", name, sha256)

    done = legpush(tmp_path, *words_of("branch", recording), "--policy", "scripted")
    assert done.returncode == 2, done.stdout + done.stderr
    assert f"repeat it with --past-policy {name} if you trust it" in done.stderr
    done = legpush(tmp_path, *words_of("replay --as sim", recording), "--policy", "scripted")
    assert done.returncode == 2, done.stdout + done.stderr
    assert marks(tmp_path) == set()


def test_a_policy_folder_needs_the_recorded_hash(scripted_mission: Path, tmp_path: Path) -> None:
    recording = forged(scripted_mission / "mission.mcap", tmp_path / "odd.mcap", "variable", "0" * 64)

    done = legpush(tmp_path, *words_of("replay --as sim", recording))

    assert done.returncode == 2, done.stdout + done.stderr
    assert "Expected the policy variable of the recording, SHA-256 0000000000000000" in done.stderr


def test_info_shows_the_policy_and_whether_it_runs_code(scripted_mission: Path, tmp_path: Path) -> None:
    name, sha256 = policy_of("module", tmp_path)
    recording = forged(scripted_mission / "mission.mcap", tmp_path / "evil.mcap", name, sha256)

    assert "it runs code" not in legpush(tmp_path, "info", str(scripted_mission / "mission.mcap")).stdout
    shown = legpush(tmp_path, "info", str(recording)).stdout
    assert f"policy        evil:go, SHA-256 {sha256[:16]}..." in shown
    assert "it runs code" in shown
    assert marks(tmp_path) == set()
