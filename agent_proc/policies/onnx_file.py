"""A policy as a model in the format ONNX, which other programs run without legpush."""

from typing import Any

import numpy as np
import onnx
from numpy.typing import NDArray
from onnx import TensorProto, helper, numpy_helper

from agent_proc.policies.actor import Normalizer
from agent_proc.policies.folder import PolicyFolder, encode_card, widths

OPSET = 17
IR_VERSION = 8
"""Both are old enough for the runtimes of the last years."""
INPUT, OUTPUT = "observation", "action"


def encode_onnx(policy: PolicyFolder) -> bytes:
    """The model: from `observation` (batch, n), float32, not normalized, to `action` (batch, m), float32 or int64.

    Normalizing, clipping and the choice of discrete actions are part of it; the metadata has the card.
    """
    graph = _Graph()
    values = INPUT if policy.normalizer is None else graph.normalized(INPUT, policy.normalizer)
    actor = policy.actor()
    last = len(actor.layers) - 1
    for index, layer in enumerate(actor.layers):
        names = [graph.array(f"layers.{index}.weight", layer.weight), graph.array(f"layers.{index}.bias", layer.bias)]
        values = graph.node("Gemm", [values, *names], transB=1)
        if index < last:
            values = graph.node("Tanh" if actor.activation == "tanh" else "Relu", [values])
    kind = TensorProto.FLOAT
    match actor.output:
        case "clip":
            bounds = [graph.array("low", np.float32(-1.0)), graph.array("high", np.float32(1.0))]
            graph.node("Clip", [values, *bounds], OUTPUT)
        case "tanh":
            graph.node("Tanh", [values], OUTPUT)
        case "argmax":
            kind = TensorProto.INT64
            graph.choices(values, actor.choices)
    n_seen = widths(policy.card)[0]
    n_done = len(actor.choices) or widths(policy.card)[-1]
    whole = helper.make_graph(
        graph.nodes,
        "policy",
        [helper.make_tensor_value_info(INPUT, TensorProto.FLOAT, ["batch", n_seen])],
        [helper.make_tensor_value_info(OUTPUT, kind, ["batch", n_done])],
        graph.arrays,
    )
    model = helper.make_model(
        whole, producer_name="legpush", ir_version=IR_VERSION, opset_imports=[helper.make_opsetid("", OPSET)]
    )
    helper.set_model_props(model, {"card": encode_card(policy.card).decode()})
    onnx.checker.check_model(model, full_check=True)
    content: bytes = model.SerializeToString(deterministic=True)
    return content


class _Graph:
    """The nodes of a model and the arrays in it."""

    def __init__(self) -> None:
        self.nodes: list[Any] = []
        self.arrays: list[Any] = []

    def array(self, name: str, values: Any) -> str:
        """Add an array, and return its name."""
        self.arrays.append(numpy_helper.from_array(np.asarray(values), name))
        return name

    def node(self, operator: str, inputs: list[str], output: str | None = None, **attributes: Any) -> str:
        """Add a node, and return the name of its output."""
        output = output or f"{operator.lower()}_{len(self.nodes)}"
        self.nodes.append(helper.make_node(operator, inputs, [output], **attributes))
        return output

    def normalized(self, values: str, normalizer: Normalizer) -> str:
        """Normalize in float64, as NumPy does."""
        scale: NDArray[np.float64] = np.sqrt(normalizer.variance + normalizer.epsilon)
        precise = self.node("Cast", [values], to=TensorProto.DOUBLE)
        centred = self.node("Sub", [precise, self.array("mean", normalizer.mean)])
        scaled = self.node("Div", [centred, self.array("scale", scale)])
        bounds = [self.array(name, np.float64(sign * normalizer.clip)) for name, sign in (("least", -1), ("most", 1))]
        return self.node("Cast", [self.node("Clip", [scaled, *bounds])], to=TensorProto.FLOAT)

    def choices(self, values: str, choices: tuple[int, ...]) -> None:
        """Choose the index of the largest value in each group."""
        parts = [f"group_{index}" for index in range(len(choices))]
        sizes = self.array("sizes", np.array(choices, dtype=np.int64))
        self.nodes.append(helper.make_node("Split", [values, sizes], parts, axis=1))
        chosen = [self.node("ArgMax", [part], axis=1, keepdims=1) for part in parts]
        self.node("Concat", chosen, OUTPUT, axis=1)
