"""`legpush policy`: what it prints, what it writes, and what it refuses."""

import json
import subprocess
import sys
from pathlib import Path

import onnxruntime
import pytest

from agent_proc.policies.digest import policy_sha256
from agent_proc.policies.folder import policy_path, read_policy
from agent_proc.policies.learned import load_learned
from agent_proc.policies.weights_file import encode_weights
from agent_proc.programs.policy import read_any_policy, run
from legpush.errors import ConfigError, PolicyError
from legpush.options.policies import ExportPolicy, ShowPolicy

OLD = Path(__file__).parents[2] / "compatibility" / "policies"


def test_a_policy_is_shown_with_its_training_and_its_elements(capsys: pytest.CaptureFixture[str]) -> None:
    assert run(ShowPolicy(policy="variable")) == 0

    said = capsys.readouterr().out
    for words in ("legpush train --profile tuned", "| box.x | m | goal |", "| depth | -1, 1 |", "success 100%"):
        assert words in said


@pytest.mark.parametrize("name", ["variable", "fixed"])
def test_the_exported_folder_of_a_shipped_policy_is_that_policy(name: str, tmp_path: Path) -> None:
    assert run(ExportPolicy(policy=name, to="safetensors", out=tmp_path / "new")) == 0

    new, shipped = (read_policy(path) for path in (tmp_path / "new", policy_path(name)))
    assert new.card == shipped.card
    weights = [encode_weights(policy.layers, policy.normalizer) for policy in (new, shipped)]
    assert weights[0] == weights[1]


def test_the_export_of_an_exported_folder_is_that_folder(tmp_path: Path) -> None:
    for source, out in (("variable", "once"), (str(tmp_path / "once"), "twice")):
        assert run(ExportPolicy(policy=source, to="safetensors", out=tmp_path / out)) == 0

    assert policy_sha256(str(tmp_path / "once")) == policy_sha256(str(tmp_path / "twice"))


def test_a_folder_of_the_earlier_format_is_converted(tmp_path: Path) -> None:
    with pytest.raises(PolicyError, match="legpush policy export"):
        load_learned(str(OLD / "sac"))

    assert run(ExportPolicy(policy=str(OLD / "sac"), to="safetensors", out=tmp_path / "new")) == 0

    assert load_learned(str(tmp_path / "new")).card == read_any_policy(str(OLD / "sac")).card


def test_a_model_is_written_with_its_card(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert run(ExportPolicy(policy="fixed", to="onnx", out=tmp_path / "model")) == 0

    session = onnxruntime.InferenceSession(tmp_path / "model" / "policy.onnx")
    card = json.loads((tmp_path / "model" / "card.json").read_bytes())
    assert session.get_inputs()[0].shape == ["batch", len(card["observation"])]
    assert session.get_outputs()[0].shape == ["batch", len(card["action"])]
    assert capsys.readouterr().out.endswith("model: README.md, card.json, policy.onnx\n")


@pytest.mark.parametrize("name", ["scripted", "nobody", "my_module:make", "model.zip"])
def test_what_is_no_trained_policy_is_refused(name: str, tmp_path: Path) -> None:
    with pytest.raises(
        PolicyError, match=r"Expected a trained policy \(fixed, variable, wide\) or the folder of one, got"
    ):
        run(ExportPolicy(policy=name, to="onnx", out=tmp_path / "new"))
    assert list(tmp_path.iterdir()) == []


def test_nothing_is_overwritten(tmp_path: Path) -> None:
    for out in (tmp_path, tmp_path / "none" / "new"):
        with pytest.raises(ConfigError, match="Expected a new folder in an existing one for --out"):
            ExportPolicy(policy="variable", out=out)


def test_the_command_line_takes_format_and_folder_as_flags(tmp_path: Path) -> None:
    code = "import sys; from legpush.cli import main; sys.exit(main())"
    argv = [sys.executable, "-c", code, "policy", "export", "variable", "--to", "onnx", "--out", str(tmp_path / "new")]

    done = subprocess.run(argv, capture_output=True, text=True, check=False)

    assert done.returncode == 0, done.stderr
    assert (tmp_path / "new" / "policy.onnx").is_file()
