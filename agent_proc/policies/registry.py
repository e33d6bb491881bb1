"""Finds a policy by name: scripted, shipped, a policy folder, a model file, or a user's factory."""

import importlib
import os
import sys
from pathlib import Path
from typing import Final

from agent_proc.policies.policy import Policy
from agent_proc.policies.world_policy import GuardedPolicy, as_policy
from legpush.errors import PolicyError

SCRIPTED: Final = "scripted"
SB3_SUFFIX: Final = ".zip"
"""Of a model that Stable-Baselines3 saved."""


def make_policy(name: str, normalizer: Path | None = None) -> Policy:
    """The policy called `name`: `scripted`, a shipped one, a policy folder, a model file, or `module:factory`.

    `normalizer` belongs to a model file (`.zip`) only. The learning libraries are imported only for a trained policy.

    Raises:
        PolicyError: There is no such policy, or it cannot be used.
    """
    is_file = name.endswith(SB3_SUFFIX)
    if normalizer is not None and not is_file:
        raise PolicyError(f"Expected a model file ({SB3_SUFFIX}) with --normalizer, got {name!r}, which has its own")
    if name == SCRIPTED:
        from agent_proc.policies.scripted import ScriptedPolicy

        return ScriptedPolicy()
    if ":" in name:
        return _from_entry_point(name)
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


def _from_entry_point(name: str) -> Policy:
    """The policy that a function returns; its module is looked for in the working directory, too.

    Its `decide` takes a world and a scenario, or a `PushView`.
    """
    module, _, factory = name.partition(":")
    if os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    try:
        make = getattr(importlib.import_module(module), factory)
    except (ImportError, AttributeError, ValueError) as error:
        raise PolicyError(f"Expected module:factory that can be imported, got {name!r} ({error})") from error
    try:
        made = make()
    except Exception as error:
        raise PolicyError(f"{name}: the factory raised {type(error).__name__}: {error}") from error
    return user_policy(made, name)


def user_policy(policy: object, name: str = "policy") -> Policy:
    """A policy of the user's, whose errors are told as those of a policy.

    Raises:
        PolicyError: It has no method `decide` that takes a view, or a world and a scenario.
    """
    decides = as_policy(policy)
    if decides is None:
        raise PolicyError(
            f"{name}: expected a policy with a method `decide(world, scenario)`, got {type(policy).__name__}"
        )
    return GuardedPolicy(decides, name)
