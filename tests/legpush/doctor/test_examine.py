"""The command `legpush doctor` as a whole."""

import json

import pytest

from legpush.cli import main
from legpush.doctor import examine
from legpush.doctor.finding import Finding

OK = Finding(name="python", state="ok", detail="3.11")
NOTE = Finding(name="opengl", state="note", detail="no film", cure="install it")
MISSING = Finding(name="sockets", state="missing", detail="none", cure="set TMPDIR")


@pytest.mark.parametrize(("findings", "code"), [([OK, NOTE], 0), ([OK, MISSING], 1)])
def test_the_exit_code_says_whether_a_mission_can_run(
    findings: list[Finding], code: int, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(examine, "all_findings", lambda: iter(findings))
    assert main(["doctor", "--json"]) == code
    said = capsys.readouterr()
    document = json.loads(said.out)
    assert document["can_run"] == (code == 0)
    assert [each["name"] for each in document["findings"]] == [each.name for each in findings]
    for finding in findings:
        assert finding.detail in said.err
        assert finding.cure in said.err
