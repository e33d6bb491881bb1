"""Equal numbers, equal states, equal CRCs."""

from legpush.realism.reality import Reality
from legpush.scene.scenario import Scenario
from sim_proc.physics.physics import Physics
from sim_proc.physics.state_crc import crc_of_numbers
from tests.robots import ROBOT


def test_an_ideal_episode_has_the_crc_of_the_robot_alone() -> None:
    assert crc_of_numbers(ROBOT, Reality(seed=3)) == crc_of_numbers(ROBOT, Reality())
    assert crc_of_numbers(ROBOT, Reality(motor_strength=0.9)) != crc_of_numbers(ROBOT, Reality())


def test_commands_that_wait_are_part_of_the_state(at_the_box: Scenario) -> None:
    places = at_the_box.start.pose(), at_the_box.box.pose.pose()
    crcs = {
        Physics(at_the_box, *places, Reality(command_latency_s=latency_s)).state_crc()
        for latency_s in (0.0, 0.02, 0.04)
    }
    assert len(crcs) == 3
