"""Follows one stage of the box's path: a policy pushes it along straight stretches, the push model along arcs.

After each push the box is measured. Where the path ahead is straight, the policy decides, for a target on that line:
the end of the stage where the line leads there, else a point `LINE_AHEAD_M` ahead on it. On an arc, and just before
one, the next `HORIZON` pushes are predicted for every choice of legs, and the first push of the best choice is taken.
"""

from dataclasses import dataclass
from itertools import product
from math import degrees, radians
from typing import Final, Literal

import numpy as np
from msgspec.structs import replace

from agent_proc.frames.push_view import PushView, pushed_state
from agent_proc.policies.policy import Policy
from agent_proc.push_model.estimate import PushEstimate
from agent_proc.push_model.model import MIRROR
from agent_proc.pushing.stage import Deviation, Stage
from legpush.arrays import Floats
from legpush.geometry import Pose2
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import BoxState, Push, WorldState
from legpush.scene.conventions import FRONT_LEGS
from legpush.scene.faces import pushed_box
from legpush.scene.scenario import PoseDeg, Scenario

LINE_AHEAD_M: Final = 0.6
"""How far ahead on a straight stretch the policy's target is, unless that is where the stage ends."""
LEAST_LINE_M: Final = 0.12
"""A straight stretch that ends in an arc is pushed like the arc when no more than this is left of it."""
LAST_LINE_M: Final = 0.5
LAST_LEFT_M: Final = 0.05
LAST_TURN_RAD: Final = radians(5.0)
"""This near to the end of a stage, and to the line through it, the policy decides even where the path curves: it has
learned to correct such errors."""
HORIZON: Final = 4
FIRST_DEPTHS_M: Final = (0.05, 0.08)
LATER_DEPTH_M: Final = 0.05
LEFT_M: Final = 0.02
HEADING_RAD: Final = radians(4.0)
"""Scales of the lateral and heading deviation in the cost: 2 cm off costs as much as 4°."""
SLOW_COST: Final = 0.05
"""Cost of taking twice as many pushes to cover the same distance."""
USUAL_STEP_M: Final = 0.037
TUBE_M: Final = 0.10
TUBE_RAD: Final = radians(25.0)
"""A box that deviates more than this has left its path."""
SEARCH_AHEAD_M: Final = 0.5
"""How far ahead of its last place on the path the box is looked for."""
ENOUGH_M: Final = 0.015
"""A stage is over when no more than this is left of it, if it ends in an arc or another stage follows."""

StageEnding = Literal["done", "left_path"]


@dataclass(frozen=True, kw_only=True)
class Decision:
    """What to do next on the path: a push, or nothing more."""

    push: Push | None
    ending: StageEnding | None
    """Why there is no push."""
    deviation: Deviation


class Follower:
    """Follows one stage of the box's path."""

    def __init__(
        self, path: Stage, policy: Policy, scenario: Scenario, estimate: PushEstimate, *, is_last: bool = True
    ) -> None:
        """`estimate` learns from every push, whichever stage it belongs to. No other stage follows if `is_last`."""
        self._path = path
        self._policy = policy
        self._scenario = scenario
        self._estimate = estimate
        self._is_last = is_last
        self._at_m = 0.0
        self._open = scenario.pushing.composition == "open_loop"
        self._believed: Pose2 | None = None
        """In an open loop, where the box is by the push model: pose of the pushed frame."""
        self._firsts = list(product(FRONT_LEGS, FIRST_DEPTHS_M))
        sequences = list(product(self._firsts, product(FRONT_LEGS, repeat=HORIZON - 1)))
        self._mirrors = np.array([[MIRROR[first[0]], *(MIRROR[leg] for leg in legs)] for first, legs in sequences])
        self._depths = np.array([[first[1], *(LATER_DEPTH_M,) * (HORIZON - 1)] for first, _ in sequences])
        self._pushes = [first for first, _ in sequences]

    def decide(self, world: WorldState) -> Decision:
        """The next push, of the path's face."""
        box = pushed_state(world.box, self._path.face)
        if self._open and self._believed is not None:
            box = _level(self._believed, box.position_m[2])
        pose = planar_pose(box)
        deviation = self._path.deviation(pose, self._at_m, self._at_m + SEARCH_AHEAD_M)
        self._at_m = deviation.distance_m
        if not self._open and (abs(deviation.left_m) > TUBE_M or abs(deviation.heading_rad) > TUBE_RAD):
            return Decision(push=None, ending="left_path", deviation=deviation)
        target = self._target(pose)
        is_near = self._at_m > self._path.length_m - ENOUGH_M
        if is_near and (target is None or not self._is_last):
            push = None
        elif target is not None:
            push = self._policy.decide(self._view(world, box, target))
        else:
            push = self._on_arc(pose)
        if push is None:
            return Decision(push=None, ending="done", deviation=deviation)
        if self._open:
            self._believed = self._estimate.after(pose, push)
        return Decision(push=replace(push, face=self._path.face), ending=None, deviation=deviation)

    def _target(self, pose: Pose2) -> Pose2 | None:
        """Where the policy should push the box, pushed frame; None on an arc, where the push model decides."""
        line_ends_m = self._path.straight_until_m(self._at_m)
        if line_ends_m >= self._path.length_m or self._on_last_line(pose):
            return self._path.end
        if line_ends_m - self._at_m > LEAST_LINE_M:
            return self._path.pose(self._at_m) @ Pose2(x_m=LINE_AHEAD_M, y_m=0.0, yaw_rad=0.0)
        return None

    def _view(self, world: WorldState, box: BoxState, target: Pose2) -> PushView:
        """The box at a pose of the pushed frame, with the target as its goal."""
        pose = PoseDeg(x_m=target.x_m, y_m=target.y_m, yaw_deg=degrees(target.yaw_rad))
        return PushView(
            world=world,
            scenario=self._scenario,
            box=pushed_box(self._scenario.box, self._path.face),
            box_state=box,
            goal=replace(self._scenario.goal, pose=pose),
            felt=self._estimate.felt,
            face=self._path.face,
        )

    def _on_last_line(self, pose: Pose2) -> bool:
        """Whether the end of the stage is near, and nearly ahead."""
        left = self._path.end.inverse() @ pose
        near = self._path.length_m - self._at_m <= LAST_LINE_M and left.x_m < 0.0
        return near and abs(left.y_m) <= LAST_LEFT_M and abs(left.yaw_rad) <= LAST_TURN_RAD

    def _on_arc(self, pose: Pose2) -> Push:
        """The first push of the sequence that is predicted to stay nearest to the path."""
        start = np.array([pose.x_m, pose.y_m, pose.yaw_rad])
        poses: Floats = np.repeat(start[None], len(self._pushes), axis=0)
        costs = np.zeros(len(poses))
        reach_m = self._at_m + SEARCH_AHEAD_M + HORIZON * max(FIRST_DEPTHS_M)
        along = np.full(len(poses), self._at_m)
        for step in range(HORIZON):
            poses = self._estimate.push(poses, self._mirrors[:, step], self._depths[:, step])
            along, left, heading = self._path.deviations(poses, self._at_m, reach_m)
            costs += ((left / LEFT_M) ** 2 + (heading / HEADING_RAD) ** 2) / HORIZON
        progress = np.maximum(along - self._at_m, 1e-3)
        costs += SLOW_COST * HORIZON * USUAL_STEP_M / progress
        leg, depth_m = self._pushes[int(costs.argmin())]
        w1, w2 = self._estimate.curve
        return Push(w1=w1, w2=w2, leg=leg, depth_m=depth_m)


def _level(pose: Pose2, height_m: float) -> BoxState:
    """A level box whose centre is at this height."""
    half = pose.yaw_rad / 2
    orientation = (float(np.cos(half)), 0.0, 0.0, float(np.sin(half)))
    return BoxState(position_m=(pose.x_m, pose.y_m, height_m), orientation_wxyz=orientation)
