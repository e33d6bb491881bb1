"""`legpush secure` as a user types it: what it prints, its documents, and its exit codes."""

import json
from pathlib import Path

import pytest

from legpush.cli import command as cli


def run(capsys: pytest.CaptureFixture[str], *words: str) -> tuple[int, str, str]:
    """Exit code, standard output and standard error of a command."""
    try:
        code = cli.main(["secure", *words])
    except SystemExit as end:
        code = int(end.code or 0)
    said = capsys.readouterr()
    return code, said.out, said.err


def test_the_commands_say_what_to_copy_where(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lab = str(tmp_path / "lab")
    code, said, _ = run(capsys, "init", lab, "robot=10.0.0.7", "laptop")
    assert (code, said.splitlines()) == (
        0,
        [
            f"{lab}/laptop: copy it to laptop, for --secure there",
            f"{lab}/robot: copy it to robot, for --secure there",
            f"{lab}/authority: the authority, which signs certificates: keep it to yourself",
        ],
    )
    copies = f"{lab}/*/access.json: copy it to each host; processes that are started after that obey it"
    assert run(capsys, "add", lab, "desk") == (
        0,
        f"{lab}/desk: copy it to desk, for --secure there\n{copies}\n",
        "",
    )
    assert run(capsys, "renew", lab, "desk", "--roles", "sim")[1].startswith(f"{lab}/desk: copy it")
    assert run(capsys, "revoke", lab, "robot") == (0, f"{copies}\n", "")
    code, said, _ = run(capsys, "show", lab)
    states = {line.split()[0]: line.split()[1] for line in said.splitlines()}
    assert (code, len(states)) == (0, 21)
    assert (states["sim.desk.2"], states["sim.robot.1"], states["viewer.laptop.1"]) == ("valid", "revoked", "valid")


def test_the_documents_have_names_and_states(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    lab = str(tmp_path / "lab")
    begun = json.loads(run(capsys, "init", lab, "--json")[1])
    assert begun["names"]["viewer"] == ["viewer.localhost.1", "viewer.localhost.2"]
    shown = json.loads(run(capsys, "show", lab, "--json")[1])
    assert {(each["host"], each["state"]) for each in shown} == {("localhost", "valid")}


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("init", "lab", "--days", "0"), "error: Expected 1 to 36500 days for --days, got 0"),
        (("init", "lab", "a.b"), "error: Expected a host as NAME or NAME=ADDRESS,ADDRESS"),
        (("add", "nowhere"), "error: nowhere: expected the folder that `legpush secure init` made"),
        (("renew", "lab", "--roles", "chief"), "chief"),
        (("show", "nowhere"), "error: nowhere: expected the folder that `legpush secure init` made"),
        (("revoke", "nowhere", "a"), "error: nowhere: expected the folder that `legpush secure init` made"),
        (("revoke", "nowhere"), "error: Expected the hosts whose certificates are revoked, got none"),
    ],
)
def test_bad_input_is_one_error_and_exit_code_2(
    words: tuple[str, ...],
    said: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    monkeypatch.chdir(tmp_path)
    code, out, err = run(capsys, *words)
    assert (code, out) == (2, "")
    assert said in err
    assert "Traceback" not in err
    assert list(tmp_path.iterdir()) == []
