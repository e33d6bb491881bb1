"""Pushing as a Gymnasium environment: one step is one push cycle, one episode is a box and its goal."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from math import degrees
from typing import Any

import gymnasium
import numpy as np
from msgspec import Struct
from numpy.typing import NDArray

from agent_proc.frames.push_view import NOTHING_FELT, PushView, push_view, pushed_state
from agent_proc.learning.random_state import Pcg64State, set_state, state_of
from agent_proc.learning.rendering import FRAME_SIZE, Rendering, RenderMode
from agent_proc.policies.sb3.spaces import action_space, observation_space
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.task.action import to_push
from agent_proc.task.config import TaskConfig
from agent_proc.task.drawn import drawn_scenario
from agent_proc.task.episode import earned, episode_ending
from agent_proc.task.observed import observe
from agent_proc.task.reset_options import read_options
from agent_proc.task.rooms import refuse_missions
from agent_proc.task.term import EpisodeEnding, PushStep
from agent_proc.walking.around_box import can_push, walk_to_face
from legpush.errors import ConfigError, DivergedError, MotionError
from legpush.lockstep.local import LocalWorld
from legpush.lockstep.world import SteppingWorld
from legpush.messages.poses import as_seen, planar_pose
from legpush.messages.stepping import Motion, Outcome, Push, Reset
from legpush.scene.faces import FACES, pushed_box
from legpush.scene.names import Face


class EnvSnapshot(Struct, frozen=True, kw_only=True, forbid_unknown_fields=True):
    """An environment in the middle of an episode, from which another process can continue it bit for bit."""

    generator: Pcg64State
    """State of the generator from which later episodes are drawn."""
    reset: Reset
    pushes: tuple[Push, ...]
    state_crc: int


class PushEnv(gymnasium.Env[NDArray[Any], NDArray[Any]]):
    """Push the box of a scenario to its goal.

    `terminated`: the robot fell, the box is out of its reach, a push was refused, or a rule of the task ends the
    episode. `truncated`: after `max_steps`. The `info` of a step holds the terms of its reward by name under
    `reward_terms`, `is_success`, `fell`, `position_error_m`, `angle_error_deg` and, at the end, `ending`.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array", "human"], "render_fps": 4}  # noqa: RUF012 - Gymnasium declares it so

    def __init__(
        self,
        task: TaskConfig,
        world: SteppingWorld,
        render_mode: RenderMode | None = None,
        frame_size: tuple[int, int] = FRAME_SIZE,
    ) -> None:
        """Make an environment that pushes in `world`, which no other environment may step.

        Raises:
            ConfigError: Another environment steps the same simulator in this process, the render mode is unknown, or
                an episode of the task is a whole mission.
        """
        refuse_missions(task.random_room)
        self.task = task
        self.render_mode = render_mode
        self._rendering = None if render_mode is None else Rendering(render_mode, frame_size, self.metadata)
        self.action_space = action_space(task)
        self.observation_space = observation_space(task)
        self._world = world
        self._claim()
        self._episode: _Episode | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin an episode, drawn from the generator that the last `seed` initialized.

        For this episode, the option `scenario_seed` replaces the drawn seed, and `scenario` the drawn scenario.

        Raises:
            ConfigError: An option is unknown or cannot be used, or another environment steps the simulator since
                `close`.
            ScenarioError: The option `scenario` names one that cannot be used.
        """
        given = read_options(options)
        super().reset(seed=seed)
        drawn_seed = int(self.np_random.integers(2**32))
        drawn = drawn_scenario(self.task.domain, self.task.scenario, self.np_random)
        scenario = drawn if given.scenario is None else given.scenario
        scenario_seed = drawn_seed if given.scenario_seed is None else given.scenario_seed
        episode = self._episode = self._begin(Reset(scenario=scenario, seed=scenario_seed))
        return observe(self.task, episode.seen), {"scenario_seed": scenario_seed, **_errors(episode.view)}

    def step(self, action: NDArray[Any]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Carry out one push cycle.

        Raises:
            ConfigError: There is no episode, it is over, or the action is not in its space.
        """
        episode = self._going_on()
        before = episode.view
        push = to_push(action, self.task, episode.seen)
        ending: EpisodeEnding | None
        try:
            episode.advance(push, self._carry_out(push, episode))
            ending = episode_ending(self.task, episode.first, episode.view, len(episode.pushes))
        except MotionError:
            # The robot stands where it stood: the simulator refuses a push before it begins.
            ending = "refused"
        episode.over = ending is not None
        step = PushStep(first=episode.first, before=before, after=episode.view, ending=ending)
        terms = earned(self.task, step)
        self._world.tell_reward(terms)
        info: dict[str, Any] = {"reward_terms": terms, "is_success": ending == "success", **_errors(episode.view)}
        if ending is not None:
            info["ending"] = ending
        truncated = ending == "max_steps"
        observation = observe(self.task, episode.seen)
        return observation, sum(terms.values()), episode.over and not truncated, truncated, info

    def close(self) -> None:
        """End the episode and give up the simulator, so that another environment may step it."""
        self._episode = None
        if self._rendering is not None:
            self._rendering.close()
        if isinstance(self._world, LocalWorld):
            self._world.release(self)

    def render(self) -> NDArray[np.uint8] | None:
        """Return the present state as a picture, (height, width, 3), in the mode `rgb_array`.

        In the mode `human`, a window shows it after every reset and step, and this returns None. Without a mode, too.

        Raises:
            ConfigError: There was no reset, or nothing can be drawn here; says why.
        """
        return None if self._rendering is None else self._rendering.picture()

    @property
    def view(self) -> PushView:
        """The present state, as a policy sees it.

        Raises:
            ConfigError: There is no episode.
        """
        if self._episode is None:
            raise ConfigError("Expected a reset first: there is no episode")
        return self._episode.seen

    def snapshot(self) -> EnvSnapshot:
        """The state from which `restore` continues.

        Raises:
            ConfigError: There is no episode, or it is over.
        """
        episode = self._going_on()
        return EnvSnapshot(
            generator=state_of(self.np_random),
            reset=episode.reset,
            pushes=tuple(episode.pushes),
            state_crc=episode.outcome.state_crc,
        )

    def restore(self, snapshot: EnvSnapshot) -> NDArray[np.float32]:
        """Continue from a snapshot by repeating its episode up to there; returns the observation.

        Raises:
            DivergedError: The repeated episode leads to another state.
        """
        super().reset(seed=0)
        set_state(self.np_random, snapshot.generator)
        episode = self._episode = self._begin(snapshot.reset)
        for push in snapshot.pushes:
            episode.advance(push, self._carry_out(push, episode))
        state_crc = episode.outcome.state_crc
        if state_crc != snapshot.state_crc:
            raise DivergedError(
                f"Expected state {snapshot.state_crc:08x} after {len(snapshot.pushes)} pushes of a saved episode, got "
                f"{state_crc:08x}: the simulator computes something else"
            )
        return observe(self.task, episode.seen)

    def _claim(self) -> None:
        if isinstance(self._world, LocalWorld):
            self._world.claim(self)

    def _step(self, motion: Motion) -> Outcome:
        outcome = self._world.step(motion)
        if self._rendering is not None:
            self._rendering.note(motion, outcome)
        return outcome

    def _carry_out(self, push: Push, episode: "_Episode") -> Outcome:
        """Push, after a walk to the face if the robot is at another one; a robot that misses it does not push."""
        if push.face == episode.seen.face:
            return self._step(push)
        outcome = walk_to_face(self._step, episode.reset.scenario, episode.outcome, push.face)
        scenario, world = episode.reset.scenario, outcome.world
        return self._step(push) if not world.fallen and can_push(as_seen(world), scenario, push.face) else outcome

    def _begin(self, reset: Reset) -> "_Episode":
        self._claim()
        outcome = self._step(reset)
        view = push_view(outcome.world, reset.scenario)
        seen = push_view(as_seen(outcome.world), reset.scenario)
        box = reset.scenario.box
        estimates = {face: PushEstimate(pushed_box(box, face)) for face in FACES} if self.task.feels_box else {}
        return _Episode(reset=reset, first=view, view=view, seen=seen, outcome=outcome, estimates=estimates)

    def _going_on(self) -> "_Episode":
        if self._episode is None or self._episode.over:
            raise ConfigError("Expected a reset before this step: there is no episode, or it is over")
        return self._episode


@dataclass
class _Episode:
    """The present episode."""

    reset: Reset
    first: PushView
    """The view after the reset."""
    view: PushView
    """The present view of everything as it is, by which rewards and endings are judged."""
    seen: PushView
    """The present view as it is perceived: what the policy sees."""
    outcome: Outcome
    """The last one."""
    estimates: Mapping[Face, PushEstimate]
    """What the pushes at each face have shown of the box; empty if the task does not ask for it."""
    pushes: list[Push] = field(default_factory=list)
    over: bool = False

    def advance(self, push: Push, outcome: Outcome) -> None:
        """Add a push and its outcome."""
        self.pushes.append(push)
        self.outcome, scenario = outcome, self.reset.scenario
        seen = as_seen(outcome.world)
        felt = NOTHING_FELT
        if self.estimates:
            estimate = self.estimates[push.face]
            before, after = (planar_pose(pushed_state(box, push.face)) for box in (self.seen.world.box, seen.box))
            estimate.learn(before, push, after)
            felt = estimate.felt
        self.view = push_view(outcome.world, scenario, felt, push.face)
        self.seen = push_view(seen, scenario, felt, push.face)


def _errors(view: PushView) -> dict[str, Any]:
    return {
        "fell": view.fallen,
        "position_error_m": view.error.position_m,
        "angle_error_deg": degrees(view.error.angle_rad),
    }
