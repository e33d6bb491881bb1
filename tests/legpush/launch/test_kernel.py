"""`legpush kernel` installs a kernel that starts Python under the numerics profile."""

import json
import sys
from pathlib import Path

import pytest

from legpush.cli import command as cli
from legpush.launch.kernel import jupyter_folder
from tests.processors import plain_environment, python

NAME = "from legpush.numerics.current import current; print(current().profile)"


def test_a_kernel_starts_this_python_under_the_profile(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["kernel", "--prefix", str(tmp_path), "--name", "push"]) == 0
    file = tmp_path / "share" / "jupyter" / "kernels" / "push" / "kernel.json"
    assert capsys.readouterr().out == f"wrote {file}\n"
    specification = json.loads(file.read_text())
    assert specification["argv"] == [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
    environment = {**plain_environment(), **specification["env"]}
    assert python("-c", NAME, environment=environment).stdout == "x86-64-v3\n"


@pytest.mark.parametrize("name", ["", "..", "a/b"])
def test_a_name_that_is_no_folder_is_refused(tmp_path: Path, name: str, capsys: pytest.CaptureFixture[str]) -> None:
    assert cli.main(["kernel", "--prefix", str(tmp_path), "--name", name]) == 2
    assert f"for --name, got {name!r}" in capsys.readouterr().err
    assert list(tmp_path.iterdir()) == []


def test_a_prefix_that_is_a_file_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    file = tmp_path / "file"
    file.touch()
    assert cli.main(["kernel", "--prefix", str(file)]) == 2
    assert "Expected a folder that can be made" in capsys.readouterr().err


def test_jupyter_looks_where_its_variables_say() -> None:
    assert jupyter_folder({"JUPYTER_DATA_DIR": "/a", "XDG_DATA_HOME": "/b"}) == Path("/a")
    assert jupyter_folder({"XDG_DATA_HOME": "/b"}) == Path("/b/jupyter")
    assert jupyter_folder({}) == Path.home() / ".local" / "share" / "jupyter"
