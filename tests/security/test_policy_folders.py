"""Policy folders and model files from elsewhere: data alone, within limits."""

import io
import os
import pickle
import shutil
import zipfile
from pathlib import Path

import msgspec
import pytest

from agent_proc.policies.folder import NETWORKS_FILE, NORMALIZER_FILE, policy_path
from agent_proc.policies.folder_files import MAX_BYTES
from agent_proc.policies.learned import load_learned
from agent_proc.policies.registry import make_policy, policy_from_data
from legpush.errors import PolicyError
from tests.security.evil import RAN, Bomb, marks, weights_of_bombs, write_model


@pytest.fixture
def folder(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Path:
    """A good policy folder to put something bad into, in the working directory of the test."""
    monkeypatch.chdir(tmp_path)
    shutil.copytree(policy_path("variable"), tmp_path / "policy")
    return tmp_path / "policy"


def test_the_folder_is_good_before_anything_is_put_into_it(folder: Path) -> None:
    load_learned(str(folder))


def test_a_pickle_in_the_weights_is_not_run(folder: Path) -> None:
    with zipfile.ZipFile(io.BytesIO(weights_of_bombs())) as outer:
        inner = zipfile.ZipFile(io.BytesIO(outer.read("policy.pth")))
    pickle.loads(inner.read("archive/data.pkl"))
    assert marks(folder.parent) == {RAN}, "the bomb does not work"
    (folder.parent / RAN).unlink()

    (folder / NETWORKS_FILE).write_bytes(weights_of_bombs())
    with pytest.raises(PolicyError, match=r"policy\.zip: expected a policy of Stable-Baselines3"):
        load_learned(str(folder))
    assert marks(folder.parent) == set()


def test_pickled_settings_beside_the_weights_are_not_run(folder: Path) -> None:
    write_model(folder.parent / "model.zip")
    settings = zipfile.ZipFile(folder.parent / "model.zip").read("data")
    weights = zipfile.ZipFile(folder / NETWORKS_FILE).read("policy.pth")
    with zipfile.ZipFile(folder / NETWORKS_FILE, "w") as archive:
        archive.writestr("data", settings)
        archive.writestr("policy.pth", weights)

    load_learned(str(folder))

    assert marks(folder.parent) == set()


def test_a_bare_pickle_in_the_place_of_weights_is_not_run(folder: Path) -> None:
    with zipfile.ZipFile(folder / NETWORKS_FILE, "w") as archive:
        archive.writestr("policy.pth", pickle.dumps(Bomb(), protocol=2))

    with pytest.raises(PolicyError, match=r"policy\.zip: expected a policy of Stable-Baselines3"):
        load_learned(str(folder))
    assert marks(folder.parent) == set()


@pytest.mark.parametrize("name", ["card.json", NETWORKS_FILE, NORMALIZER_FILE])
def test_a_link_that_leaves_the_folder_is_refused(folder: Path, name: str) -> None:
    shutil.move(folder / name, folder.parent / name)
    (folder / name).symlink_to(folder.parent / name)

    with pytest.raises(PolicyError, match="got a link that leaves it"):
        load_learned(str(folder))


def test_a_link_within_the_folder_is_read(folder: Path) -> None:
    (folder / NETWORKS_FILE).rename(folder / "weights.zip")
    (folder / NETWORKS_FILE).symlink_to("weights.zip")

    load_learned(str(folder))


def test_a_pipe_is_refused_instead_of_waited_for(folder: Path) -> None:
    (folder / NORMALIZER_FILE).unlink()
    os.mkfifo(folder / NORMALIZER_FILE)

    with pytest.raises(PolicyError, match="something that is no file"):
        load_learned(str(folder))


@pytest.mark.parametrize("name", ["card.json", NETWORKS_FILE, NORMALIZER_FILE])
def test_a_huge_file_is_refused(folder: Path, name: str) -> None:
    os.truncate(folder / name, MAX_BYTES + 1)

    with pytest.raises(PolicyError, match=f"{name}: expected at most {MAX_BYTES} bytes"):
        load_learned(str(folder))


def compressed(name: str, content: bytes) -> bytes:
    file = io.BytesIO()
    with zipfile.ZipFile(file, "w", zipfile.ZIP_DEFLATED) as archive:
        archive.writestr(name, content)
    return file.getvalue()


def test_a_zip_that_unpacks_to_too_much_is_refused_also_within_another(folder: Path) -> None:
    zeros = bytes(MAX_BYTES + 1)
    for bomb in (compressed("policy.pth", zeros), compressed("policy.pth", compressed("archive/data/0", zeros))):
        assert len(bomb) < MAX_BYTES / 100
        (folder / NETWORKS_FILE).write_bytes(bomb)
        with pytest.raises(PolicyError, match=f"unpacks to at most {MAX_BYTES} bytes, got {MAX_BYTES + 1}"):
            load_learned(str(folder))


def test_a_card_with_huge_networks_is_refused_before_they_are_made(folder: Path) -> None:
    card = msgspec.json.decode((folder / "card.json").read_bytes())
    card["profile"]["network"]["hidden"] = [10**9, 10**9]
    (folder / "card.json").write_bytes(msgspec.json.encode(card))

    with pytest.raises(PolicyError, match=r"card\.json: expected networks of at most"):
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
