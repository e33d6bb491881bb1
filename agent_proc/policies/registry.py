"""Finds a policy by name: coded, shipped, a policy folder, a model file, or a user's factory."""

from collections.abc import Callable
from pathlib import Path
from typing import cast

from agent_proc.policies.digest import foreign_terms_of, policy_sha256
from agent_proc.policies.folder import OLD_FORMAT, is_old_format, policy_path
from agent_proc.policies.learned import load_learned
from agent_proc.policies.learning_libraries import learning_libraries
from agent_proc.policies.policy import Policy
from agent_proc.policies.world_policy import GuardedPolicy, as_policy
from legpush.errors import LegpushError, PluginError, PolicyError
from legpush.plugins import load_address, load_plugin, why_not_loaded
from legpush.policy_names import GROUP, SB3_SUFFIX, policy_kind, require_repeated, require_trust


def policy_from_data(name: str, sha256: str, *, repeated: str | None = None, trust_file: bool = False) -> Policy:
    """Make the policy that a recording names: a policy of this package, or a policy folder with this SHA-256.

    A policy that runs code, or whose task has terms of other packages, is made only if `repeated`, the name on this
    command line, is the same.

    Raises:
        PolicyError: The policy runs code and was not repeated, its files are others, or it cannot be used.
        PluginError: A plug-in cannot be imported.
    """
    require_repeated(name, repeated)
    require_trust(name, trust_file)
    got = policy_sha256(name)
    kind = policy_kind(name)
    # Earlier versions recorded no SHA-256 of code.
    if got != sha256 and not (sha256 == "" and kind in ("module:function", "plug-in")):
        reason = ""
        if kind == "own":
            reason = "; use the version that made the recording"
        elif kind == "folder" and is_old_format(policy_path(name)):
            reason = f". It has format {OLD_FORMAT}, which this version only converts: use the one that recorded it"
        version = "other version: " if kind == "own" else ""
        raise PolicyError(
            f"{version}Expected the policy {name} of the recording, SHA-256 {sha256[:16]}..., got one with "
            f"{got[:16]}...: what it decided cannot be decided again{reason}"
        )
    if kind == "folder" and name != repeated and (terms := foreign_terms_of(policy_path(name))):
        raise PolicyError(
            f"The recording was made with the policy {name}, whose task has terms of other packages "
            f"({', '.join(terms)}), which run code: repeat it with --policy {name} if you trust them"
        )
    return make_policy(name, trust_file=trust_file)


def make_policy(name: str, normalizer: Path | None = None, *, trust_file: bool = False) -> Policy:
    """Make a policy: a plug-in (such as `scripted` or `variable`), a policy folder, a model file, or `module:factory`.

    The name must come from the user, since some of these run code; `policy_from_data` is for names from elsewhere.
    `normalizer` belongs to a model file (`.zip`) only, which needs `trust_file`. The learning libraries are imported
    only for a model file.

    Raises:
        PolicyError: There is no such policy, or it cannot be used.
        PluginError: A plug-in cannot be imported.
    """
    kind = policy_kind(name)
    is_file = kind == "model file"
    if normalizer is not None and not is_file:
        raise PolicyError(f"Expected a model file ({SB3_SUFFIX}) with --normalizer, got {name!r}, which has its own")
    require_trust(name, trust_file)
    if kind == "module:function":
        return _from_address(name)
    if kind in ("own", "plug-in"):
        return _made_by(load_plugin(GROUP, name), name)
    if not is_file:
        return load_learned(name)
    with learning_libraries(f"the model file {name!r}"):
        from agent_proc.policies.sb3.model_file import load_sb3_file
    return GuardedPolicy(load_sb3_file(Path(name), normalizer), name)


def _from_address(name: str) -> Policy:
    """Make a policy with a user's function. Its `decide` takes a world and a scenario, or a `PushView`."""
    try:
        make = load_address(name, "module:factory that can be imported")
    except PluginError as error:
        raise PolicyError(str(error)) from error
    return _made_by(make, name)


def _made_by(make: Callable[[], object], name: str) -> Policy:
    """Call the factory of a policy; what is not of this package is guarded."""
    try:
        made = make()
    except LegpushError:
        raise
    except (Exception, SystemExit) as error:
        raise PolicyError(f"{name}: the factory raised {why_not_loaded(error)}") from error
    return cast(Policy, made) if type(made).__module__.startswith("agent_proc.") else user_policy(made, name)


def user_policy(policy: object, name: str = "policy") -> Policy:
    """Wrap a user's policy so that an exception in it becomes a `PolicyError`.

    Raises:
        PolicyError: It has no method `decide` that takes a view, or a world and a scenario.
    """
    decides = as_policy(policy)
    if decides is None:
        raise PolicyError(
            f"{name}: expected a policy with a method `decide(world, scenario)`, got {type(policy).__name__}"
        )
    return GuardedPolicy(decides, name)
