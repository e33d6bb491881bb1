"""Training profiles: the task, the algorithm and its settings, in TOML files under `profiles/`."""

import tomllib
from collections.abc import Iterable
from importlib.resources import files
from pathlib import Path
from typing import Annotated, Any, Final, Literal

import msgspec
import tomli_w
from msgspec import Meta, Struct

from agent_proc.profiles.former import NAMES, current_table, is_former, usable_table
from legpush.bounds import MAX_TEXT
from legpush.errors import ConfigError, MessageError
from legpush.fields import Seed
from legpush.messages.codec import convert
from legpush.schema_errors import explain

SUFFIX: Final = ".toml"

Positive = Annotated[float, Meta(gt=0.0)]
NonNegative = Annotated[float, Meta(ge=0.0)]
Share = Annotated[float, Meta(ge=0.0, le=1.0)]
AtLeastOne = Annotated[int, Meta(ge=1)]
AtLeastTwo = Annotated[int, Meta(ge=2)]
Widths = Annotated[tuple[AtLeastOne, ...], Meta(min_length=1, max_length=16)]


class Network(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Hidden layers of actor and critic, the same for both."""

    hidden: Widths = (64, 64)
    activation: Literal["relu", "tanh"] = "tanh"


class PpoSettings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Proximal policy optimization; the defaults are those of Stable-Baselines3."""

    learning_rate: Positive = 3e-4
    decay_learning_rate: bool = False
    """Whether the rate decays linearly, to a tenth at the last step."""
    n_steps: AtLeastTwo = 2048
    """Steps of each simulator between two updates."""
    batch_size: AtLeastTwo = 64
    n_epochs: AtLeastOne = 10
    gamma: Share = 0.99
    gae_lambda: Share = 0.95
    clip_range: Positive = 0.2
    entropy_weight: NonNegative = 0.0
    log_std_init: float = 0.0
    """Logarithm of the standard deviation of exploration at the first step; continuous actions only."""
    log_std_end: float | None = None
    """The same at the last step, with linear interpolation between; learned like the weights if not given."""
    depth_bias: float = 0.0
    """Mean of the depth action at the first step, between -1 and 1; variable entry only."""


class OffPolicySettings(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Settings that soft actor-critic and twin delayed DDPG share; the defaults are those of Stable-Baselines3."""

    learning_rate: Positive = 3e-4
    gamma: Share = 0.99
    batch_size: AtLeastOne = 256
    buffer_size: AtLeastOne = 1_000_000
    learning_starts: AtLeastOne = 100
    gradient_steps: AtLeastOne = 1
    """Updates after each step of all simulators."""
    tau: Share = 0.005


class SacSettings(OffPolicySettings, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Soft actor-critic."""


class Td3Settings(OffPolicySettings, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Twin delayed DDPG."""

    learning_rate: Positive = 1e-3
    action_noise: NonNegative = 0.1
    """Standard deviation of the Gaussian noise for exploration."""


class TunedOn(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """What the settings of a profile were chosen by, and what they must not be judged by."""

    training_seeds: tuple[Seed, ...]
    """Seeds of the trainings."""
    first_start: Seed
    """Seed of the first of the starts from which their policies were evaluated."""
    n_starts: AtLeastOne


class Profile(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Fields of every training profile."""

    description: str
    steps: AtLeastOne
    """Total number of push cycles."""
    task: Annotated[str, Meta(min_length=1, max_length=MAX_TEXT)]
    """The task to learn: a built-in one, or the path of a task file, seen from the folder of the profile."""
    normalize_observation: bool = True
    """Whether to normalize by running mean and variance, which are saved with the policy."""
    normalize_reward: bool = True
    network: Network = Network()
    evaluate_every: AtLeastOne = 2500
    """Steps between two evaluations; the best policy up to then is kept."""
    evaluation_episodes: AtLeastOne = 20
    checkpoint_every: AtLeastOne = 1000
    """Steps between two checkpoints; an interruption saves an additional one."""
    tuned_on: TunedOn | None = None
    """Written by `legpush tune`."""


class PpoProfile(Profile, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Train with PPO."""

    algorithm: Literal["ppo"]
    settings: PpoSettings = PpoSettings()


class SacProfile(Profile, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Train with SAC."""

    algorithm: Literal["sac"]
    settings: SacSettings = SacSettings()


class Td3Profile(Profile, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """Train with TD3."""

    algorithm: Literal["td3"]
    settings: Td3Settings = Td3Settings()


AnyProfile = PpoProfile | SacProfile | Td3Profile
KINDS: Final[dict[str, type[AnyProfile]]] = {"ppo": PpoProfile, "sac": SacProfile, "td3": Td3Profile}


def profile_names() -> tuple[str, ...]:
    """Names of the built-in profiles, sorted."""
    folder = files("agent_proc") / "profiles"
    return tuple(sorted(Path(e.name).stem for e in folder.iterdir() if e.name.endswith(SUFFIX)))


def load_profile(name_or_path: str) -> AnyProfile:
    """Load a built-in profile by its name, or a file; a text with `/` or at its end `.toml` is a path.

    Raises:
        ConfigError: There is no such profile, or it cannot be used; the message names file and field.
    """
    if "/" in name_or_path or name_or_path.endswith(SUFFIX):
        source: Any = Path(name_or_path)
    elif name_or_path in profile_names():
        source = files("agent_proc") / "profiles" / f"{name_or_path}{SUFFIX}"
    elif name_or_path in NAMES:
        raise ConfigError(f"Expected a profile of today for --profile, got {name_or_path!r}: {NAMES[name_or_path]}")
    else:
        raise ConfigError(
            f"Expected the name of a profile ({', '.join(profile_names())}) or the path of a {SUFFIX} file for "
            f"--profile, got {name_or_path!r}"
        )
    try:
        plain = tomllib.loads(source.read_text(encoding="utf-8"))
    except (OSError, ValueError) as error:
        raise ConfigError(f"{source}: expected a training profile in TOML ({error})") from error
    if is_former(plain):
        try:
            plain = usable_table(plain)
        except ConfigError as error:
            raise ConfigError(f"{source}: {error}") from error
    profile = read_profile(plain, str(source))
    if isinstance(source, Path) and ("/" in profile.task or profile.task.endswith(SUFFIX)):
        profile = msgspec.structs.replace(profile, task=str(source.parent / profile.task))
    return profile


def read_profile(plain: object, source: str) -> AnyProfile:
    """Check the tables of a file, card or training called `source`, and make the profile.

    Raises:
        ConfigError: A field is wrong; the message names it.
    """
    if not isinstance(plain, dict):
        raise ConfigError(f"{source}: expected the table of a training profile, got {plain!r}")
    if is_former(plain):
        plain = current_table(plain)
    algorithm = plain.get("algorithm")
    if not isinstance(algorithm, str) or algorithm not in KINDS:
        raise ConfigError(f"{source}: at `algorithm`: expected one of {', '.join(KINDS)}, got {algorithm!r}")
    kind = KINDS[algorithm]
    try:
        return convert(plain, kind)
    except MessageError as error:
        raise ConfigError(f"{source}: {explain(str(error), plain, kind)}") from error


def dump_profile(profile: AnyProfile) -> str:
    """The profile as TOML, without fields that are None; loading it gives an equal profile."""
    return tomli_w.dumps(_without_none(msgspec.to_builtins(profile)))


def _without_none(table: dict[str, Any]) -> dict[str, Any]:
    """Drop values that are None, since TOML has no null."""
    return {
        name: _without_none(value) if isinstance(value, dict) else value
        for name, value in table.items()
        if value is not None
    }


def require_untuned_seeds(profile: AnyProfile, seeds: Iterable[int], flag: str) -> None:
    """Require training seeds by which the settings of the profile were not chosen.

    Raises:
        ConfigError: They were chosen by one of them; names it.
    """
    tuned_on = profile.tuned_on
    if tuned_on is not None and (both := sorted(set(seeds).intersection(tuned_on.training_seeds))):
        raise ConfigError(
            f"Expected training seeds by which the profile was not tuned for {flag}, got {both[0]}, which is one of "
            f"{', '.join(map(str, tuned_on.training_seeds))}"
        )
