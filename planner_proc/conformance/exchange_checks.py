"""Checks of requests and answers, one function each, which returns what is wrong, or an empty text."""

from itertools import pairwise
from math import nan
from typing import Final

import msgpack
from msgspec.structs import replace

from legpush.bus.bus import Bus
from legpush.messages.planning import PlanResult
from legpush.scene.plan_settings import Anytime
from planner_proc.conformance.bench import EASY, REMARK, START_S, Bench
from planner_proc.conformance.cases import huge, query, room
from planner_proc.conformance.client import RUN, Client
from planner_proc.conformance.path_checks import judged
from planner_proc.conformance.truth import differences

SETTLE_S: Final = 0.6
"""How long to wait for an answer that should not come."""
N_RESENT: Final = 5
"""How often to send the same request."""
CANCEL_AFTER_S: Final = 0.2
"""How long to let a request run before it is cancelled."""
CANCELLED_S: Final = 5.0
"""Longest time to the last answer after that: planners read cancellations only now and then."""
N_BETTER: Final = 3
"""How many better plans to ask for."""
LENGTH_M: Final = 1e-9
"""Differences in length below this are rounding."""


def answers_once(bench: Bench) -> str:
    """A request that is sent once gets one answer."""
    request_id = bench.client.new_id()
    bench.client.send(request_id, EASY)
    if bench.client.next_result(request_id, bench.deadline_s) is None:
        return bench.client.silence(bench.deadline_s)
    again = bench.client.next_result(request_id, SETTLE_S)
    return "it answers a request twice that was sent once" if again else ""


def repeats_its_answer(bench: Bench) -> str:
    """A request that is sent again gets the same answer again."""
    request_id = bench.client.new_id()
    answers: list[PlanResult] = []
    for _ in range(N_RESENT):
        result = bench.client.insist(request_id, EASY, bench.deadline_s)
        if result is None:
            return f"after {len(answers)} answers: {bench.client.silence(bench.deadline_s)}"
        answers.append(result)
        if different := differences(answers[0].plan, result.plan):
            return f"the same request gets another answer when it is sent again: {different}"
    return ""


def refuses_another_query(bench: Bench) -> str:
    """A request id that was used for another query gets the status `invalid`."""
    request_id = bench.client.new_id()
    for asked, expected in ((EASY, "exact"), (replace(EASY, seed=EASY.seed + 1), "invalid")):
        bench.client.send(request_id, asked)
        result = bench.client.next_result(request_id, bench.deadline_s)
        if result is None:
            return bench.client.silence(bench.deadline_s)
        if result.plan.status != expected:
            which = "the first" if expected == "exact" else "another query under the same request id"
            return f"{which} gets the status {result.plan.status}, expected {expected}"
    return ""


def answers_the_newest(bench: Bench) -> str:
    """If a client sends several requests at once, the newest is answered."""
    ids = [bench.client.new_id() for _ in range(3)]
    for index, request_id in enumerate(ids):
        bench.client.send(request_id, replace(EASY, seed=index))
    if bench.client.next_result(ids[-1], bench.deadline_s) is None:
        return f"the newest of three requests: {bench.client.silence(bench.deadline_s)}"
    return ""


def is_deterministic(bench: Bench) -> str:
    """Equal queries get equal plans, also from a planner that was restarted."""
    first = bench.client.ask(EASY, bench.deadline_s)
    second = bench.client.ask(EASY, bench.deadline_s)
    if wrong := _unequal("two equal queries get different plans", first, second):
        return wrong
    bench.planner.kill()
    bench.planner.start()
    if wrong := bench.client.wait_for_planner(START_S):
        return f"after a restart: {wrong}"
    third = bench.client.ask(EASY, bench.deadline_s)
    return _unequal("after a restart an equal query gets another plan", first, third)


def _unequal(what: str, a: PlanResult | str, b: PlanResult | str) -> str:
    """What is wrong with either answer, or how their plans differ; empty if they are equal."""
    if isinstance(a, str):
        return a
    if isinstance(b, str):
        return b
    different = differences(a.plan, b.plan)
    return f"{what}: {different}" if different else ""


def serves_a_restarted_client(bench: Bench) -> str:
    """A client that was restarted counts its requests from the first id on, and gets its own answers."""
    bench.client.new_id()  # so that the next id is higher than the first one of the restarted client
    before = bench.client.ask(query(room(8.0, 6.0), (1.0, 5.0), (7.0, 5.0)), bench.deadline_s)
    if isinstance(before, str):
        return before
    with Bus(RUN, "agent", bench.client.bus.name, bench.planner.endpoints) as bus:
        restarted = Client(bus, bench.planner)
        result = restarted.wait_for_planner(START_S) or restarted.ask(EASY, bench.deadline_s)
    if isinstance(result, str):
        return f"a client that was restarted: {result}"
    return judged(EASY, result.plan, ("exact",))


def serves_two_clients(bench: Bench) -> str:
    """Two clients that ask at once each get their own answer."""
    queries = {bench.client: EASY, bench.other: query(room(8.0, 6.0), (1.0, 5.0), (7.0, 5.0))}
    ids = {client: client.new_id() for client in queries}
    for client, asked in queries.items():
        client.send(ids[client], asked)
    for client, asked in queries.items():
        result = client.next_result(ids[client], bench.deadline_s)
        if result is None:
            return f"client {client.bus.name}: {client.silence(bench.deadline_s)}"
        if wrong := judged(asked, result.plan, ("exact",)):
            return f"client {client.bus.name}: {wrong}"
    return ""


def survives_nonsense(bench: Bench) -> str:
    """Messages that are not valid get no answer and do no harm."""
    good = bench.client.example(EASY)
    bench.client.next_result(bench.client.new_id(), SETTLE_S)
    header, asked = _map(good["header"]), _map(good["query"])
    broken = {
        "bytes that are not MessagePack": b"\xc1\xff\x00",
        "an empty message": b"",
        "a list instead of a map": msgpack.packb([1, 2, 3]),
        "a missing field": msgpack.packb({key: value for key, value in good.items() if key != "query"}),
        "another protocol version": msgpack.packb({**good, "header": {**header, "protocol": 999}}),
        "a start that is not a number": msgpack.packb(
            {**good, "query": {**asked, "start": {"x_m": nan, "y_m": 0.0, "yaw_rad": 0.0}}}
        ),
        "a text for a number": msgpack.packb({**good, "query": {**asked, "clearance_m": "wide"}}),
    }
    for what, payload in broken.items():
        bench.client.send_raw(payload)
        if ended := bench.planner.end():
            return f"{what}: {ended}"
        result = bench.client.ask(EASY, bench.deadline_s)
        if isinstance(result, str):
            return f"after {what}: {result}"
    return ""


def _map(value: object) -> dict[str, object]:
    """A part of a message that is a map."""
    if not isinstance(value, dict):
        raise TypeError(f"Expected a map, got {value}")
    return value


def comes_back(bench: Bench) -> str:
    """If the planner is killed while it plans and restarted, it answers the request that is sent again."""
    request_id = bench.client.new_id()
    asked = huge()
    bench.client.send(request_id, asked)
    bench.client.next_result(request_id, 0.1)
    bench.planner.kill()
    bench.planner.start()
    if wrong := bench.client.wait_for_planner(START_S):
        return wrong
    result = bench.client.insist(request_id, asked, bench.deadline_s)
    return judged(asked, result.plan, ("exact",)) if result else bench.client.silence(bench.deadline_s)


def cancels(bench: Bench) -> str:
    """A long request that is cancelled gets a last answer soon, and the next request is answered."""
    asked = query(room(8.0, 6.0, (3.9, 4.1, 0.0, 6.0)), (1.0, 3.0), (7.0, 3.0), max_iterations=10_000_000)
    request_id = bench.client.new_id()
    bench.client.send(request_id, asked)
    early = bench.client.next_result(request_id, CANCEL_AFTER_S)
    bench.client.cancel(request_id)
    soon_s = min(CANCELLED_S, bench.deadline_s)
    result = early or bench.client.next_result(request_id, soon_s)
    if result is None:
        return f"no last answer within {soon_s:g} s to a request that was cancelled"
    if not result.final:
        return "the answer to a request that was cancelled says that more will come"
    if early and result.plan.status == "exact":
        return "it finds a way through a wall"
    after = bench.client.ask(EASY, bench.deadline_s)
    return f"after a request that was cancelled: {after}" if isinstance(after, str) else ""


def improves(bench: Bench) -> str:
    """With `anytime`, plans follow in order, each no worse than the one before, the last one marked.

    A planner that has no better plans gets a remark.
    """
    asked = replace(EASY, planner="rrt_star", anytime=Anytime(n_improvements=N_BETTER, improvement_iterations=200))
    request_id = bench.client.new_id()
    result = bench.client.insist(request_id, asked, bench.deadline_s)
    if result is None:
        return bench.client.silence(bench.deadline_s)
    answers = [result]
    while not answers[-1].final:
        result = bench.client.next_result(request_id, bench.deadline_s)
        if result is None:
            return (
                f"after revision {answers[-1].revision}, which is not final: {bench.client.silence(bench.deadline_s)}"
            )
        answers.append(result)
    if answers[0].plan.status == "invalid" or len(answers) == 1:
        return f"{REMARK}it has no better plans after the first one ({answers[0].plan.reason})"
    revisions = [answer.revision for answer in answers]
    if revisions != list(range(N_BETTER + 1)):
        return f"its revisions are {revisions}, expected 0 to {N_BETTER} in order"
    for before, after in pairwise(answers):
        if wrong := judged(asked, after.plan, ("exact",)):
            return f"revision {after.revision}: {wrong}"
        if after.plan.length_m > before.plan.length_m + LENGTH_M:
            return f"revision {after.revision} is longer than the one before it"
    return ""
