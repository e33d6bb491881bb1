"""A window that shows the frames of an environment."""

import numpy as np
import pygame
from numpy.typing import NDArray

from legpush.errors import ConfigError


class Window:
    """A window of pygame."""

    def __init__(self, size: tuple[int, int], fps: float) -> None:
        """`size` is width and height in pixels, `fps` the highest rate of frames.

        Raises:
            ConfigError: There is no display.
        """
        self._fps = fps
        pygame.display.init()
        try:
            self._surface = pygame.display.set_mode(size)
        except pygame.error as error:
            raise ConfigError(f"Expected a display for the render mode human, got none ({error})") from error
        pygame.display.set_caption("legpush")
        self._clock = pygame.time.Clock()

    def show(self, frame: NDArray[np.uint8]) -> None:
        """Show a frame, (height, width, 3), and wait so that the rate is kept."""
        pygame.surfarray.blit_array(self._surface, frame.transpose(1, 0, 2))
        pygame.event.pump()
        pygame.display.flip()
        self._clock.tick(self._fps)

    def close(self) -> None:
        """Close the window."""
        pygame.display.quit()
