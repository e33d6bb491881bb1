"""Says by the name of a policy alone whether it runs code, and imports nothing to find out."""

import hashlib
import os
from functools import cache
from importlib.machinery import ModuleSpec, PathFinder
from importlib.util import find_spec
from pathlib import Path
from typing import Final, Literal, get_args

from legpush.errors import PolicyError
from legpush.plugins import Group, is_address, plugin_names, plugin_values

CODED: Final = ("scripted", "dynamic_programming")
"""Policies of this package that were not learned: code without a file."""
DEFAULT_POLICY: Final = "dynamic_programming"
"""Needs the fewest pushes on every kind of box and floor that was tried (docs/benchmark.md)."""
GROUP: Final[Group] = "legpush.policies"
"""Entry points of plug-ins."""
SB3_SUFFIX: Final = ".zip"
"""Suffix of a model that Stable-Baselines3 saved."""
TRUST_FILE: Final = "--trust-policy-file"
OWN_PACKAGES: Final = ("agent_proc.", "planner_proc.", "sim_proc.", "legpush.")
"""Modules of this package begin with one of these."""

PolicyKind = Literal["own", "folder", "model file", "plug-in", "module:function"]
"""`own` is a policy of this package, coded or shipped; a `plug-in` is of another package."""
DATA: Final[tuple[PolicyKind, ...]] = ("own", "folder")
"""Kinds that run no code besides that of this package."""


def policy_kind(name: str) -> PolicyKind:
    """Return the kind of a policy, as `--policy` would find it."""
    if ":" in name:
        return "module:function"
    if values := plugin_values(GROUP, name):
        return "own" if _are_own(values) else "plug-in"
    return "model file" if name.endswith(SB3_SUFFIX) else "folder"


def runs_code(name: str) -> bool:
    """Return whether this policy runs code of others: a function, a plug-in of another package, or a model file."""
    return policy_kind(name) not in DATA


def names_code(text: str) -> bool:
    """Return whether some cell of a study that has this text may run code of others by it, as a policy or otherwise.

    Kinds of cells are no matter of this.
    """
    return is_address(text) or text.endswith(SB3_SUFFIX) or text in _plugins_of_others()


@cache
def _plugins_of_others() -> frozenset[str]:
    """Return the names of the plug-ins of other packages that a cell may name; reading them takes milliseconds."""
    groups: tuple[Group, ...] = tuple(group for group in get_args(Group) if group != "legpush.cells")
    return frozenset(
        name for group in groups for name in plugin_names(group) if not _are_own(plugin_values(group, name))
    )


def _are_own(values: tuple[str, ...]) -> bool:
    """Return whether all these entry points refer to this package."""
    return all(value.startswith(OWN_PACKAGES) for value in values)


def require_trust(name: str, trust_file: bool) -> None:
    """Check that a model file is loaded only where the user trusts it, since loading it may run code.

    Raises:
        PolicyError: The policy is a model file, and the user did not say so.
    """
    if not trust_file and name.endswith(SB3_SUFFIX) and policy_kind(name) == "model file":
        raise PolicyError(
            f"{name}: expected {TRUST_FILE} (in Python: trust_policy_file=True) with a model file of "
            "Stable-Baselines3, which is a pickle: loading it runs any code in it; use it only if you trust the file"
        )


def require_repeated(name: str, repeated: str | None, flag: str = "--policy") -> None:
    """Check that the policy of a recording is only data, or that the user has repeated its name.

    Raises:
        PolicyError: The policy runs code, and the user did not repeat it.
    """
    if runs_code(name) and name != repeated:
        raise PolicyError(
            f"The recording was made with the policy {name}, which runs code: repeat it with {flag} {name} if you "
            "trust it"
        )


def source_sha256(address: str) -> str:
    """Return the SHA-256 of the source of `module:function`; empty if no source file is found."""
    source = _source_of(address.partition(":")[0])
    return "" if source is None else hashlib.sha256(source.read_bytes()).hexdigest()


def _source_of(module: str) -> Path | None:
    """Find the source file of a module without importing it, or a package above it."""
    top, *rest = module.split(".")
    try:
        spec = find_spec(top) or PathFinder.find_spec(top, [os.getcwd()])
        for name in rest:
            spec = None if spec is None else _inside(spec, name)
    except (ImportError, ValueError):
        return None
    if spec is None or not spec.has_location or spec.origin is None:
        return None
    origin = Path(spec.origin)
    return origin if origin.is_file() else None


def _inside(package: ModuleSpec, name: str) -> ModuleSpec | None:
    """Find a module in a package that is not imported."""
    places = package.submodule_search_locations
    return None if places is None else PathFinder.find_spec(name, list(places))
