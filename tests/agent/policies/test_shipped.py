"""The policies that come with the package."""

from collections.abc import Callable
from pathlib import Path

import pytest

from agent_proc.policies.folder import README_FILE, policy_path, read_policy, shipped_policies, write_policy
from agent_proc.policies.learned import LearnedPolicy
from agent_proc.policies.shipped import fixed, variable, wide


@pytest.mark.parametrize(("make", "entry"), [(fixed, "fixed"), (variable, "variable"), (wide, "variable")])
def test_each_plug_in_is_the_policy_of_its_name(make: Callable[[], LearnedPolicy], entry: str) -> None:
    policy = make()

    assert policy.card == read_policy(policy_path(make.__name__)).card
    assert policy.card.task.entry == entry


@pytest.mark.parametrize("name", shipped_policies())
def test_its_readme_is_the_one_that_would_be_written_today(name: str, tmp_path: Path) -> None:
    shipped = policy_path(name)
    write_policy(tmp_path / name, read_policy(shipped))

    assert (shipped / README_FILE).read_text() == (tmp_path / name / README_FILE).read_text()
