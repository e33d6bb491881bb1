"""A trained policy as a folder: its weights, and a card that describes it."""

from dataclasses import dataclass
from importlib.resources import files
from pathlib import Path
from typing import Any, Final

import msgspec

from agent_proc.policies.actor import Actor, Layer, Normalizer
from agent_proc.policies.card import CARD_FILE, Card, Check, CurvePoint, readme
from agent_proc.policies.folder_files import decode_file, read_file
from agent_proc.policies.reach import Reach
from agent_proc.policies.weights_file import decode_weights, encode_weights
from agent_proc.profiles.profile import read_profile
from agent_proc.task.action import CHOICES, n_actions
from agent_proc.task.elements import Element, action_elements, observation_elements
from agent_proc.task.file import read_task
from agent_proc.task.observed import n_observed
from legpush.errors import ConfigError, PluginError, PolicyError
from legpush.files import replace_folder
from legpush.plugins import plugin_names
from legpush.scenarios.file import scenario_table

FORMAT: Final = 3
FORMER_FORMAT: Final = 2
"""With a word each for observation and reward; read like the present one."""
OLD_FORMAT: Final = 1
"""With the networks in a zip of Stable-Baselines3."""
WEIGHTS_FILE: Final = "policy.safetensors"
README_FILE: Final = "README.md"
OBSERVATION: Final = "observation"
ACTION: Final = "action"
"""Fields of the card that follow from its task."""


@dataclass(frozen=True, kw_only=True, eq=False)
class PolicyFolder:
    """The content of the folder of a policy."""

    card: Card
    layers: tuple[Layer, ...]
    """Of the actor."""
    normalizer: Normalizer | None

    def actor(self) -> Actor:
        """The network of the actor."""
        profile, task = self.card.profile, self.card.task
        activation = profile.network.activation
        if task.action_form == "discrete":
            return Actor(self.layers, activation, "argmax", CHOICES)
        return Actor(self.layers, activation, "clip" if profile.algorithm == "ppo" else "tanh")


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


def trained_path(name_or_path: str) -> Path:
    """The same, for what needs a trained policy: the other names are no choice.

    Raises:
        PolicyError: There is no such policy or folder.
    """
    if name_or_path not in shipped_policies() and not Path(name_or_path).is_dir():
        valid = ", ".join(shipped_policies())
        raise PolicyError(f"Expected a trained policy ({valid}) or the folder of one, got {name_or_path!r}")
    return policy_path(name_or_path)


def write_policy(folder: Path, policy: PolicyFolder) -> None:
    """Write the folder in place of the previous one.

    Raises:
        DiskError: It cannot be written; the previous one is untouched.
    """

    def fill(part: Path) -> None:
        (part / WEIGHTS_FILE).write_bytes(encode_weights(policy.layers, policy.normalizer))
        (part / CARD_FILE).write_bytes(encode_card(policy.card))
        (part / README_FILE).write_text(readme(policy.card), encoding="utf-8")

    replace_folder(folder, fill)


def read_policy(folder: Path) -> PolicyFolder:
    """Read the folder.

    Raises:
        PolicyError: A file is missing or cannot be used; the message names it.
    """
    card = read_card(folder)
    path = folder / WEIGHTS_FILE
    layers, normalizer = decode_weights(
        read_file(path), widths(card), normalized=card.profile.normalize_observation, where=str(path)
    )
    return PolicyFolder(card=card, layers=layers, normalizer=normalizer)


def widths(card: Card) -> tuple[int, ...]:
    """Number of observed elements, of units in each hidden layer, and of values of the last layer."""
    task = card.task
    n_values = sum(CHOICES) if task.action_form == "discrete" else n_actions(task)
    return n_observed(task), *card.profile.network.hidden, n_values


def encode_card(card: Card) -> bytes:
    """The card as JSON, with the meaning of every number that the policy sees and gives."""
    whole = {
        "format": FORMAT,
        "command": card.command,
        OBSERVATION: observation_elements(card.task),
        ACTION: action_elements(card.task),
        "task": {**msgspec.to_builtins(card.task), "scenario": scenario_table(card.task.scenario)},
        **{name: getattr(card, name) for name in ("profile", *_CARD_FIELDS) if name != "command"},
    }
    return msgspec.json.format(msgspec.json.encode(whole), indent=1) + b"\n"


def is_old_format(folder: Path) -> bool:
    """Whether a policy folder has the earlier format.

    Raises:
        PolicyError: Its card is missing, or is no JSON.
    """
    return bool(decode_file(folder / CARD_FILE, dict).get("format") == OLD_FORMAT)


def read_card(folder: Path) -> Card:
    """Read the card of a policy.

    Raises:
        PolicyError: The file is missing, or a field is wrong; the message names it.
    """
    path = folder / CARD_FILE
    if not path.exists():
        if held := sorted(str(card.parent) for card in folder.glob(f"*/{CARD_FILE}")):
            raise PolicyError(f"{folder}: expected a policy, got a folder of policies: choose {' or '.join(held)}")
        if held := sorted(str(card.parent) for card in folder.glob(f"*/*/{CARD_FILE}")):
            raise PolicyError(f"{folder}: expected a policy, got a folder of trainings: choose one, such as {held[0]}")
    plain = decode_file(path, dict)
    if plain.get("format") == OLD_FORMAT:
        raise PolicyError(
            f"{path}: expected a policy folder of format {FORMAT}, got format {OLD_FORMAT}, which earlier versions of "
            f"legpush wrote: `legpush policy export {folder} --to safetensors --out NEW` makes one of this format"
        )
    card = parse_card(plain, path, FORMAT, FORMER_FORMAT)
    for name, here in ((OBSERVATION, observation_elements(card.task)), (ACTION, action_elements(card.task))):
        _require_elements(plain.get(name), here, f"{path}: at `{name}`")
    return card


def parse_card(plain: dict[str, Any], path: Path, *formats: int) -> Card:
    """The card in the fields of the JSON file at `path`, which has one of these formats.

    Raises:
        PolicyError: A field is wrong; the message names it.
    """
    try:
        if plain.get("format") not in formats:
            raise PolicyError(
                f"{path}: at `format`: expected {' or '.join(map(str, formats))}, got {plain.get('format')!r}"
            )
        profile = read_profile(plain.get("profile", {}), "profile")
        rest: dict[str, Any] = {
            name: msgspec.convert(plain[name], kind) for name, kind in _CARD_FIELDS.items() if name in plain
        }
        return Card(profile=profile, task=read_task(plain.get("task"), "task"), **rest)
    except (ConfigError, PluginError) as error:
        raise PolicyError(f"{path}: {error}") from error
    except (msgspec.ValidationError, TypeError) as error:
        raise PolicyError(f"{path}: expected the card of a policy ({error})") from error


def _require_elements(plain: Any, here: tuple[Element, ...], where: str) -> None:
    """Check that the elements on a card have the names, units and frames that this version has for its task."""
    try:
        there = msgspec.convert(plain, tuple[Element, ...])
    except msgspec.ValidationError as error:
        raise PolicyError(f"{where}: {error}") from error
    got, expected = ([(each.name, each.unit, each.frame) for each in elements] for elements in (there, here))
    if got != expected:
        raise PolicyError(f"{where}: expected the elements of this version, {expected}, got {got}")


_CARD_FIELDS: Final[dict[str, Any]] = {
    "command": str,
    "seed": int,
    "steps": int,
    "n_simulators": int,
    "versions": dict[str, str],
    "check": Check | None,
    "curve": tuple[CurvePoint, ...],
    "reach": Reach | None,
    "world": str | None,
    "init": str | None,
}
"""Types of all fields but the profile and the task, which have readers of their own."""
