"""From messages to the history of a run: the same in whatever order senders are heard, and nothing twice."""

import random
from collections.abc import Sequence
from typing import Any

import numpy as np
import pytest
from msgspec.structs import replace

from legpush.history.run_history import RunHistory
from legpush.history.timeline import Timeline
from legpush.messages import codec
from legpush.messages.stepping import Action, Observation, Outcome, Push, Trace
from legpush.messages.telemetry import Copy, Origin, Reward, RewardTerm
from legpush.scene.scenario import Scenario
from tests.legpush.examples import MESSAGES, RESET, WORLD
from tests.legpush.fakes import mission
from tests.legpush.recording.recordings import ACTIONS, AGENT, EPISODE, SIM, copy, header, traffic

Heard = list[tuple[str, Origin, Copy]]


def heard(actions: Sequence[Copy], answers: Sequence[Copy]) -> tuple[Heard, Heard]:
    return (
        [("sim/main/action", AGENT, each) for each in actions],
        [("sim/main/observation", SIM, each) for each in answers],
    )


def made(messages: Heard, scenario: Scenario | None = None) -> RunHistory:
    history = RunHistory()
    history.scenario = scenario
    for message in messages:
        history.take_message(*message)
    return history


def only(history: RunHistory) -> Timeline:
    (timeline,) = history.episodes.values()
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
    history = made(asked + answered[:5] + answered[6:])
    assert numbers(only(history)) == [0, 1, 2, 3, 4]
    history.take_message(*answered[5])
    assert numbers(only(history)) == list(range(len(asked)))


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


def test_a_motion_that_was_refused_twice_as_it_was_sent_twice_is_one_motion() -> None:
    asked, answered = heard(*traffic(mission()))
    refused = Push(w1=0.1, w2=0.2, leg="FL", depth_m=0.1)
    action = Action(header=header(AGENT, 50), episode=EPISODE, step=3, motion=refused)
    refusal = replace(MESSAGES["refusal"], episode=EPISODE, step=3, cause="invalid")
    denied = ("sim/main/observation", SIM, copy("answers", 50, codec.encode(refusal)))

    timeline = only(
        made([("sim/main/action", AGENT, copy(ACTIONS, 50, codec.encode(action))), denied, denied, *asked, *answered])
    )

    assert numbers(timeline) == list(range(len(asked)))
    assert refused not in [step.motion for step in timeline.steps]


@pytest.mark.parametrize("lacking", [{"qpos": ((0.0,) * 25,)}, {"zmp_m": ()}, {"zmp_margin_m": (0.1,)}])
def test_an_answer_whose_trace_lacks_numbers_is_none(lacking: dict[str, Any]) -> None:
    asked, answered = heard(*traffic(mission()))
    topic, origin, last = answered[-1]
    message, point = codec.decode(last.payload, Observation), (0.0, 0.0, 0.0)
    trace = Trace(
        tick=(message.outcome.world.tick,),
        qpos=((0.0,) * 26,),
        roll_pitch_rad=((0.0, 0.0),),
        tips_m=((point,) * 4,),
        contact_forces_n=((point,) * 4,),
        com_m=(point,),
        zmp_m=((0.0, 0.0),),
        support_margin_m=(0.0,),
    )

    for each, n_unreadable in ((trace, 0), (replace(trace, **lacking), 1)):
        answer = replace(message, outcome=replace(message.outcome, trace=each))
        history = made([*asked, *answered[:-1], (topic, origin, replace(last, payload=codec.encode(answer)))])
        assert history.n_unreadable == n_unreadable
        assert len(only(history).steps) == len(asked) - n_unreadable


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
    history = made([("sim/main/action", AGENT, copy(ACTIONS, 0, b"\xc1")), *asked, *answered])
    assert history.n_unreadable == 1
    assert numbers(only(history)) == list(range(len(asked)))


def nth(number: int, messages: Heard) -> Heard:
    """The same as a later episode."""
    moved = []
    for topic, origin, each in messages:
        message = codec.decode(each.payload, Action if topic.endswith("action") else Observation)
        payload = codec.encode(replace(message, episode=EPISODE + number))
        moved.append((topic, origin, replace(each, payload=payload, time_ns=each.time_ns + number * 10**12)))
    return moved


def test_of_a_run_that_goes_on_for_long_the_newest_episodes_are_kept_and_the_one_that_is_held() -> None:
    history = RunHistory()
    asked, answered = heard(*traffic(mission(2)))
    for number in range(6):
        for message in nth(number, asked + answered):
            history.take_message(*message)
        history.take_message(
            "agent/main/status",
            AGENT,
            replace(
                asked[0][2],
                payload=codec.encode(MESSAGES["status"]),
                time_ns=asked[0][2].time_ns + number * 10**12 + 10**11,
            ),
        )
        if number == 0:
            history.held = only(history)
    span = history.span_ns(only_held(history))

    history.keep_newest(2)

    assert [number - EPISODE for _, number in history.episodes] == [0, 1, 4, 5]
    assert list(history.indices.values()) == [0, 1, 4, 5]
    assert history.span_ns(only_held(history)) == span
    assert [(said.time_ns - asked[0][2].time_ns) // 10**12 for said in history.said] == [0, 4, 5]
    history.held = None
    history.keep_newest(2)
    assert list(history.indices.values()) == [4, 5]


def only_held(history: RunHistory) -> Timeline:
    assert history.held is not None
    return history.held


def test_an_episode_that_has_just_begun_is_not_forgotten_with_old_ones() -> None:
    history = RunHistory()
    asked, answered = heard(*traffic(mission(2)))
    for number in range(2):
        for message in nth(number, asked + answered):
            history.take_message(*message)
    for message in nth(2, asked):
        history.take_message(*message)
    history.keep_newest(1)
    for message in nth(2, answered):
        history.take_message(*message)
    assert list(history.indices.values()) == [1, 2]


def test_of_an_episode_that_is_not_known_plans_are_sought_in_vain() -> None:
    asked, answered = heard(*traffic(mission()))
    history, other = made([]), only(made([*asked, *answered]))
    assert list(history.plans_of(other)) == []
