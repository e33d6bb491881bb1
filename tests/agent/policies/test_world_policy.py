"""The adapter for policies that decide from a world and a scenario."""

from math import degrees

import pytest
from msgspec.structs import replace

from agent_proc.frames.push_view import PushView, push_view, pushed_state
from agent_proc.policies.scripted import ScriptedPolicy
from agent_proc.policies.world_policy import WorldPolicyAdapter, as_policy
from legpush.geometry import Pose2, wrap_angle
from legpush.messages.poses import planar_pose
from legpush.messages.stepping import Push, WorldState
from legpush.scene.faces import FACES, pushed_box, pushed_pose
from legpush.scene.names import Face
from legpush.scene.scenario import Box, Goal, PoseDeg, Scenario
from tests.agent.fake_world import make_scenario, make_state

SCENARIO = make_scenario(box=Box(pose=PoseDeg(x_m=6.0, y_m=3.0, yaw_deg=0.0), size_m=(0.3, 0.6, 0.4)))
WORLD = make_state(Pose2(x_m=5.0, y_m=3.0, yaw_rad=0.1), Pose2(x_m=6.0, y_m=3.1, yaw_rad=0.2), tick=17)
TARGET = Goal(pose=PoseDeg(x_m=6.5, y_m=3.3, yaw_deg=100.0), position_tolerance_m=0.04)
PUSH = Push(w1=0.5, w2=0.5, leg="FL", depth_m=0.05)


class Asked:
    """Keeps what it is asked."""

    def __init__(self) -> None:
        self.about: list[tuple[WorldState, Scenario]] = []

    def decide(self, world: WorldState, scenario: Scenario) -> Push | None:
        self.about.append((world, scenario))
        return PUSH


def test_a_box_at_its_rear_face_is_asked_about_as_it_is() -> None:
    asked = Asked()

    push = WorldPolicyAdapter(asked).decide(push_view(WORLD, SCENARIO))

    assert push is PUSH
    assert asked.about == [(WORLD, SCENARIO)]


@pytest.mark.parametrize("face", FACES)
def test_another_face_is_asked_about_as_the_rear_one_of_a_box_with_another_goal(face: Face) -> None:
    asked = Asked()
    view = PushView(
        world=WORLD,
        scenario=SCENARIO,
        box=pushed_box(SCENARIO.box, face),
        box_state=pushed_state(WORLD.box, face),
        goal=TARGET,
    )

    WorldPolicyAdapter(asked).decide(view)

    ((world, scenario),) = asked.about
    seen, expected = planar_pose(world.box), pushed_pose(planar_pose(WORLD.box), face)
    assert degrees(wrap_angle(seen.yaw_rad - expected.yaw_rad)) == pytest.approx(0.0)
    assert scenario.box.size_m == ((0.6, 0.3, 0.4) if face in ("left", "right") else (0.3, 0.6, 0.4))
    assert scenario.goal == TARGET
    assert replace(world, box=WORLD.box) == WORLD
    assert replace(scenario, box=SCENARIO.box, goal=SCENARIO.goal) == SCENARIO


def test_the_number_of_arguments_tells_what_a_policy_is_asked_about() -> None:
    scripted = ScriptedPolicy()

    assert as_policy(scripted) is scripted
    assert isinstance(as_policy(Asked()), WorldPolicyAdapter)
    assert as_policy(object()) is None


def test_a_policy_that_takes_any_arguments_is_asked_about_a_world() -> None:
    class Any:
        def decide(self, *arguments: object) -> Push | None:
            return PUSH if len(arguments) == len(("world", "scenario")) else None

    policy = as_policy(Any())

    assert policy is not None
    assert policy.decide(push_view(WORLD, SCENARIO)) is PUSH


def test_compiled_code_without_a_signature_is_asked_about_a_world() -> None:
    class Compiled:
        decide = staticmethod(max)

    assert isinstance(as_policy(Compiled()), WorldPolicyAdapter)
