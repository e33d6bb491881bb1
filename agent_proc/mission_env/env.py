"""Missions as a Gymnasium environment: one step is a push that the mission asks for, one episode is a mission."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from math import degrees
from typing import Any, Final, cast

import gymnasium
import numpy as np
from numpy.typing import NDArray

from agent_proc.endings import MissionResult
from agent_proc.frames.poses import box_error
from agent_proc.frames.push_view import PushView, push_view, pushed_state
from agent_proc.learning.rendering import FRAME_SIZE, Rendering, RenderMode
from agent_proc.mission.driven import DrivenMission
from agent_proc.mission_env.rooms import draw_mission, require_bounds
from agent_proc.mission_env.watched import WatchedWorld
from agent_proc.policies.sb3.spaces import action_space, observation_space
from agent_proc.task.action import to_push
from agent_proc.task.config import TaskConfig
from agent_proc.task.episode import earned, has_arrived
from agent_proc.task.observed import observe
from agent_proc.task.reset_options import read_options
from agent_proc.task.term import EpisodeEnding, PushStep
from legpush.errors import ConfigError, MotionError
from legpush.lockstep.world import World
from legpush.messages.poses import as_seen
from legpush.runs.reasons import Reason
from legpush.scene.scenario import Scenario

MOST_MISSIONS: Final = 20
"""Missions to draw, until one asks for a push."""
ENDINGS: Final[Mapping[Reason, EpisodeEnding]] = {
    "success": "success",
    "fell": "fell",
    "tolerance_missed": "missed",
    "motion_refused": "refused",
}
"""How an episode ends by the reason of its mission; `failed` for all others."""


class MissionEnv(gymnasium.Env[NDArray[Any], NDArray[Any]]):
    """Decide about the pushes of a mission, which walks, plans and docks by itself.

    A mission asks for pushes where its path is straight. Where the task has nothing left to do, the environment
    answers that for the policy, as a mission with a policy of the task does, and goes on to the next push.

    `terminated`: the mission is over. `truncated`: after `max_steps`. The `info` of a step holds the terms of its
    reward by name under `reward_terms`, `is_success`, `fell`, `position_error_m`, `angle_error_deg` and, at the end,
    `ending` and the `reason` of the mission. Rules of the task that give an episode up do not hold.
    """

    metadata: dict[str, Any] = {"render_modes": ["rgb_array", "human"], "render_fps": 4}  # noqa: RUF012 - Gymnasium declares it so

    def __init__(
        self,
        task: TaskConfig,
        world: World,
        render_mode: RenderMode | None = None,
        frame_size: tuple[int, int] = FRAME_SIZE,
    ) -> None:
        """Make an environment of missions in `world`, which no other environment may step and which can plan.

        Raises:
            ConfigError: An action of the task chooses the face, its scenario is smaller than its rooms, another
                environment steps the same simulator, or the render mode is unknown.
        """
        if task.changes_face:
            raise ConfigError("Expected a task for missions with `changes_face = false`: the path decides the face")
        require_bounds(task)
        self.task = task
        self.render_mode = render_mode
        self._rendering = None if render_mode is None else Rendering(render_mode, frame_size, self.metadata)
        self.action_space = action_space(task)
        self.observation_space = observation_space(task)
        self._world = WatchedWorld(world, self._rendering)
        self._claim()
        self._episode: _Episode | None = None

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[np.float32], dict[str, Any]]:
        """Begin a mission, drawn from the generator that the last `seed` initialized, and run it up to its first push.

        For this episode, the option `scenario_seed` replaces the drawn seed, and `scenario` the drawn scenario. A drawn
        mission that ends before it asks for a push is replaced by the next one.

        Raises:
            ConfigError: An option is unknown or cannot be used, the mission of the options asks for no push, or
                another environment steps the simulator since `close`.
            ScenarioError: The option `scenario` names one that cannot be used.
        """
        given = read_options(options)
        super().reset(seed=seed)
        self._drop()
        self._claim()
        for _ in range(1 if options else MOST_MISSIONS):
            drawn_seed = int(self.np_random.integers(2**32))
            scenario_seed = drawn_seed if given.scenario_seed is None else given.scenario_seed
            scenario = given.scenario or draw_mission(self.task, scenario_seed, self._world)
            mission = DrivenMission(self._world, scenario, scenario_seed)
            self._asked(mission)
            if mission.view is not None:
                self._episode = _Episode(scenario, mission, self._true(mission.view), mission.view)
                return observe(self.task, mission.view), {"scenario_seed": scenario_seed, **self._errors(scenario)}
            result = _result(mission)
        raise ConfigError(
            f"Expected a mission that asks for a push, got {scenario.name} with the seed {scenario_seed}, which ended "
            f"before: {result.reason}, {result.detail}"
        )

    def step(self, action: NDArray[Any]) -> tuple[NDArray[np.float32], float, bool, bool, dict[str, Any]]:
        """Answer the mission with a push, and run it up to the next one that it asks for.

        Raises:
            ConfigError: There is no episode, it is over, or the action is not in its space.
            LegpushError: Planner or simulator failed; the episode is over.
        """
        episode = self._going_on()
        asked, before = episode.view, self._true(episode.view)
        push = to_push(action, self.task, asked)
        try:
            episode.mission.answer(push)
            self._asked(episode.mission)
            episode.n_steps += 1
            ending = self._ending(episode)
        except BaseException:
            self._drop()
            raise
        terms = earned(self.task, PushStep(first=episode.first, before=before, after=self._true(asked), ending=ending))
        self._world.tell_reward(terms)
        info: dict[str, Any] = {
            "reward_terms": terms,
            "is_success": ending == "success",
            **self._errors(episode.scenario),
        }
        if ending is not None:
            episode.over = True
            info["ending"] = ending
        if episode.mission.view is not None:
            episode.view = episode.mission.view
        else:
            info["reason"] = _result(episode.mission).reason
            world = as_seen(self._world.outcome.world)
            episode.view = push_view(world, episode.scenario, asked.felt, asked.face)
        truncated = ending == "max_steps"
        if truncated:
            episode.mission.abandon()
        observation = observe(self.task, episode.view)
        return observation, sum(terms.values()), episode.over and not truncated, truncated, info

    def close(self) -> None:
        """End the mission and give up the simulator, so that another environment may step it."""
        self._drop()
        if self._rendering is not None:
            self._rendering.close()
        self._world.release(self)

    def render(self) -> NDArray[np.uint8] | None:
        """Return the present state as a picture, (height, width, 3), in the mode `rgb_array`.

        In the mode `human`, a window shows it after every motion, and this returns None. Without a mode, too.

        Raises:
            ConfigError: There was no reset, or nothing can be drawn here; says why.
        """
        return None if self._rendering is None else self._rendering.picture()

    @property
    def view(self) -> PushView:
        """What the mission asks about, as its policy sees it; after its end, the box and its goal.

        Raises:
            ConfigError: There is no episode.
        """
        return self._present().view

    @property
    def scenario(self) -> Scenario:
        """The scenario of the mission, such as the room that was drawn.

        Raises:
            ConfigError: There is no episode.
        """
        return self._present().scenario

    @property
    def state_crc(self) -> int:
        """CRC-32 of the simulator's last state.

        Raises:
            ConfigError: There is no episode.
        """
        self._present()
        return self._world.outcome.state_crc

    def _present(self) -> "_Episode":
        if self._episode is None:
            raise ConfigError("Expected a reset first: there is no episode")
        return self._episode

    def _going_on(self) -> "_Episode":
        if self._episode is None or self._episode.over:
            raise ConfigError("Expected a reset before this step: there is no episode, or it is over")
        return self._episode

    def _asked(self, mission: DrivenMission) -> None:
        """Run on to a push that the policy decides about: where its task has nothing left to do, it stops."""
        try:
            while mission.view is not None and has_arrived(self.task, mission.view):
                mission.answer(None)
        except BaseException:
            mission.abandon()
            raise

    def _ending(self, episode: "_Episode") -> EpisodeEnding | None:
        """How the episode ends with this step; None if it goes on.

        Raises:
            LegpushError: What ended the mission is no failure of the robot.
        """
        if episode.mission.view is not None:
            return "max_steps" if episode.n_steps >= self.task.max_steps else None
        return ENDINGS.get(_result(episode.mission).reason, "failed")

    def _true(self, view: PushView) -> PushView:
        """The present state as it is, by which rewards are judged, with the target of a view."""
        world = self._world.outcome.world
        return replace(view, world=world, box_state=pushed_state(world.box, view.face))

    def _errors(self, scenario: Scenario) -> dict[str, Any]:
        world = self._world.outcome.world
        error = box_error(world, scenario)
        return {
            "fell": world.fallen,
            "position_error_m": error.position_m,
            "angle_error_deg": degrees(error.angle_rad),
        }

    def _claim(self) -> None:
        self._world.claim(self)

    def _drop(self) -> None:
        """End the episode, with its mission."""
        if self._episode is not None:
            self._episode.mission.abandon()
        self._episode = None


@dataclass
class _Episode:
    """The present episode."""

    scenario: Scenario
    mission: DrivenMission
    first: PushView
    """The first view that the mission asked about, with everything as it is."""
    view: PushView
    """The present one, as the policy sees it."""
    n_steps: int = 0
    over: bool = False


def _result(mission: DrivenMission) -> MissionResult:
    """How a mission ended.

    Raises:
        LegpushError: What ended it is no failure of the robot.
    """
    result = cast(MissionResult, mission.result)
    if result.error is not None and not isinstance(result.error, MotionError):
        raise result.error
    return result
