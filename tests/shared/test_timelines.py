"""From messages to timelines: the same whatever the order in which senders are heard, and nothing twice."""

import random
from collections.abc import Sequence

import numpy as np
import pytest
from msgspec.structs import replace

from legpush import codec
from legpush.messages.stepping import Action, Observation, Outcome, Push
from legpush.messages.tap import Copy, Origin, Reward, RewardTerm
from legpush.scenario import Scenario
from legpush.timeline import Timeline
from legpush.timelines import Timelines
from tests.shared.examples import MESSAGES, RESET, WORLD
from tests.shared.fakes import mission
from tests.shared.recordings import ACTIONS, AGENT, EPISODE, SIM, copy, header, traffic

Heard = list[tuple[str, Origin, Copy]]


def heard(actions: Sequence[Copy], answers: Sequence[Copy]) -> tuple[Heard, Heard]:
    return (
        [("sim/main/action", AGENT, each) for each in actions],
        [("sim/main/observation", SIM, each) for each in answers],
    )


def made(messages: Heard, scenario: Scenario | None = None) -> Timelines:
    timelines = Timelines()
    timelines.scenario = scenario
    for message in messages:
        timelines.take(*message)
    return timelines


def only(timelines: Timelines) -> Timeline:
    (timeline,) = timelines.episodes.values()
    return timeline


def numbers(timeline: Timeline) -> list[int]:
    return [step.number for step in timeline.steps]


@pytest.mark.parametrize("seed", range(5))
def test_any_order_that_keeps_each_sender_s_own_leads_to_the_same(seed: int) -> None:
    asked, answered = heard(*traffic(mission()))
    draw, mixed, left = random.Random(seed), [], [list(asked), list(answered)]
    while any(left):
        mixed.append(draw.choice([each for each in left if each]).pop(0))

    timeline, expected = only(made(mixed)), only(made(asked + answered))

    assert numbers(timeline) == list(range(len(asked)))
    assert timeline.steps == expected.steps
    np.testing.assert_array_equal(timeline.qpos, expected.qpos)


def test_a_message_that_comes_twice_counts_once() -> None:
    asked, answered = heard(*traffic(mission()))
    assert numbers(only(made(2 * asked + 2 * answered))) == list(range(len(asked)))


def test_after_a_step_that_is_missing_nothing_is_shown_until_it_comes() -> None:
    asked, answered = heard(*traffic(mission()))
    timelines = made(asked + answered[:5] + answered[6:])
    assert numbers(only(timelines)) == [0, 1, 2, 3, 4]
    timelines.take(*answered[5])
    assert numbers(only(timelines)) == list(range(len(asked)))


def test_whoever_comes_late_begins_where_he_came_with_the_scenario_that_he_was_told() -> None:
    asked, answered = heard(*traffic(mission()))
    late = asked[7:] + answered[7:]
    assert made(late).episodes == {}
    timeline = only(made(late, RESET.scenario))
    assert numbers(timeline) == list(range(7, len(asked)))
    assert timeline.scenario == RESET.scenario


def test_a_motion_that_was_refused_is_not_the_one_that_led_to_the_answer() -> None:
    refused, done = (Push(w1=0.1, w2=w2, leg="FL", depth_m=0.1) for w2 in (0.2, 0.3))

    def action(sequence: int, motion: Push) -> tuple[str, Origin, Copy]:
        message = Action(header=header(AGENT, sequence), episode=EPISODE, step=1, motion=motion)
        return "sim/main/action", AGENT, copy(ACTIONS, sequence, codec.encode(message))

    asked, answered = heard(*traffic([RESET]))
    refusal = replace(MESSAGES["refusal"], episode=EPISODE, step=1, cause="invalid")
    observation = Observation(
        header=header(SIM, 2),
        agent_incarnation=AGENT.incarnation,
        episode=EPISODE,
        step=1,
        outcome=Outcome(world=WORLD, state_crc=1),
    )
    answers = [
        ("sim/main/observation", SIM, copy("answers", sequence, codec.encode(message)))
        for sequence, message in ((1, refusal), (2, observation))
    ]

    timeline = only(made([*asked, *answered, *answers, action(1, refused), action(2, done)]))

    assert [step.motion for step in timeline.steps] == [RESET, done]


def test_rewards_find_their_step_whether_they_come_before_it_or_after() -> None:
    asked, answered = heard(*traffic(mission()))

    def reward(step: int, value: float) -> tuple[str, Origin, Copy]:
        message = Reward(
            header=header(AGENT, step),
            sim="main",
            episode=EPISODE,
            step=step,
            value=value,
            terms=(RewardTerm(name="position", value=value),),
        )
        return "sim/main/reward", AGENT, copy("rewards", step, codec.encode(message))

    timeline = only(made([reward(6, 0.5), *asked, *answered, reward(4, -1.0)]))

    assert timeline.rewards == {4: -1.0, 6: 0.5}


def test_bytes_that_are_no_message_are_counted_and_passed_over() -> None:
    asked, answered = heard(*traffic(mission()))
    timelines = made([("sim/main/action", AGENT, copy(ACTIONS, 0, b"\xc1")), *asked, *answered])
    assert timelines.n_unreadable == 1
    assert numbers(only(timelines)) == list(range(len(asked)))


def test_of_a_run_that_goes_on_for_long_the_newest_episodes_are_kept() -> None:
    timelines = Timelines()
    for number in range(6):
        asked, answered = heard(*traffic(mission(2)))
        for topic, origin, each in asked + answered:
            message = codec.decode(each.payload, Action if topic.endswith("action") else Observation)
            moved = replace(message, episode=EPISODE + number)
            later = replace(each, payload=codec.encode(moved), time_ns=each.time_ns + number * 10**12)
            timelines.take(topic, origin, later)
    timelines.keep(2)
    assert [number for _, number in timelines.episodes] == [EPISODE + 4, EPISODE + 5]
