"""Loggers and callbacks of other packages: an exception in one becomes an error that names it and its line."""

import inspect
import traceback
from collections.abc import Callable, Iterator
from contextlib import AbstractContextManager, contextmanager
from typing import Any

from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.logger import KVWriter

from legpush.errors import LegpushError, PluginError


class GuardedCallback(BaseCallback):
    """A callback of another package, which knows whether it ended the training."""

    def __init__(self, callback: BaseCallback, name: str) -> None:
        super().__init__()
        self.callback = callback
        self.name = name
        self.has_ended = False
        """Whether it asked the training to end."""

    def _init_callback(self) -> None:
        with self._told():
            self.callback.init_callback(self.model)

    def _on_training_start(self) -> None:
        with self._told():
            self.callback.on_training_start(self.locals, self.globals)

    def _on_rollout_start(self) -> None:
        with self._told():
            self.callback.on_rollout_start()

    def _on_step(self) -> bool:
        with self._told():
            goes_on = bool(self.callback.on_step())
        self.has_ended |= not goes_on
        return goes_on

    def _on_rollout_end(self) -> None:
        with self._told():
            self.callback.on_rollout_end()

    def _on_training_end(self) -> None:
        with self._told():
            self.callback.on_training_end()

    def update_child_locals(self, locals_: dict[str, Any]) -> None:
        """Give the callback the variables of the algorithm."""
        self.callback.update_locals(locals_)

    def _told(self) -> AbstractContextManager[None]:
        return told(f"callback {self.name!r}", type(self.callback))


class GuardedLog(KVWriter):
    """A logger of another package."""

    def __init__(self, log: KVWriter, name: str) -> None:
        self._log = log
        self._name = name

    def write(self, key_values: dict[str, Any], key_excluded: dict[str, tuple[str, ...]], step: int = 0) -> None:
        """Log the numbers of a step."""
        with told(f"logger {self._name!r}", type(self._log)):
            self._log.write(key_values, key_excluded, step)

    def close(self) -> None:
        """Close it."""
        with told(f"logger {self._name!r}", type(self._log)):
            self._log.close()


def made(make: Callable[..., Any], kind: type, noun: str, *arguments: Any) -> Any:
    """Make a logger or a callback, called `noun` in errors, which has to be of a `kind`.

    Raises:
        PluginError: What makes it fails, or makes something else.
    """
    with told(noun, make):
        result = make(*arguments)
    if not isinstance(result, kind):
        raise PluginError(f"The {noun}: expected a {kind.__name__} of Stable-Baselines3, got {type(result).__name__}")
    return result


@contextmanager
def told(noun: str, of: object) -> Iterator[None]:
    """Tell of an exception of something of another package, with its last line in the file that defines it.

    Raises:
        PluginError: There was one.
    """
    try:
        yield
    except LegpushError:
        raise
    except Exception as error:
        frames = traceback.extract_tb(error.__traceback__)
        at = next((frame for frame in reversed(frames) if frame.filename == _file(of)), frames[-1])
        raise PluginError(
            f"The {noun} failed at {at.filename}:{at.lineno} ({type(error).__name__}: {error})"
        ) from error


def _file(of: object) -> str | None:
    try:
        return inspect.getsourcefile(of)  # type: ignore[arg-type]
    except TypeError:
        return None
