"""What the picture of a mission is made of."""

from agent_proc.reporting.picture_parts import appeared, followed
from tests.agent.reporting.missions import blocked_mission, whole_mission


def test_a_path_is_given_up_that_an_obstacle_appeared_in_and_no_other() -> None:
    record, _ = blocked_mission()

    assert [given_up for _, given_up in followed(record)] == [True, False, False]
    assert [each.obstacle for each in appeared(record)] == [1, 2]
    assert not any(given_up for _, given_up in followed(whole_mission()[0]))
