"""What several kinds of cells share: scenarios with changes, and policies that a study file names."""

from collections.abc import Collection, Mapping
from functools import cache
from typing import Any, Final, cast

from agent_proc.policies.digest import policy_sha256
from agent_proc.policies.policy import Policy
from agent_proc.policies.registry import make_policy
from legpush.errors import ConfigError, PolicyError
from legpush.lockstep.simulator import Stepper
from legpush.options.learning import DEFAULT_WORLD
from legpush.plans.planner import MakePlans
from legpush.plugins import load_plugin, plugin_names
from legpush.policy_names import runs_code
from legpush.scenarios.changes import override
from legpush.scenarios.file import load_scenario
from legpush.scene.names import PlannerName, Steering
from legpush.scene.scenario import Scenario
from legpush.study.cells import Column

STATE_CRC: Final = Column(name="state_crc", unit="", about="CRC-32 of the simulator's last state")


def scenario_of(name: str, changes: Mapping[str, Any]) -> Scenario:
    """Load a scenario and change fields of it.

    Raises:
        ScenarioError: The scenario or a change cannot be used.
    """
    return override(_loaded(name), changes, "the scenario with the changes of the study")


_loaded = cache(load_scenario)


def path_changes(
    planner: PlannerName | None, steering: Steering | None, turning_radius_m: float | None
) -> dict[str, Any]:
    """Return the settings of paths that were given, as changes to a scenario."""
    given = {
        "planning.planner": planner,
        "planning.steering": steering,
        "planning.min_turning_radius_m": turning_radius_m,
    }
    return {path: value for path, value in given.items() if value is not None}


def sha256_of_policy(name: str, allowed: Collection[str]) -> str:
    """Return the SHA-256 of a policy that a study file names, if it is only data or was allowed.

    Raises:
        PolicyError: It runs code and was not allowed, or there is none.
    """
    if _is_code(name) and name not in allowed:
        raise PolicyError(f"The policy {name} runs code: repeat it with --policy {name} if you trust it")
    return _sha256(name)


_is_code = cache(runs_code)
"""Reading the entry points takes milliseconds, and a study asks for each of its cells."""
_sha256 = cache(policy_sha256)


def policy_with(name: str, sha256: str) -> Policy:
    """Make the policy of a resolved cell.

    Raises:
        PolicyError: Its files are others here, or it cannot be used.
    """
    return _shared_policy(name, sha256) if not _is_code(name) else _made_policy(name, sha256)


def require_policy(name: str, sha256: str) -> None:
    """Require the policy of a resolved cell.

    Raises:
        PolicyError: Its files are others here, or there is none.
    """
    if (got := policy_sha256(name)) != sha256:
        raise PolicyError(f"Expected the policy {name} with the SHA-256 {sha256[:16]}, got one with {got[:16]}")


def _made_policy(name: str, sha256: str) -> Policy:
    require_policy(name, sha256)
    # The head of the study has asked its user about code.
    return make_policy(name, trust_file=True)


_shared_policy = cache(_made_policy)
"""Policies of this package decide by what they see alone, so cells can share them; others get one for each cell."""


def new_simulator(name: str = DEFAULT_WORLD) -> Stepper:
    """Make a simulator: a plug-in by its name."""
    return cast(Stepper, load_plugin("legpush.simulators", name)())


def require_simulator(name: str) -> None:
    """Require the name of a plug-in.

    Raises:
        ConfigError: It is none.
    """
    if name not in (names := plugin_names("legpush.simulators")):
        raise ConfigError(f"Expected a world among {', '.join(names)}, got {name!r}")


def planner() -> MakePlans:
    """Return the planner as a function."""
    return cast(MakePlans, load_plugin("legpush.planners", "ompl"))
