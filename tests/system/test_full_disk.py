"""Missions on a disk that becomes full: exit code 5, the command that goes on, and with more space the same end."""

import json
import re
import shlex
import shutil
import subprocess
from pathlib import Path

import pytest

from tests.system.missions import LEGPUSH, LIMIT_S, crc_of, do_mission, once

DISK = "mount -t tmpfs -o size={size}k none {disk}"
NAMESPACE = ("unshare", "--user", "--map-root-user", "--mount")
"""A process with mounts of its own, which need no rights and end with it."""

PAGE_BYTES = 4096
N_LOGS = 4
"""Files in the folder of logs, of a page each."""


def pages_of(n_bytes: int) -> int:
    """Number of pages that a file takes."""
    return -(-n_bytes // PAGE_BYTES)


@pytest.fixture(scope="module", autouse=True)
def _own_mounts(tmp_path_factory: pytest.TempPathFactory) -> None:
    disk = tmp_path_factory.mktemp("disk")
    if shutil.which("unshare") is None:
        pytest.skip("needs the program unshare")
    done = subprocess.run([*NAMESPACE, "sh", "-c", DISK.format(size=64, disk=disk)], capture_output=True, check=False)
    if done.returncode != 0:
        pytest.skip(f"needs mounts of its own: {done.stderr.decode().strip()}")


@pytest.fixture(scope="module")
def whole(tmp_path_factory: pytest.TempPathFactory, worker_id: str) -> Path:
    """The folder of a mission that ended."""
    own = tmp_path_factory.getbasetemp()

    def make(folder: Path) -> None:
        do_mission(folder / "run", "push", "--policy", "scripted")

    return once((own if worker_id == "master" else own.parent) / "full-disk-mission", make) / "run"


def run_twice(tmp_path: Path, size_kib: int, begun: Path | None = None) -> str:
    """Run a mission on a disk of this size, which is full before its end, then again with more space; its CRC."""
    disk, kept = tmp_path / "disk", tmp_path / "kept"
    disk.mkdir()
    command = shlex.join([*LEGPUSH, "run", "push", "--policy", "scripted", "--no-video"])
    script = [
        DISK.format(size=size_kib, disk=disk),
        f"cp -r {begun} {disk}/run" if begun else ":",
        f"{{ {command} --out {disk}/run > {tmp_path}/said 2>&1; test $? -eq 5; }}",
        f"mount -o remount,size=20m {disk}",
        f"{command} --out {disk}/run",
        f"cp -r {disk}/run {kept}",
    ]
    done = subprocess.run(
        [*NAMESPACE, "sh", "-c", " && ".join(script)], capture_output=True, text=True, check=False, timeout=2 * LIMIT_S
    )
    said = (tmp_path / "said").read_text() if (tmp_path / "said").exists() else ""
    assert done.returncode == 0, said + done.stdout + done.stderr
    assert re.search(r"^error: .*(No space left on device|disk quota)", said, re.MULTILINE | re.IGNORECASE), said
    words = " ".join(said.split())
    assert f"after space is made, to go on: legpush run {disk}/run/scenario.toml --seed 0" in words
    return crc_of(kept)


@pytest.mark.parametrize("size_kib", [4, 12, 60], ids=["the command", "logs", "the journal"])
def test_a_mission_on_a_full_disk_goes_on_with_more_space(tmp_path: Path, whole: Path, size_kib: int) -> None:
    assert run_twice(tmp_path, size_kib) == crc_of(whole)


@pytest.mark.parametrize("with_picture", [False, True])
def test_no_space_for_the_picture_or_the_report_is_a_full_disk(tmp_path: Path, whole: Path, with_picture: bool) -> None:
    begun = tmp_path / "begun"
    shutil.copytree(whole, begun)
    (begun / "report.json").unlink()
    picture = (begun / "mission.png").read_bytes()
    (begun / "mission.png").unlink()
    shutil.rmtree(begun / "logs")
    n_pages = N_LOGS + sum(pages_of(path.stat().st_size) for path in begun.iterdir() if path.is_file())
    n_pages += pages_of(len(picture)) if with_picture else 1

    assert run_twice(tmp_path, 4 * n_pages, begun) == crc_of(whole)
    assert json.loads((tmp_path / "kept" / "report.json").read_text())["success"]
