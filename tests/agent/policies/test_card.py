"""The README of a policy says how it came about."""

from dataclasses import replace

import pytest

from agent_proc.policies.card import readme
from tests.agent.policies.policies import CARD


def test_the_readme_says_how_the_policy_came_about() -> None:
    text = readme(CARD)

    assert "    legpush train --seed 7\n" in text
    assert "success 50%, 2.00 cm, 1.50°, 20 cycles, 0 falls (n = 2)" in text


@pytest.mark.parametrize(
    ("world", "init", "lines"),
    [
        (None, None, []),
        ("map", None, ["- world that it learned in: map", "- first weights: random weights"]),
        ("mujoco", "runs/first", ["- world that it learned in: mujoco", "- first weights: those of runs/first"]),
    ],
)
def test_it_names_the_world_and_the_first_weights(world: str | None, init: str | None, lines: list[str]) -> None:
    text = readme(replace(CARD, world=world, init=init)).splitlines()
    assert [line for line in text if line.startswith(("- world", "- first"))] == lines
