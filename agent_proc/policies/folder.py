"""A trained policy as a folder: its networks, its normalizer, and a card that describes it."""

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any, Final, Literal

import msgspec
import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from agent_proc.policies.folder_files import read_file, require_small_zip
from agent_proc.profiles.profile import AnyProfile, read_profile
from agent_proc.task.config import TaskConfig
from legpush.errors import ConfigError, PolicyError, one_line
from legpush.files import replace_folder
from legpush.plugins import plugin_names

FORMAT: Final = 1
NETWORKS_FILE: Final = "policy.zip"
NORMALIZER_FILE: Final = "normalizer.json"
CARD_FILE: Final = "card.json"
README_FILE: Final = "README.md"


class Normalizer(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Normalizes observations: `clip((observation - mean) / sqrt(variance + epsilon))`."""

    mean: tuple[float, ...]
    variance: tuple[float, ...]
    clip: float = 10.0
    epsilon: float = 1e-8

    def apply(self, observation: NDArray[np.float32]) -> NDArray[np.float32]:
        """The normalized observation, (n,), as in training."""
        scaled = (observation - np.array(self.mean)) / np.sqrt(np.array(self.variance) + self.epsilon)
        clipped: NDArray[np.float32] = np.clip(scaled, -self.clip, self.clip).astype(np.float32)
        return clipped


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

    format: Literal[1] = FORMAT
    command: str
    """The command that trained it."""
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


@dataclass(frozen=True, kw_only=True)
class PolicyFolder:
    """The content of the folder of a policy."""

    card: Card
    networks: bytes
    normalizer: Normalizer | None


def shipped_policies() -> tuple[str, ...]:
    """Names of the policies that come with this package, sorted."""
    folder = files("agent_proc") / "policies"
    return tuple(sorted(e.name for e in folder.iterdir() if (e / CARD_FILE).is_file())) if folder.is_dir() else ()


def policy_path(name_or_path: str) -> Path:
    """The folder of a shipped policy by its name, or the folder at a path.

    Raises:
        PolicyError: There is no such policy or folder.
    """
    if name_or_path in shipped_policies():
        return Path(str(files("agent_proc") / "policies" / name_or_path))
    folder = Path(name_or_path)
    if not folder.is_dir():
        valid = ", ".join(plugin_names("legpush.policies"))
        raise PolicyError(f"Expected a policy ({valid}) or the folder of one, got {name_or_path!r}")
    return folder


def write_policy(folder: Path, policy: PolicyFolder) -> None:
    """Write the folder in place of the previous one.

    Raises:
        DiskError: It cannot be written; the previous one is untouched.
    """

    def fill(part: Path) -> None:
        (part / NETWORKS_FILE).write_bytes(policy.networks)
        if policy.normalizer is not None:
            (part / NORMALIZER_FILE).write_bytes(msgspec.json.encode(policy.normalizer))
        (part / CARD_FILE).write_bytes(msgspec.json.format(msgspec.json.encode(policy.card), indent=1) + b"\n")
        (part / README_FILE).write_text(_readme(policy.card), encoding="utf-8")

    replace_folder(folder, fill)


def read_policy(folder: Path) -> PolicyFolder:
    """Read the folder.

    Raises:
        PolicyError: A file is missing or cannot be used; the message names it.
    """
    card = read_card(folder)
    networks = read_file(folder / NETWORKS_FILE)
    require_small_zip(networks, str(folder / NETWORKS_FILE))
    normalizer = None
    if card.profile.normalize_observation:
        normalizer = _decode(folder / NORMALIZER_FILE, Normalizer)
        if len(normalizer.mean) != len(normalizer.variance):
            raise PolicyError(
                f"{folder / NORMALIZER_FILE}: expected as many variances as means, got {len(normalizer.variance)} "
                f"and {len(normalizer.mean)}"
            )
    return PolicyFolder(card=card, networks=networks, normalizer=normalizer)


def read_card(folder: Path) -> Card:
    """Read the card of a policy.

    Raises:
        PolicyError: The file is missing, or a field is wrong; the message names it.
    """
    path = folder / CARD_FILE
    plain = _decode(path, dict)
    try:
        profile = read_profile(plain.get("profile", {}), "profile")
        rest: dict[str, Any] = {
            name: msgspec.convert(plain[name], kind) for name, kind in _CARD_FIELDS.items() if name in plain
        }
        return Card(profile=profile, **rest)
    except ConfigError as error:
        raise PolicyError(f"{path}: {error}") from error
    except (msgspec.ValidationError, TypeError) as error:
        raise PolicyError(f"{path}: expected the card of a policy ({error})") from error


_CARD_FIELDS: Final[dict[str, Any]] = {
    "format": Literal[1],
    "command": str,
    "task": TaskConfig,
    "seed": int,
    "steps": int,
    "n_simulators": int,
    "versions": dict[str, str],
    "check": Check | None,
    "curve": tuple[CurvePoint, ...],
}
"""Types of all fields but the profile, whose type depends on its algorithm."""


def _decode(path: Path, kind: Any) -> Any:
    try:
        return msgspec.json.decode(read_file(path), type=kind)
    except (msgspec.MsgspecError, RecursionError) as error:
        raise PolicyError(f"{path}: {error}") from error


def _readme(card: Card) -> str:
    """The card as text for the README."""
    task, profile = card.task, card.profile
    lines = [
        f"# Policy: {task.entry} entry, {profile.algorithm.upper()}",
        "",
        f"Trained on the scenario `{task.scenario.name}` with {card.steps} push cycles, seed {card.seed}, "
        f"{card.n_simulators} simulators:",
        "",
        f"    {one_line(card.command)}",
        "",
        f"- profile: {one_line(profile.description)}; observation `{task.observation}`, reward `{task.reward}`",
        f"- networks: {' x '.join(map(str, profile.network.hidden))}, {profile.network.activation}",
        f"- evaluation that it was kept for: {card.check or 'none'}",
        f"- training episodes: {len(card.curve)}; {CARD_FILE} lists all of them, and every setting",
        "",
    ]
    return "\n".join(lines)
