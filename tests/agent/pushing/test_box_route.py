"""Which stages the box is pushed along next, and how the robot comes to them."""

from math import degrees

from msgspec.structs import replace

from agent_proc.mission.mission import run_mission
from agent_proc.policies.scripted import ScriptedPolicy
from legpush.scene.reference import Arcs, Left, Straight, reference_curve
from legpush.scene.scenario import Goal, PoseDeg, PushSettings
from tests.agent.fake_world import FakeWorld, scenario_at_station


def test_a_reference_is_refused_for_a_guess_but_not_if_the_box_can_be_calibrated_first() -> None:
    reference = Arcs(radius_m=0.5, segments=(Straight(length_m=0.5), Left(angle_deg=60.0), Straight(length_m=0.5)))
    scenario = scenario_at_station()
    x_m, y_m, yaw_rad = reference_curve(reference, scenario.box.pose.pose())[-1].tolist()
    goal = Goal(pose=PoseDeg(x_m=x_m, y_m=y_m, yaw_deg=degrees(yaw_rad)))
    results = []
    for n_pushes in (0, 6):
        pushing = PushSettings(calibration_pushes=n_pushes)
        asked = replace(scenario, reference=reference, goal=goal, pushing=pushing)
        results.append(run_mission(FakeWorld(turn_scale=1.5), asked, 3, ScriptedPolicy()))

    assert (results[0].reason, results[0].n_push_cycles) == ("no_path", 0)
    assert results[1].success, results[1].detail
