"""Pictures of an environment: as arrays, or in a window."""

from typing import Any, Final, Literal, get_args

import numpy as np
from numpy.typing import NDArray

from legpush.errors import ConfigError
from legpush.messages.stepping import Motion, Outcome
from legpush.processes.frames import Frames

RenderMode = Literal["rgb_array", "human"]
FRAME_SIZE: Final = (640, 480)
"""Width and height of a picture in pixels."""
LARGEST: Final = (3840, 2160)


class Rendering:
    """Draws the world of one environment."""

    def __init__(self, mode: RenderMode, size: tuple[int, int], metadata: dict[str, Any]) -> None:
        """`metadata` has the rate of pictures, `render_fps`.

        Raises:
            ConfigError: The mode or the size cannot be used.
        """
        if mode not in get_args(RenderMode):
            raise ConfigError(f"Expected one of {', '.join(get_args(RenderMode))} for render_mode, got {mode!r}")
        if not all(16 <= pixels <= most for pixels, most in zip(size, LARGEST, strict=True)):
            raise ConfigError(f"Expected a width and a height from 16 to {LARGEST[0]} and {LARGEST[1]}, got {size}")
        self._mode = mode
        self._frames = Frames(*size)
        self._fps = metadata["render_fps"]
        self._window: Any = None

    def note(self, motion: Motion, outcome: Outcome) -> None:
        """Take the present state; a window shows it at once."""
        self._frames.note(motion, outcome)
        if self._mode == "human":
            self._show(self._frames.frame())

    def picture(self) -> NDArray[np.uint8] | None:
        """Return the present state as an array, (height, width, 3); None in a window, which shows it already.

        Raises:
            ConfigError: There is no state yet, or nothing can be drawn here.
        """
        return self._frames.frame() if self._mode == "rgb_array" else None

    def close(self) -> None:
        """End what draws and the window."""
        self._frames.close()
        if self._window is not None:
            self._window.close()
            self._window = None

    def _show(self, frame: NDArray[np.uint8]) -> None:
        if self._window is None:
            try:
                from agent_proc.learning.window import Window
            except ModuleNotFoundError as error:
                raise ConfigError(
                    "Expected pygame for the render mode human, which is not installed; pip install 'legpush[train]' "
                    "installs it"
                ) from error
            self._window = Window(self._frames.size, self._fps)
        self._window.show(frame)
