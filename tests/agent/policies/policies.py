"""A card and random weights for policies."""

from itertools import pairwise

import numpy as np

from agent_proc.policies.actor import Layer
from agent_proc.policies.card import Card, Check, CurvePoint
from agent_proc.policies.reach import Reach
from agent_proc.profiles.profile import load_profile
from tests.agent.fake_world import scenario_at_station
from tests.agent.tasks import tuned

CHECK = Check(step=64, seeds=(1, 2), success_rate=0.5, position_error_m=0.02, angle_error_deg=1.5, falls=0, cycles=20.0)
CARD = Card(
    command="legpush train --seed 7",
    task=tuned(scenario=scenario_at_station()),
    profile=load_profile("tuned"),
    seed=7,
    steps=64,
    n_simulators=2,
    versions={"numpy": "1"},
    check=CHECK,
    curve=(CurvePoint(step=3, episode_return=-1.5, length=3, success=False, position_error_m=0.4, angle_error_deg=9),),
    reach=Reach(beside_m=3.0, turned_deg=180.0),
    world="map",
    init="variable",
)


def random_layers(*widths: int) -> tuple[Layer, ...]:
    """Layers of these widths, from the observation to the action; the values stay near one."""
    rng = np.random.default_rng(0)
    return tuple(
        Layer(
            weight=(rng.normal(size=(n_out, n_in)) / n_in**0.5).astype(np.float32),
            bias=(rng.normal(size=n_out) / 10).astype(np.float32),
        )
        for n_in, n_out in pairwise(widths)
    )
