"""Finds a policy by name: scripted, shipped, a policy folder, a model file, or a user's factory."""

import importlib
import os
import sys
from collections.abc import Callable
from pathlib import Path
from typing import Final, cast

from agent_proc.policies.policy import Policy
from agent_proc.policies.world_policy import GuardedPolicy, as_policy
from legpush.errors import LegpushError, PolicyError
from legpush.plugins import load_plugin, plugin_names

SCRIPTED: Final = "scripted"
GROUP: Final = "legpush.policies"
"""Entry points of plug-ins."""
SB3_SUFFIX: Final = ".zip"
"""Suffix of a model that Stable-Baselines3 saved."""


def make_policy(name: str, normalizer: Path | None = None) -> Policy:
    """Make a policy: a plug-in (`scripted`, `fixed`, `variable`), a policy folder, a model file, or `module:factory`.

    `normalizer` belongs to a model file (`.zip`) only. The learning libraries are imported only for a trained policy.

    Raises:
        PolicyError: There is no such policy, or it cannot be used.
        PluginError: A plug-in cannot be imported.
    """
    is_file = name.endswith(SB3_SUFFIX)
    if normalizer is not None and not is_file:
        raise PolicyError(f"Expected a model file ({SB3_SUFFIX}) with --normalizer, got {name!r}, which has its own")
    if ":" in name:
        return _from_address(name)
    if name in plugin_names(GROUP):
        return _made_by(load_plugin(GROUP, name), name)
    try:
        if is_file:
            from agent_proc.policies.sb3_file import load_sb3_file

            return load_sb3_file(Path(name), normalizer)
        from agent_proc.policies.learned import load_learned
    except ModuleNotFoundError as error:
        raise PolicyError(
            f"Expected the learning libraries for the policy {name!r}, but {error.name} is not installed; "
            "pip install 'legpush[agent]' installs them"
        ) from error

    return load_learned(name)


def _from_address(name: str) -> Policy:
    """Make a policy with a user's function, whose module may also lie in the working directory.

    The `decide` of the policy takes a world and a scenario, or a `PushView`.
    """
    module, _, factory = name.partition(":")
    if os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    try:
        make = getattr(importlib.import_module(module), factory)
    except (ImportError, AttributeError, ValueError) as error:
        raise PolicyError(f"Expected module:factory that can be imported, got {name!r} ({error})") from error
    return _made_by(make, name)


def _made_by(make: Callable[[], object], name: str) -> Policy:
    """Call the factory of a policy; what is not of this package is guarded."""
    try:
        made = make()
    except LegpushError:
        raise
    except Exception as error:
        raise PolicyError(f"{name}: the factory raised {type(error).__name__}: {error}") from error
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
