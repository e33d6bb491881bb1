"""`legpush export` with whatever it is given: one line for what is wrong, and no file that is not whole."""

import hashlib
import os
import resource
import signal
import subprocess
import time
from collections.abc import Callable
from pathlib import Path

import pytest
from pyarrow import parquet

from legpush.errors import ConfigError
from legpush.messages.common import PROTOCOL_VERSION
from legpush.options.formats import ENDINGS, Format
from sim_proc.export.columns import columns_of
from sim_proc.export.program import whole_file
from sim_proc.export.source import Source
from sim_proc.render.backends import working_backend
from tests.sim.export.foxglove_reading import read
from tests.sim.export.program import CLI, export


def files(folder: Path) -> dict[str, str]:
    """Digest by name."""
    return {path.name: hashlib.sha256(path.read_bytes()).hexdigest() for path in folder.iterdir()}


@pytest.mark.parametrize(
    ("arguments", "name"),
    [
        (["--to", "csv"], "mission.csv"),
        (["--to", "parquet", "--episode", "1"], "mission-episode-1.parquet"),
        (["--to", "foxglove"], "mission-foxglove.mcap"),
    ],
)
def test_the_new_file_is_beside_the_recording_and_named_after_it(
    recorded: Path, source: Source, arguments: list[str], name: str, tmp_path: Path
) -> None:
    mission = tmp_path / "mission.mcap"
    mission.write_bytes(recorded.read_bytes())
    before = files(tmp_path)
    done = export(mission, *arguments)
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith(f"wrote {tmp_path / name}: ")
    assert done.stderr == ""
    after = files(tmp_path)
    assert after.keys() == {"mission.mcap", name}
    assert after["mission.mcap"] == before["mission.mcap"]
    if name.endswith(".parquet"):
        assert parquet.read_table(tmp_path / name).num_rows == source.episodes[1].timeline.n_rows
    elif name.endswith(".mcap"):
        ticks = [message for message in read(tmp_path / name) if message.topic == "/tf"]
        assert len(ticks) == source.episodes[0].timeline.n_rows
    else:
        assert len((tmp_path / name).read_text().splitlines()) == 1 + len(columns_of(source.episodes)[0].values)


def cut(data: bytes) -> bytes:
    return data[: len(data) * 2 // 3]


def foreign(_: bytes) -> bytes:
    return b"\x89PNG\r\n\x1a\n" + bytes(100)


def empty(_: bytes) -> bytes:
    return b""


def other_version(data: bytes) -> bytes:
    """The length of the words stays; the MCAP reader looks at no CRC of them."""
    here, before = str(PROTOCOL_VERSION), "04"
    written, changed = (b"protocol" + len(here).to_bytes(4, "little") + text.encode() for text in (here, before))
    assert data.count(written) == 1
    return data.replace(written, changed)


@pytest.mark.parametrize(
    ("spoil", "words"),
    [
        (cut, "expected a whole recording, got one that is cut off or damaged at byte"),
        (foreign, "expected a recording, an MCAP file, got one that begins with"),
        (empty, "expected a recording, an MCAP file, got an empty file"),
        (other_version, "expected a recording of protocol version 6, 7, 8, 9 or 10, got one of 04"),
    ],
)
@pytest.mark.parametrize("made", ["foxglove", "csv", "mp4"])
def test_a_bad_recording_is_refused_in_one_line(
    recorded: Path, spoil: Callable[[bytes], bytes], words: str, made: str, tmp_path: Path
) -> None:
    (tmp_path / "bad.mcap").write_bytes(spoil(recorded.read_bytes()))
    before = files(tmp_path)
    done = export(tmp_path / "bad.mcap", "--to", made)
    assert done.returncode == 2
    assert words in done.stderr
    assert done.stderr.startswith(f"error: {tmp_path / 'bad.mcap'}: ")
    assert len(done.stderr.splitlines()) == 1
    assert files(tmp_path) == before


def test_a_foxglove_file_is_no_recording(recorded: Path, tmp_path: Path) -> None:
    assert export(recorded, "--out", tmp_path / "a.mcap").returncode == 0
    done = export(tmp_path / "a.mcap", "--to", "csv")
    assert done.returncode == 2
    assert "expected a recording of legpush, got an MCAP file of ''" in done.stderr
    assert len(done.stderr.splitlines()) == 1


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        ([], "Expected the file of a recording, got none"),
        (
            ["a.mcap"],
            "--to with one of foxglove, csv, parquet, mp4, gif, urdf, html, or --out with its ending, got neither",
        ),
        (["a.mcap", "--to", "avi"], "avi"),
        (
            ["a.mcap", "--out", "a.xlsx"],
            "or .mp4 or .gif or .urdf or .html for --out, got a.xlsx",
        ),
        (["a.mcap", "--to", "csv", "--out", "a.gif"], "ends in .csv for --out, got a.gif"),
        (["a.mcap", "--to", "csv", "--out", "no/a.csv"], "a new file in an existing folder for --out, got no/a.csv"),
        (["a.mcap", "--out", "there.csv"], "a new file in an existing folder for --out, got there.csv"),
        (["there.mcap", "--to", "csv"], "a new file in an existing folder for --out, got there.csv"),
        (["a.mcap", "--to", "csv"], "a.mcap: expected a recording that can be read (No such file or directory)"),
        (["a.mcap", "--to", "csv", "--camera", "top"], "Expected --camera only with mp4 and gif, got it with csv"),
        (["a.mcap", "--to", "mp4", "--camera", "left"], "left"),
        (["a.mcap", "--to", "mp4", "--speed", "0"], "Expected 0.001 to 1e+06 for --speed, got 0.0"),
        (["a.mcap", "--to", "mp4", "--fps", "nan"], "Expected 0.1 to 1000 for --fps, got nan"),
        (["a.mcap", "--to", "gif", "--fps", "60"], "Expected at most 50 for --fps of a GIF, got 60.0"),
        (["a.mcap", "--to", "mp4", "--width", "101"], "an even number of pixels from 16 to 3840 for --width, got 101"),
        (["a.mcap", "--to", "mp4", "--start", "3", "--end", "2"], "Expected more than --start, 3, for --end, got 2.0"),
        (["a.mcap", "--to", "csv", "--episode", "-1"], "for --episode, which `legpush info` lists, got -1"),
    ],
)
def test_bad_options_end_with_2_and_one_message(arguments: list[str], words: str, tmp_path: Path) -> None:
    (tmp_path / "there.csv").write_text("mine")
    before = files(tmp_path)
    done = export(*arguments, cwd=tmp_path)
    assert done.returncode == 2
    assert words in done.stderr
    assert "Traceback" not in done.stderr
    assert done.stdout == ""
    assert files(tmp_path) == before


@pytest.mark.parametrize("made", ["foxglove", "csv", "parquet"])
def test_where_the_disk_is_full_nothing_is_left_behind(recorded: Path, made: Format, tmp_path: Path) -> None:
    command = [*CLI, str(recorded), "--to", made, "--out", str(tmp_path / f"a{ENDINGS[made]}")]

    def full() -> None:
        resource.setrlimit(resource.RLIMIT_FSIZE, (50_000, 50_000))

    done = subprocess.run(command, capture_output=True, text=True, check=False, timeout=120, preexec_fn=full)
    assert done.returncode == 2
    assert f"a{ENDINGS[made]}: expected a new file that can be written" in done.stderr
    assert len(done.stderr.splitlines()) == 1
    assert list(tmp_path.iterdir()) == []


def test_a_file_that_came_meanwhile_is_kept(tmp_path: Path) -> None:
    target = tmp_path / "a.csv"

    def write() -> None:
        with whole_file(target) as scratch:
            scratch.write_text("new")
            target.write_text("old")

    with pytest.raises(ConfigError, match=r"a\.csv: expected a new file that can be written \(File exists\)"):
        write()
    assert files(tmp_path).keys() == {"a.csv"}
    assert target.read_text() == "old"


@pytest.mark.skipif(working_backend() is None, reason="no OpenGL library for off-screen rendering")
def test_an_interrupt_leaves_nothing_behind_and_ends_with_130(recorded: Path, tmp_path: Path) -> None:
    command = [*CLI, str(recorded), "--out", str(tmp_path / "a.mp4"), "--speed", "0.02"]
    pipe = subprocess.PIPE
    process = subprocess.Popen(command, stdout=pipe, stderr=pipe, text=True, start_new_session=True)
    try:
        deadline = time.monotonic() + 60.0
        while not any(tmp_path.iterdir()):
            assert time.monotonic() < deadline
            assert process.poll() is None
            time.sleep(0.05)
        time.sleep(3.0)
        os.killpg(process.pid, signal.SIGINT)
        out, err = process.communicate(timeout=60.0)
    finally:
        process.kill()
    assert process.returncode == 130, err
    assert (out, err) == ("", "")
    assert list(tmp_path.iterdir()) == []
