"""Policy folders and model files from elsewhere: data alone, within limits."""

import io
import os
import pickle
import shutil
import zipfile
from pathlib import Path

import msgspec
import pytest

from agent_proc.policies.card import CARD_FILE
from agent_proc.policies.folder import WEIGHTS_FILE, policy_path
from agent_proc.policies.folder_files import MAX_BYTES
from agent_proc.policies.learned import load_learned
from agent_proc.policies.registry import make_policy, policy_from_data
from agent_proc.policies.sb3.old_folder import NETWORKS_FILE, read_old_policy
from legpush.errors import PolicyError
from tests.security.evil import RAN, Bomb, marks, weights_of_bombs, write_model


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A good policy folder to put something bad into, in the working directory of the test."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(policy_path("variable"), tmp_path / "policy")
    return tmp_path / "policy"


@pytest.fixture
def old(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """The same of format 1, whose weights are a zip of Stable-Baselines3."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(Path(__file__).parents[1] / "compatibility" / "policies" / "tuned", tmp_path / "old")
    return tmp_path / "old"


def test_the_folders_are_good_before_anything_is_put_into_them(folder: Path, old: Path) -> None:
    load_learned(str(folder))
    read_old_policy(old)


def test_a_pickle_in_the_place_of_weights_is_not_run(folder: Path) -> None:
    (folder / WEIGHTS_FILE).write_bytes(pickle.dumps(Bomb()))

    with pytest.raises(PolicyError, match="expected weights in the format safetensors"):
        load_learned(str(folder))
    assert marks(folder.parent) == set()


def test_a_pickle_in_old_weights_is_not_run(old: Path) -> None:
    with zipfile.ZipFile(io.BytesIO(weights_of_bombs())) as outer:
        inner = zipfile.ZipFile(io.BytesIO(outer.read("policy.pth")))
    pickle.loads(inner.read("archive/data.pkl"))
    assert marks(old.parent) == {RAN}, "the bomb does not work"
    (old.parent / RAN).unlink()

    (old / NETWORKS_FILE).write_bytes(weights_of_bombs())
    with pytest.raises(PolicyError, match=r"policy\.zip: expected a policy of Stable-Baselines3"):
        read_old_policy(old)
    assert marks(old.parent) == set()


def test_pickled_settings_beside_old_weights_are_not_run(old: Path) -> None:
    write_model(old.parent / "model.zip")
    settings = zipfile.ZipFile(old.parent / "model.zip").read("data")
    weights = zipfile.ZipFile(old / NETWORKS_FILE).read("policy.pth")
    with zipfile.ZipFile(old / NETWORKS_FILE, "w") as archive:
        archive.writestr("data", settings)
        archive.writestr("policy.pth", weights)

    read_old_policy(old)

    assert marks(old.parent) == set()


def test_a_bare_pickle_in_the_place_of_old_weights_is_not_run(old: Path) -> None:
    with zipfile.ZipFile(old / NETWORKS_FILE, "w") as archive:
        archive.writestr("policy.pth", pickle.dumps(Bomb(), protocol=2))

    with pytest.raises(PolicyError, match=r"policy\.zip: expected a policy of Stable-Baselines3"):
        read_old_policy(old)
    assert marks(old.parent) == set()


@pytest.mark.parametrize("name", [CARD_FILE, WEIGHTS_FILE])
def test_a_link_that_leaves_the_folder_is_refused(folder: Path, name: str) -> None:
    shutil.move(folder / name, folder.parent / name)
    (folder / name).symlink_to(folder.parent / name)

    with pytest.raises(PolicyError, match="got a link that leaves it"):
        load_learned(str(folder))


def test_a_link_within_the_folder_is_read(folder: Path) -> None:
    (folder / WEIGHTS_FILE).rename(folder / "weights")
    (folder / WEIGHTS_FILE).symlink_to("weights")

    load_learned(str(folder))


def test_a_pipe_is_refused_instead_of_waited_for(folder: Path) -> None:
    (folder / WEIGHTS_FILE).unlink()
    os.mkfifo(folder / WEIGHTS_FILE)

    with pytest.raises(PolicyError, match="something that is no file"):
        load_learned(str(folder))


@pytest.mark.parametrize("name", [CARD_FILE, WEIGHTS_FILE])
def test_a_huge_file_is_refused(folder: Path, name: str) -> None:
    os.truncate(folder / name, MAX_BYTES + 1)

    with pytest.raises(PolicyError, match=f"{name}: expected at most {MAX_BYTES} bytes"):
        load_learned(str(folder))


def compressed(name: str, content: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, content)
    return file.getvalue()


def test_a_zip_that_unpacks_to_too_much_is_refused_also_within_another(old: Path) -> None:
    zeros = bytes(MAX_BYTES + 1)
    for bomb in (compressed("policy.pth", zeros), compressed("policy.pth", compressed("archive/data/0", zeros))):
        assert len(bomb) < MAX_BYTES / 100
        (old / NETWORKS_FILE).write_bytes(bomb)
        with pytest.raises(PolicyError, match=f"unpacks to at most {MAX_BYTES} bytes, got {MAX_BYTES + 1}"):
            read_old_policy(old)


def test_a_card_with_huge_networks_is_refused(folder: Path) -> None:
    card = msgspec.json.decode((folder / "card.json").read_bytes())
    card["profile"]["network"]["hidden"] = [10**9] * 3
    (folder / "card.json").write_bytes(msgspec.json.encode(card))

    with pytest.raises(PolicyError, match=r"expected the array layers\.3\.bias for the networks on the card"):
        load_learned(str(folder))


def test_a_header_of_huge_arrays_is_refused_before_they_are_made(folder: Path) -> None:
    n_bytes = 4 * 10**12
    header = msgspec.json.encode({"layers.0.bias": {"dtype": "F32", "shape": [10**12], "data_offsets": [0, n_bytes]}})
    (folder / WEIGHTS_FILE).write_bytes(len(header).to_bytes(8, "little") + header)

    with pytest.raises(PolicyError, match="expected weights in the format safetensors"):
        load_learned(str(folder))


def test_a_deep_card_is_refused(folder: Path) -> None:
    (folder / "card.json").write_bytes(b'{"a":' * 10**5 + b"1" + b"}" * 10**5)

    with pytest.raises(PolicyError, match=r"card\.json"):
        load_learned(str(folder))


def test_a_model_file_is_not_unpickled_without_trust_nor_with_other_spaces(folder: Path) -> None:
    model = str(folder.parent / "model.zip")
    sha256 = write_model(Path(model))
    with pytest.raises(PolicyError, match=r"model\.zip: expected --trust-policy-file"):
        make_policy(model)
    with pytest.raises(PolicyError, match="which runs code: repeat it with --policy"):
        policy_from_data(model, sha256, trust_file=True)
    write_model(Path(model), n_seen=9)
    with pytest.raises(PolicyError, match=r"model\.zip: expected observations of shape .* got \(9,\)"):
        make_policy(model, trust_file=True)
    assert marks(folder.parent) == set()
    write_model(Path(model))
    with pytest.raises(PolicyError, match="expected a model saved by Stable-Baselines3"):
        make_policy(model, trust_file=True)
    assert marks(folder.parent) == {RAN}, "the bomb does not work"


def test_a_normalizer_is_not_unpickled_without_trust(folder: Path) -> None:
    pickled = folder.parent / "normalize.pkl"
    pickled.write_bytes(pickle.dumps(Bomb()))
    write_model(folder.parent / "model.zip")

    with pytest.raises(PolicyError, match="expected --trust-policy-file"):
        make_policy(str(folder.parent / "model.zip"), pickled)
    assert marks(folder.parent) == set()
