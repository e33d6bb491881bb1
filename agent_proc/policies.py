"""Policies by name: scripted, shipped, in a folder, or made by a function of the user's."""

import importlib
import os
import sys
from typing import Final

from agent_proc.policy import Policy
from agent_proc.policy_folder import PolicyError

SCRIPTED: Final = "scripted"


def make_policy(name: str) -> Policy:
    """The policy called `name`: `scripted`, a shipped one, a policy folder, or `module:factory`, which is called.

    The learning libraries are imported only for a trained one. `PolicyError` where there is no such policy.
    """
    if name == SCRIPTED:
        from agent_proc.scripted import ScriptedPolicy

        return ScriptedPolicy()
    if ":" in name:
        return _from_entry_point(name)
    try:
        from agent_proc.learned import load_learned
    except ModuleNotFoundError as error:
        raise PolicyError(
            f"Expected the learning libraries for the policy {name!r}, but {error.name} is not installed; "
            "pip install 'legpush[agent]' installs them"
        ) from error

    return load_learned(name)


def _from_entry_point(name: str) -> Policy:
    """What the function returns; its module is looked for in the working directory, too."""
    module, _, factory = name.partition(":")
    if os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    try:
        make = getattr(importlib.import_module(module), factory)
    except (ImportError, AttributeError, ValueError) as error:
        raise PolicyError(f"Expected module:factory that can be imported, got {name!r} ({error})") from error
    policy = make()
    if not callable(getattr(policy, "decide", None)):
        raise PolicyError(f"{name}: expected a policy with a method `decide`, got {type(policy).__name__}")
    checked: Policy = policy
    return checked
