"""Finds planners, simulators, policies and other plug-ins by name, through the entry points of installed packages."""

import importlib
import os
import sys
from importlib.metadata import EntryPoint, entry_points
from typing import Any, Final, Literal

from legpush.errors import PluginError

Group = Literal[
    "legpush.planners",
    "legpush.simulators",
    "legpush.policies",
    "legpush.missions",
    "legpush.cells",
    "legpush.tasks",
    "legpush.loggers",
    "legpush.callbacks",
]

_NOUNS: Final[dict[Group, str]] = {
    "legpush.planners": "planner",
    "legpush.simulators": "simulator",
    "legpush.policies": "policy",
    "legpush.missions": "mission",
    "legpush.cells": "kind of cell",
    "legpush.tasks": "term of a task",
    "legpush.loggers": "logger",
    "legpush.callbacks": "callback",
}


LIBRARIES: Final[dict[str, str]] = {
    "ompl": "",
    "scipy": "",
    "mujoco": "",
    "numba": "",
    "imageio_ffmpeg": "",
    "matplotlib": "",
    "pyarrow": "",
    "safetensors": "",
    "gymnasium": "train",
    "onnx": "train",
    "pygame": "train",
    "stable_baselines3": "train",
    "tensorboard": "train",
    "torch": "train",
    "foxglove": "view",
    "trimesh": "view",
    "viser": "view",
    "websockets": "view",
    "ray": "ray",
    "submitit": "slurm",
    "optuna": "tune",
    "sqlalchemy": "tune",
    "wandb": "wandb",
}
"""Modules of the libraries that legpush installs, each with its extra; an empty text if no extra is needed. A host for
one process may lack those of the others."""


def why_not_loaded(error: BaseException) -> str:
    """Return why code of a user cannot be loaded: the module that it needs, or the error that it raised."""
    if not isinstance(error, ModuleNotFoundError) or not error.name:
        return f"{type(error).__name__}: {' '.join(str(error).split())}".removesuffix(": ")
    library = error.name.partition(".")[0]
    if library in LIBRARIES and sys.modules.get(library) is None:
        remedy = f"{installing(LIBRARIES[library])} installs it"
        return f"ModuleNotFoundError: it needs {library}, which is not installed; {remedy}"
    return f"ModuleNotFoundError: it needs the module {error.name}, which is not on the Python path"


def installing(extra: str) -> str:
    """Return the command that installs an extra of legpush, or without one, what every mission needs."""
    return f"pip install 'legpush[{extra}]'" if extra else "pip install legpush"


def is_address(text: str) -> bool:
    """Return whether a text is a `module:name`, which `load_address` imports; no other text is one."""
    module, _, name = text.partition(":")
    return bool(module and name) and text.split() == [text]


def load_address(address: str, expected: str) -> Any:
    """Import what `module:name` says; the module may also lie in the working directory.

    Raises:
        PluginError: It is no address, cannot be imported, or raises an error at that; says what was expected, and names
            the address.
    """
    if not is_address(address):
        raise PluginError(f"Expected {expected}, got {address!r}, which is no module:name without white space")
    module, _, name = address.partition(":")
    if os.getcwd() not in sys.path:
        sys.path.append(os.getcwd())
    try:
        return getattr(importlib.import_module(module), name)
    except (Exception, SystemExit) as error:
        raise PluginError(f"Expected {expected}, got {address!r} ({_why(error, module)})") from error


def _why(error: BaseException, module: str) -> str:
    """Return why a module cannot be imported."""
    if isinstance(error, ModuleNotFoundError) and error.name == module:
        return f"the module {module} is not on the Python path"
    return why_not_loaded(error)


def plugin_names(group: Group) -> tuple[str, ...]:
    """Return the names in a group, sorted."""
    return tuple(sorted({entry.name for entry in entry_points(group=group)}))


def plugin_values(group: Group, name: str) -> tuple[str, ...]:
    """Return what the entry points with this name refer to, as `module:attribute`, sorted; nothing is imported."""
    return tuple(sorted({entry.value for entry in entry_points(group=group, name=name)}))


def load_plugin(group: Group, name: str) -> Any:
    """Import the plug-in with this name in a group.

    Raises:
        PluginError: There is no such name, two packages use it, or it cannot be imported; names the package, and the
            extra that installs a missing library.
    """
    noun = _NOUNS[group]
    found = {entry.value: entry for entry in entry_points(group=group, name=name)}
    if not found:
        raise PluginError(f"Expected a {noun} ({', '.join(plugin_names(group)) or 'none is installed'}), got {name!r}")
    if len(found) > 1:
        packages = ", ".join(sorted(map(_package, found.values())))
        raise PluginError(f"Expected one {noun} called {name!r}, got {len(found)}, from {packages}")
    (entry,) = found.values()
    try:
        return entry.load()
    except ModuleNotFoundError as error:
        raise PluginError(
            f"The {noun} {name!r} of the package {_package(entry)} needs {error.name}, which is not installed"
            f"{_remedy(entry, error.name or '')}"
        ) from error
    except Exception as error:
        raise PluginError(
            f"The {noun} {name!r} of the package {_package(entry)} cannot be imported from {entry.value} "
            f"({type(error).__name__}: {error})"
        ) from error


def _package(entry: EntryPoint) -> str:
    return entry.dist.name if entry.dist is not None else "?"


def _remedy(entry: EntryPoint, module: str) -> str:
    """Return the command that installs the missing library, if an entry point of this package needs it."""
    library = module.partition(".")[0]
    if entry.extras:
        return f"; pip install '{_package(entry)}[{','.join(entry.extras)}]' installs it"
    return f"; {installing(LIBRARIES[library])} installs it" if library in LIBRARIES else ""
