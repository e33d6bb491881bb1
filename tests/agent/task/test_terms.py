"""Terms by name: those of this package, those of another one, and what is refused."""

import sys
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from agent_proc.learning.env import PushEnv
from agent_proc.policies.digest import policy_sha256
from agent_proc.policies.registry import make_policy, policy_from_data
from agent_proc.task.config import ENDINGS
from agent_proc.task.file import load_task
from agent_proc.task.term import ObservationTerm, RewardTerm
from agent_proc.task.terms import ENDING, OBSERVATION, OWN, REWARD, complete, foreign_terms, make_terms
from legpush.errors import ConfigError, PluginError, PolicyError
from tests.agent.fake_world import FakeWorld, scenario_at_station
from tests.agent.learning.small_training import make_training, small_profile
from tests.legpush.test_plugins import install

EXAMPLE = Path(__file__).parents[3] / "examples" / "terms"


@pytest.fixture
def installed(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[Path]:
    """The example of a package with terms of its own, installed; the path of its task file."""
    names = {"along": "Along", "sideways": "Sideways", "tilted": "Tilted", "odd": "ODD"}
    entries = "".join(f"{name} = terms:{term}\n" for name, term in names.items())
    install(tmp_path, "their-terms", f"[legpush.tasks]\n{entries}")
    (tmp_path / "terms.py").write_text(f"{(EXAMPLE / 'terms.py').read_text()}\n\nODD = 3\n")
    monkeypatch.syspath_prepend(tmp_path)
    yield EXAMPLE / "straight.toml"
    sys.modules.pop("terms", None)


def test_no_two_terms_of_this_package_have_one_name() -> None:
    assert len(OWN) == len(OBSERVATION) + len(REWARD) + len(ENDING)


@pytest.mark.parametrize(
    ("kinds", "make", "tables", "message"),
    [
        ((RewardTerm,), make_terms, {"x": {}}, "at `r.x`: expected one of the terms corner_distance, .*got 'x'"),
        ((RewardTerm,), make_terms, {"x": {"term": 3}}, "at `r.x.term`: expected the name of a term, got 3"),
        ((RewardTerm,), make_terms, {"tip": {"leg": "FL"}}, "expected a term of the kind RewardTerm, got 'tip'"),
        ((RewardTerm,), complete, {"fall": {"weight": "a"}}, r"at `r.fall.weight`: expected a number, got .*'a'"),
        ((RewardTerm,), complete, {"fall": {"weight": 1e99}}, r"at `r.fall.weight`: expected a number from"),
        ((ObservationTerm,), complete, {"tip": {}}, "at `r.tip.leg`: expected a value, got nothing"),
        ((ObservationTerm,), complete, {"tip": {"leg": "XX"}}, "at `r.tip.leg`: expected one of FL, .* got 'XX'"),
        (ENDINGS, complete, {"past_goal": {"beyond": 1}}, r"unknown field \(did you mean `beyond_m`\?\)"),
    ],
)
def test_a_table_that_makes_no_term_is_refused_with_its_place(
    kinds: Any, make: Callable[..., object], tables: dict[str, dict[str, Any]], message: str
) -> None:
    with pytest.raises(ConfigError, match=message):
        make(tables, kinds, "r")


def test_a_completed_table_has_every_setting() -> None:
    tables = complete({"end": {"term": "release", "x_m": 0.2}}, ENDINGS, "ending")

    assert tables == {"end": {"term": "release", "corner_m": 0.1, "x_m": 0.2}}


def test_terms_of_another_package_are_observed_paid_and_obeyed(installed: Path) -> None:
    task = load_task(str(installed), scenario_at_station())
    env = PushEnv(task, FakeWorld(box_offset=(0.0, 0.03, 0.0)))
    observation, _ = env.reset(seed=0)
    assert -1.0 <= observation[0] <= -0.3
    assert observation[1] == pytest.approx(0.03, abs=1e-3)
    ending = None
    while ending is None:
        observation, reward, *_, info = env.step(np.array([0.0, 0.0, 1.0], dtype=np.float32))
        ending = info.get("ending")
        assert info["reward_terms"]["sideways"] == pytest.approx(-2.0 * abs(observation[1]))
        assert reward == sum(info["reward_terms"].values())

    assert ending == "astray"  # FR alone turns the box until the rule of the package gives up.


def test_a_policy_that_was_trained_with_terms_of_another_package_uses_them_again(
    installed: Path, tmp_path: Path
) -> None:
    profile = replace(small_profile(steps=32), task=str(installed))
    make_training(tmp_path / "training", profile).run()

    name = str(tmp_path / "training" / "last")
    assert make_policy(name) is not None
    sha256 = policy_sha256(name)
    with pytest.raises(PolicyError, match=r"terms of other packages \(along, sideways, tilted\), which run code"):
        policy_from_data(name, sha256)
    assert policy_from_data(name, sha256, repeated=name) is not None

    (tmp_path / "terms.py").write_text("changed = True\n")
    with pytest.raises(PolicyError, match="what it decided cannot be decided again"):
        policy_from_data(name, sha256, repeated=name)


def test_a_plug_in_that_is_no_term_is_refused(installed: Path) -> None:
    with pytest.raises(ConfigError, match=r"at `r\.odd`: expected a term of the kind RewardTerm, got 'odd'"):
        make_terms({"odd": {}}, (RewardTerm,), "r")


def test_terms_that_are_not_installed_are_named_with_those_that_are(installed: Path) -> None:
    with pytest.raises(ConfigError, match="of other packages: along, odd, sideways, tilted, got 'sidewise'"):
        make_terms({"sidewise": {}}, (RewardTerm,), "r")


def test_a_term_that_cannot_be_imported_names_its_package(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    install(tmp_path, "broken-terms", "[legpush.tasks]\nnowhere = no_such_module:Term\n")
    monkeypatch.syspath_prepend(tmp_path)

    with pytest.raises(PluginError, match="term of a task 'nowhere' of the package broken-terms"):
        make_terms({"nowhere": {}}, (RewardTerm,), "r")


def test_the_terms_of_other_packages_are_known_without_an_import() -> None:
    task = {"reward": {"fall": {}, "mine": {"term": "no_such_term"}}, "ending": {"other": {}}, "observation": "paper"}

    assert foreign_terms(task) == ("no_such_term", "other")
