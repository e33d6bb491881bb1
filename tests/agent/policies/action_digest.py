"""The SHA-256 of many actions; `python -m tests.agent.policies.action_digest` prints it, and loads no other library."""

import hashlib

import numpy as np

from agent_proc.policies.actor import Actor, Float32s, Layer
from agent_proc.policies.folder import policy_path, read_policy, shipped_policies

N_OBSERVATIONS = 300


def observations(n_elements: int) -> Float32s:
    """Normalized observations, (N_OBSERVATIONS, n), also some at the clip."""
    drawn = np.random.default_rng(1).normal(0.0, 2.0, (N_OBSERVATIONS, n_elements))
    drawn[0], drawn[1] = 10.0, -10.0
    return drawn.astype(np.float32)


def digest_of_actions() -> str:
    """SHA-256 of the actions of the shipped policies, and of a network of the paper's size."""
    digest = hashlib.sha256()
    rng = np.random.default_rng(2)
    large = tuple(
        Layer(weight=(rng.normal(size=shape) / 20).astype(np.float32), bias=np.zeros(shape[0], dtype=np.float32))
        for shape in ((512, 25), (512, 512), (4, 512))
    )
    actors = [(read_policy(policy_path(name)).actor(), 8) for name in shipped_policies()]
    for actor, n_elements in [*actors, (Actor(large, "tanh", "clip"), 25)]:
        for seen in observations(n_elements):
            digest.update(actor.act(seen).tobytes())
    return digest.hexdigest()


if __name__ == "__main__":
    print(digest_of_actions())
