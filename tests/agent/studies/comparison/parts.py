"""A comparison of two contestants and the rivals, without episodes."""

from typing import Any

from agent_proc.studies.comparison.contestants import Contestant
from agent_proc.studies.comparison.outcome import Outcome, make_outcome
from legpush.scenarios.file import load_scenario

CONTESTANTS = (
    Contestant(label="learned", policies=("a", "b"), seeds=(1, 2)),
    Contestant(label="scripted", policies=("scripted",)),
    Contestant(label="constant", policies=("constant",), is_rival=True),
)
ERRORS_M = {"a": 0.003, "b": 0.009, "scripted": 0.006, "constant": 0.03}
N_STARTS = 12


def rows() -> list[dict[str, Any]]:
    """Two cases of twelve starts; the constant falls on one, and is out of cycles on another."""
    found: list[dict[str, Any]] = []
    for mass_kg in (0.1, 0.9):
        for seed in range(N_STARTS):
            for policy, error_m in ERRORS_M.items():
                fails = policy == "constant" and seed < 2
                found.append(
                    {
                        "policy": policy,
                        "box.mass_kg": mass_kg,
                        "seed": seed,
                        "ending": ("fell", "max_cycles")[seed] if fails else "done",
                        "success": not fails,
                        "position_error_m": error_m * (1.0 + 0.1 * (seed % 3)) * (2.0 if mass_kg == 0.9 else 1.0),
                        "angle_error_deg": 0.1,
                        "n_cycles": 20 + seed,
                        "simulated_s": 60.0,
                        "decision_cpu_s": 1e-4,
                    }
                )
    return found


def outcome() -> Outcome:
    """What comes out of these rows."""
    goal = load_scenario("push").goal
    return make_outcome(rows(), CONTESTANTS, "scripted", (0.0, 0.6, 1.0, -0.5), ["box.mass_kg"], goal)
