"""The network of a trained policy as plain arrays, which NumPy evaluates.

No product goes to BLAS, whose sums depend on the processor. Every sum adds the inputs in their order, so that equal
observations give equal actions, bit for bit, wherever NumPy computes the same `tanh`.
"""

from dataclasses import dataclass
from typing import Any, Final, Literal

import numpy as np
from numpy.typing import NDArray

from legpush.arrays import Floats

Activation = Literal["relu", "tanh"]
"""Follows every hidden layer."""
Output = Literal["clip", "tanh", "argmax"]
"""What makes an action of the last layer: its values clipped to [-1, 1], their hyperbolic tangent, or the index of the
largest value in each group of choices."""

Float32s = NDArray[np.float32]


@dataclass(frozen=True, kw_only=True, eq=False)
class Layer:
    """A layer: `weight @ x + bias`."""

    weight: Float32s
    """(n_out, n_in)."""
    bias: Float32s
    """(n_out,)."""


@dataclass(frozen=True, kw_only=True, eq=False)
class Normalizer:
    """Normalizes observations: `clip((observation - mean) / sqrt(variance + epsilon))`."""

    mean: Floats
    """(n,)."""
    variance: Floats
    """(n,)."""
    clip: float = 10.0
    epsilon: float = 1e-8

    def apply(self, observation: Float32s) -> Float32s:
        """The normalized observation, (n,), as in training."""
        scaled = (observation - self.mean) / np.sqrt(self.variance + self.epsilon)
        clipped: Float32s = np.clip(scaled, -self.clip, self.clip).astype(np.float32)
        return clipped


class Actor:
    """Computes the action of a policy without exploring."""

    def __init__(
        self, layers: tuple[Layer, ...], activation: Activation, output: Output, choices: tuple[int, ...] = ()
    ) -> None:
        """Make the network.

        Args:
            layers: From the observation to the action.
            activation: Function after each layer but the last.
            output: Function after the last layer.
            choices: With `argmax`: the number of values in each group, of which the last layer has the sum.
        """
        self.layers: Final = layers
        self.activation: Final = activation
        self.output: Final = output
        self.choices: Final = choices
        # Rows of a transposed weight belong to one input each: the sum over rows adds the inputs in order.
        self._columns = [np.ascontiguousarray(layer.weight.T) for layer in layers]

    def act(self, observation: Float32s) -> NDArray[Any]:
        """The action for a normalized observation, (n_in,): float32, or int64 with `argmax`."""
        last = len(self.layers) - 1
        values = observation
        for index, layer in enumerate(self.layers):
            values = np.add.reduce(self._columns[index] * values[:, None], axis=0) + layer.bias
            if index < last:
                values = np.tanh(values) if self.activation == "tanh" else np.maximum(values, np.float32(0.0))
        match self.output:
            case "clip":
                return np.clip(values, np.float32(-1.0), np.float32(1.0))
            case "tanh":
                return np.tanh(values)
            case "argmax":
                groups = np.split(values, np.cumsum(self.choices)[:-1])
                return np.array([group.argmax() for group in groups], dtype=np.int64)
