"""Weights as plain arrays in a file: what is written is read, and what does not fit is refused."""

import pickle
from typing import Any

import numpy as np
import pytest
from numpy.typing import NDArray
from safetensors.numpy import load, save

from agent_proc.policies.actor import Layer, Normalizer
from agent_proc.policies.weights_file import decode_weights, encode_weights
from legpush.errors import PolicyError

WIDTHS = (3, 5, 2)
LAYERS = (
    Layer(weight=np.arange(15, dtype=np.float32).reshape(5, 3), bias=np.ones(5, dtype=np.float32)),
    Layer(weight=np.arange(10, dtype=np.float32).reshape(2, 5), bias=np.zeros(2, dtype=np.float32)),
)
NORMALIZER = Normalizer(mean=np.array([0.1, 0.2, 0.3]), variance=np.ones(3), clip=7.0, epsilon=1e-7)
CONTENT = encode_weights(LAYERS, NORMALIZER)


def decoded(content: bytes, *, normalized: bool = True) -> tuple[tuple[Layer, ...], Normalizer | None]:
    return decode_weights(content, WIDTHS, normalized=normalized, where="policy")


def changed(**arrays: NDArray[Any] | None) -> bytes:
    """The file with some arrays replaced or, if None, without them; `__` in a name stands for a dot."""
    kept = load(CONTENT) | {name.replace("__", "."): array for name, array in arrays.items()}
    return save({name: array for name, array in kept.items() if array is not None})


def test_layers_and_normalizer_are_read_as_they_were_written() -> None:
    layers, normalizer = decoded(CONTENT)

    for layer, again in zip(LAYERS, layers, strict=True):
        np.testing.assert_array_equal(again.weight, layer.weight, strict=True)
        np.testing.assert_array_equal(again.bias, layer.bias, strict=True)
    assert normalizer is not None
    np.testing.assert_array_equal(normalizer.mean, NORMALIZER.mean, strict=True)
    np.testing.assert_array_equal(normalizer.variance, NORMALIZER.variance, strict=True)
    assert (normalizer.clip, normalizer.epsilon) == (7.0, 1e-7)


def test_a_policy_without_a_normalizer_has_none() -> None:
    assert decoded(encode_weights(LAYERS, None), normalized=False)[1] is None


def test_equal_weights_make_equal_files() -> None:
    assert encode_weights(LAYERS, NORMALIZER) == CONTENT == encode_weights(*decoded(CONTENT))


@pytest.mark.parametrize(
    "content", [b"", b"no arrays", CONTENT[:-1], CONTENT[: len(CONTENT) // 2], CONTENT + b"x", pickle.dumps(LAYERS)]
)
def test_other_bytes_are_refused(content: bytes) -> None:
    with pytest.raises(PolicyError, match="policy: expected weights in the format safetensors"):
        decoded(content)


@pytest.mark.parametrize(
    ("content", "message"),
    [
        (changed(layers__0__bias=None), r"expected the array layers\.0\.bias for the networks on the card, got none"),
        (changed(observation__mean=None), r"expected the array observation\.mean"),
        (changed(layers__2__bias=np.zeros(1)), r"got layers\.2\.bias as well"),
        (
            changed(layers__1__weight=np.zeros((2, 4), dtype=np.float32)),
            r"expected layers\.1\.weight of \(2, 5\) float32, as on the card, got \(2, 4\) float32",
        ),
        (changed(layers__1__bias=np.zeros(2)), r"got \(2,\) float64"),
        (changed(observation__variance=np.ones(4)), r"expected observation\.variance of \(3,\) float64"),
        (changed(layers__1__bias=np.array([0, np.nan], dtype=np.float32)), r"finite numbers in layers\.1\.bias"),
        (changed(observation__clip=np.array([0.0])), r"expected observation\.clip and every .* above 0"),
        (changed(observation__variance=-np.ones(3)), r"expected observation\.clip and every .* above 0"),
    ],
)
def test_arrays_that_do_not_fit_the_card_are_refused(content: bytes, message: str) -> None:
    with pytest.raises(PolicyError, match=message):
        decoded(content)


def test_the_normalizer_of_a_policy_that_needs_none_is_refused() -> None:
    with pytest.raises(PolicyError, match=r"got observation\.clip as well"):
        decoded(CONTENT, normalized=False)
