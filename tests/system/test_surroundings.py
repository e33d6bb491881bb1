"""A mission and its commands do not depend on the user's surroundings: variables, streams, the temporary directory."""

import os
import subprocess
from pathlib import Path

import pytest

from tests.system.conftest import RecordedMission
from tests.system.missions import LEGPUSH, LIMIT_S, crc_of, report_of

RC_FILE = "text.usetex: True\nfont.size: 30\n"
NO_UTF8 = {"LC_ALL": "C", "PYTHONUTF8": "0", "PYTHONCOERCECLOCALE": "0"}
HOSTILE = {
    "MUJOCO_GL": "nonsense",
    "PYOPENGL_PLATFORM": "x11",
    "MPLBACKEND": "module://nonsense",
    "PYTHONIOENCODING": "ascii",
}


def in_shell(line: str, *words: str, cwd: Path, **environment: str) -> subprocess.CompletedProcess[str]:
    """Run a line of a shell in which "$@" is the command."""
    return subprocess.run(
        ["bash", "-c", line, "bash", *LEGPUSH, *words],
        cwd=cwd,
        env={**os.environ, **environment},
        capture_output=True,
        text=True,
        errors="replace",
        check=False,
        timeout=LIMIT_S,
    )


@pytest.mark.parametrize("line", ['"$@" >/dev/full', '{ "$@"; echo $? >code; } | true; exit $(cat code)'])
def test_a_mission_is_the_same_in_hostile_surroundings(
    line: str, push_mission: RecordedMission, tmp_path: Path
) -> None:
    temporary = tmp_path / ("it's a " + 25 * "long" + " name")
    for folder in (tmp_path / "config", temporary):
        folder.mkdir(exist_ok=True, parents=True)
    (tmp_path / "matplotlibrc").write_text(RC_FILE)
    (tmp_path / "config" / "matplotlibrc").write_text(RC_FILE)
    surroundings = {**HOSTILE, **NO_UTF8, "MPLCONFIGDIR": str(tmp_path / "config"), "TMPDIR": str(temporary)}

    done = in_shell(line, "run", "push", "--no-video", "--out", "run", cwd=tmp_path, **surroundings)

    assert (done.returncode, done.stdout, done.stderr) == (0, "", "")
    assert crc_of(tmp_path / "run") == crc_of(push_mission.out)
    assert report_of(tmp_path / "run")["notes"] == []
    assert (tmp_path / "run" / "mission.png").read_bytes() == (push_mission.out / "mission.png").read_bytes()


COMMANDS = {
    "evaluate": ("evaluate", "scripted", "--episodes", "1", "--out", "evaluation"),
    "export": ("export", "{file}", "--to", "csv", "--out", "table.csv"),
    "verify": ("replay", "{file}", "--verify"),
    "canary": ("canary",),
    "map": ("map", "push"),
}


@pytest.mark.parametrize("words", COMMANDS.values(), ids=COMMANDS)
def test_a_command_does_its_work_in_hostile_surroundings(
    words: tuple[str, ...], push_mission: RecordedMission, tmp_path: Path
) -> None:
    (tmp_path / "matplotlibrc").write_text(RC_FILE)
    filled = [word.format(file=push_mission.file) for word in words]
    done = in_shell('"$@"', *filled, cwd=tmp_path, **HOSTILE, **NO_UTF8)
    assert done.returncode == 0, done.stderr
