"""Policy folders of format 1: read without running code in them, and refused where they do not fit."""

import json
import shutil
from pathlib import Path

import pytest

from agent_proc.policies.folder import read_policy, write_policy
from agent_proc.policies.sb3.old_folder import read_old_policy
from agent_proc.policies.weights_file import encode_weights
from legpush.errors import PolicyError

OLD = Path(__file__).parents[3] / "compatibility" / "policies"


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """A policy folder of format 1."""
    return Path(shutil.copytree(OLD / "tuned", tmp_path / "policy"))


@pytest.mark.parametrize("name", ["tuned", "sac"])
def test_an_old_folder_is_written_in_the_present_format_with_the_same_numbers(name: str, tmp_path: Path) -> None:
    old = read_old_policy(OLD / name)

    write_policy(tmp_path / "new", old)

    new = read_policy(tmp_path / "new")
    assert new.card == old.card
    assert encode_weights(new.layers, new.normalizer) == encode_weights(old.layers, old.normalizer)
    assert len(new.layers) == 3
    assert new.normalizer is not None


@pytest.mark.parametrize("name", ["policy.zip", "normalizer.json", "card.json"])
def test_a_missing_file_is_named(folder: Path, name: str) -> None:
    (folder / name).unlink()

    with pytest.raises(PolicyError, match=rf"policy/{name}: expected this file of a policy"):
        read_old_policy(folder)


@pytest.mark.parametrize(
    ("name", "data", "message"),
    [
        ("policy.zip", b"no zip", r"policy\.zip: expected a policy of Stable-Baselines3 \(a zip\)"),
        ("normalizer.json", b"{", r"normalizer\.json: "),
        (
            "normalizer.json",
            b'{"mean": [1.0], "variance": [1.0], "clip": 10.0, "epsilon": 1e-8}',
            r"expected observation\.mean of \(8,\) float64",
        ),
    ],
)
def test_a_corrupt_file_is_named(folder: Path, name: str, data: bytes, message: str) -> None:
    (folder / name).write_bytes(data)

    with pytest.raises(PolicyError, match=message):
        read_old_policy(folder)


def test_half_a_zip_is_refused(folder: Path) -> None:
    data = (folder / "policy.zip").read_bytes()
    (folder / "policy.zip").write_bytes(data[: len(data) // 2])

    with pytest.raises(PolicyError, match=r"policy\.zip: expected (a policy of Stable-Baselines3|weights named)"):
        read_old_policy(folder)


def test_networks_that_do_not_fit_the_card_are_refused(folder: Path) -> None:
    card = json.loads((folder / "card.json").read_bytes())
    card["profile"]["network"]["hidden"] = [8, 9]
    (folder / "card.json").write_text(json.dumps(card), encoding="utf-8")

    with pytest.raises(PolicyError, match=r"policy\.zip: expected layers\.1\.weight of \(9, 8\) float32"):
        read_old_policy(folder)
