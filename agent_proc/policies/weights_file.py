"""The arrays of a policy as a file in the format safetensors, which holds numbers alone and runs no code."""

from collections.abc import Sequence
from itertools import pairwise
from typing import Any, Final

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError
from safetensors.numpy import load, save

from agent_proc.policies.actor import Layer, Normalizer
from legpush.errors import PolicyError

MEAN: Final = "observation.mean"
VARIANCE: Final = "observation.variance"
CLIP: Final = "observation.clip"
EPSILON: Final = "observation.epsilon"
"""Arrays of the normalizer, float64."""

Shapes = dict[str, tuple[tuple[int, ...], np.dtype[Any]]]
"""Shape and type of each array, by name."""


def encode_weights(layers: Sequence[Layer], normalizer: Normalizer | None) -> bytes:
    """The file: `layers.N.weight` (n_out, n_in) and `layers.N.bias` (n_out,), float32, and those of the normalizer."""
    arrays: dict[str, NDArray[Any]] = {}
    for index, layer in enumerate(layers):
        arrays[_weight(index)], arrays[_bias(index)] = layer.weight, layer.bias
    if normalizer is not None:
        arrays[MEAN], arrays[VARIANCE] = normalizer.mean, normalizer.variance
        arrays[CLIP], arrays[EPSILON] = np.array([normalizer.clip]), np.array([normalizer.epsilon])
    return save({name: np.ascontiguousarray(array) for name, array in arrays.items()})


def decode_weights(
    content: bytes, widths: Sequence[int], *, normalized: bool, where: str
) -> tuple[tuple[Layer, ...], Normalizer | None]:
    """Layers and normalizer in a file.

    Args:
        content: The file.
        widths: Number of observed elements, of units in each hidden layer, and of values of the last layer.
        normalized: Whether it has a normalizer.
        where: The file, for messages.

    Raises:
        PolicyError: It is something else, or its arrays have other names, shapes, types, or values that are not finite.
    """
    try:
        arrays = load(content)
    except (SafetensorError, KeyError, TypeError, ValueError, AttributeError) as error:
        raise PolicyError(f"{where}: expected weights in the format safetensors ({error})") from error
    expected = _shapes(widths, normalized)
    if missing := sorted(expected.keys() - arrays.keys()):
        raise PolicyError(f"{where}: expected the array {missing[0]} for the networks on the card, got none")
    if unknown := sorted(arrays.keys() - expected.keys()):
        raise PolicyError(f"{where}: expected the arrays of the networks on the card, got {unknown[0]} as well")
    for name, (shape, kind) in expected.items():
        array = arrays[name]
        if (array.shape, array.dtype) != (shape, kind):
            raise PolicyError(
                f"{where}: expected {name} of {shape} {kind}, as on the card, got {array.shape} {array.dtype}"
            )
        if not np.isfinite(array).all():
            raise PolicyError(f"{where}: expected finite numbers in {name}")
    layers = tuple(Layer(weight=arrays[_weight(n)], bias=arrays[_bias(n)]) for n in range(len(widths) - 1))
    return layers, _normalizer(arrays, where) if normalized else None


def _normalizer(arrays: dict[str, NDArray[Any]], where: str) -> Normalizer:
    clip, epsilon = float(arrays[CLIP][0]), float(arrays[EPSILON][0])
    if clip <= 0.0 or not (arrays[VARIANCE] + epsilon > 0.0).all():
        raise PolicyError(f"{where}: expected {CLIP} and every {VARIANCE} + {EPSILON} above 0")
    return Normalizer(mean=arrays[MEAN], variance=arrays[VARIANCE], clip=clip, epsilon=epsilon)


def _shapes(widths: Sequence[int], normalized: bool) -> Shapes:
    single, double = np.dtype(np.float32), np.dtype(np.float64)
    shapes: Shapes = {}
    for index, (n_in, n_out) in enumerate(pairwise(widths)):
        shapes[_weight(index)], shapes[_bias(index)] = ((n_out, n_in), single), ((n_out,), single)
    if normalized:
        shapes |= {MEAN: ((widths[0],), double), VARIANCE: ((widths[0],), double)}
        shapes |= {CLIP: ((1,), double), EPSILON: ((1,), double)}
    return shapes


def _weight(index: int) -> str:
    return f"layers.{index}.weight"


def _bias(index: int) -> str:
    return f"layers.{index}.bias"
