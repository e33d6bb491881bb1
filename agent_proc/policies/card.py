"""The card of a policy: what it does, and how it was trained."""

from dataclasses import dataclass
from typing import Final

from msgspec import Struct

from agent_proc.policies.reach import Reach
from agent_proc.profiles.profile import AnyProfile
from agent_proc.task.config import TaskConfig
from agent_proc.task.elements import action_elements, observation_elements
from legpush.errors import one_line

CARD_FILE: Final = "card.json"


class CurvePoint(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An episode that ended during training."""

    step: int
    episode_return: float
    length: int
    success: bool
    position_error_m: float
    """At the end of the episode, like the angle."""
    angle_error_deg: float


class Check(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Result of an evaluation of the deterministic policy."""

    step: int
    """Step of the training at which it was made."""
    seeds: tuple[int, ...]
    success_rate: float
    position_error_m: float
    """Mean."""
    angle_error_deg: float
    """Mean."""
    falls: int
    cycles: float
    """Mean."""

    def __str__(self) -> str:
        """One line for logs and the README of the policy."""
        return (
            f"success {self.success_rate:.0%}, {100 * self.position_error_m:.2f} cm, {self.angle_error_deg:.2f}°, "
            f"{self.cycles:.0f} cycles, {self.falls} falls (n = {len(self.seeds)})"
        )


@dataclass(frozen=True, kw_only=True)
class Card:
    """What a policy does and how it was trained."""

    command: str
    """Makes it again."""
    task: TaskConfig
    profile: AnyProfile
    seed: int
    """Seed of the training."""
    steps: int
    """Push cycles of the training up to this policy."""
    n_simulators: int
    versions: dict[str, str]
    check: Check | None
    """The evaluation for which it was kept."""
    curve: tuple[CurvePoint, ...]
    reach: Reach | None = None
    """How far off it was trained; None for policies of versions that did not note it."""
    world: str | None = None
    """What it learned in; None for policies of versions that did not note it."""
    init: str | None = None
    """The policy or the folder of the training that it began with; None for random weights."""


def readme(card: Card) -> str:
    """The card as text for the README of a folder."""
    task, profile = card.task, card.profile
    lines = [
        f"# Policy: {task.entry} entry, {profile.algorithm.upper()}",
        "",
        f"Trained on the scenario `{task.scenario.name}` with {card.steps} push cycles, seed {card.seed}, "
        f"{card.n_simulators} simulators:",
        "",
        f"    {one_line(card.command)}",
        "",
        *_origin(card),
        f"- profile: {one_line(profile.description)}",
        f"- task: {one_line(task.description) or 'without a description'}",
        f"- reward: {', '.join(_weighted(task))}; an episode ends by {', '.join(task.ending) or 'its length alone'}",
        f"- networks: {' x '.join(map(str, profile.network.hidden))}, {profile.network.activation}",
        f"- evaluation that it was kept for: {card.check or 'none'}",
        *([] if card.reach is None else [f"- trained with the box up to {card.reach}, where it stops"]),
        f"- training episodes: {len(card.curve)}; {CARD_FILE} lists all of them, and every setting",
        "",
        "| observation | unit | frame | meaning |",
        "| --- | --- | --- | --- |",
        *(f"| {e.name} | {e.unit} | {e.frame} | {e.meaning} |" for e in observation_elements(task)),
        "",
        "| action | from, to | meaning |",
        "| --- | --- | --- |",
        *(f"| {e.name} | {e.low:g}, {e.high:g} | {e.meaning} |" for e in action_elements(task)),
        "",
    ]
    return "\n".join(lines)


def _weighted(task: TaskConfig) -> list[str]:
    """The terms of the reward with their weights."""
    return [f"{term.weight:g} {name}" for name, term in task.reward_terms.items()]


def _origin(card: Card) -> list[str]:
    """World and first weights; nothing for a policy of a version that did not note them."""
    if card.world is None:
        return []
    began = "random weights" if card.init is None else f"those of {one_line(card.init)}"
    return [f"- world that it learned in: {one_line(card.world)}", f"- first weights: {began}"]
