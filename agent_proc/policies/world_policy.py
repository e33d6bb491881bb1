"""An adapter for policies that decide from the state of the world and a scenario, as those of users may."""

import inspect
from typing import Any, Protocol

from msgspec.structs import replace

from agent_proc.frames.push_view import PushView
from agent_proc.policies.policy import Policy
from legpush.errors import PolicyError
from legpush.messages.stepping import Push, WorldState
from legpush.scene.scenario import Scenario


class WorldPolicy(Protocol):
    """Chooses push cycles at the rear face of the box; equal states and scenarios have to give equal choices."""

    def decide(self, world: WorldState, scenario: Scenario) -> Push | None:
        """The next push cycle, or None if the box is at the scenario's goal or pushing cannot improve it."""


class WorldPolicyAdapter:
    """A `WorldPolicy` as a `Policy`."""

    def __init__(self, policy: WorldPolicy) -> None:
        self._policy = policy

    def decide(self, view: PushView) -> Push | None:
        """Ask about a world whose box has the pushed face at its rear, and whose goal is that of the view."""
        world = replace(view.world, box=view.box_state)
        return self._policy.decide(world, replace(view.scenario, box=view.box, goal=view.goal))


class GuardedPolicy:
    """A policy of the user's: an exception in it becomes a `PolicyError` that names it."""

    def __init__(self, policy: Policy, name: str) -> None:
        self._policy = policy
        self._name = name
        self.task = getattr(policy, "task", None)
        """The task that it was trained on, if it says so."""

    def decide(self, view: PushView) -> Push | None:
        """Ask the policy.

        Raises:
            PolicyError: The policy raised an exception, or returned something else than a push or None.
        """
        try:
            push = self._policy.decide(view)
        except Exception as error:
            raise PolicyError(
                f"{self._name}: `decide` raised {type(error).__name__} at tick {view.world.tick}: {error}"
            ) from error
        if push is not None and not isinstance(push, Push):
            raise PolicyError(f"{self._name}: expected `decide` to return a Push or None, got {type(push).__name__}")
        return push


def as_policy(policy: Any) -> Policy | None:
    """The object itself if its `decide` takes a view, an adapter if it takes a world and a scenario, None otherwise."""
    decide = getattr(policy, "decide", None)
    if not callable(decide):
        return None
    try:
        signature = inspect.signature(decide)
    except ValueError:  # Compiled code need not have one.
        return WorldPolicyAdapter(policy)
    if _accepts(signature, 2):
        return WorldPolicyAdapter(policy)
    if _accepts(signature, 1):
        taking_a_view: Policy = policy
        return taking_a_view
    return None


def _accepts(signature: inspect.Signature, n_arguments: int) -> bool:
    """Whether a function can be called with this many positional arguments."""
    try:
        signature.bind(*[None] * n_arguments)
    except TypeError:
        return False
    return True
