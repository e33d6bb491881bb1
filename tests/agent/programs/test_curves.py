import io
import json
from pathlib import Path

import pytest
from rich.console import Console

from agent_proc.policies.folder import policy_path
from agent_proc.programs.curves import draw_curves
from legpush.arguments import OutputOptions
from legpush.errors import ConfigError
from legpush.options.learning_tools import CurvesOptions
from legpush.output.reply import replying


def test_the_curves_of_a_policy_are_those_of_its_card(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    console = Console(file=io.StringIO(), width=400)
    options = CurvesOptions(runs=(str(policy_path("variable")),), out=tmp_path / "c.png")
    with replying(OutputOptions(json=True)):
        assert draw_curves(options, console) == 0
    said = console.file.getvalue()  # type: ignore[attr-defined]
    assert said.startswith("variable: return ")
    assert f"wrote {tmp_path / 'c.png'}" in said
    plain = json.loads(capsys.readouterr().out)
    assert [curve["label"] for curve in plain["curves"]] == ["variable"]
    assert len(plain["curves"][0]["seeds"]["success"][0]) == len(plain["curves"][0]["step"])
    with pytest.raises(ConfigError, match="Expected a new file in an existing folder for --out"):
        draw_curves(options, console)


def test_what_has_no_episodes_is_refused(tmp_path: Path) -> None:
    with pytest.raises(ConfigError, match="got scripted, which has no episodes"):
        draw_curves(CurvesOptions(runs=("scripted",), out=tmp_path / "c.png"), Console())
    with pytest.raises(ConfigError, match="Expected at least one RUN"):
        CurvesOptions(runs=())
