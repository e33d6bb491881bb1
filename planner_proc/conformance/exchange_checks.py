"""Checks of what is asked and answered, one function each: it says what is wrong, or nothing."""

from itertools import pairwise
from math import nan
from typing import Final

import msgpack
from msgspec.structs import replace

from legpush.bus.bus import Bus
from legpush.messages.planning import PlanResult
from legpush.scene.scenario import Anytime
from planner_proc.conformance.bench import EASY, REMARK, START_S, Bench
from planner_proc.conformance.cases import huge, query, room
from planner_proc.conformance.client import RUN, Client
from planner_proc.conformance.path_checks import judged
from planner_proc.conformance.truth import differences

SETTLE_S: Final = 0.6
"""An answer that should not come would come within this time."""
N_RESENT: Final = 5
CANCEL_AFTER_S: Final = 0.2
CANCELLED_S: Final = 5.0
"""A planner looks at what its clients want now and then."""
N_BETTER: Final = 3
LENGTH_M: Final = 1e-9


def answers_once(bench: Bench) -> str:
    """One answer to one request."""
    request_id = bench.client.new_id()
    bench.client.send(request_id, EASY)
    results = bench.client.results(request_id, bench.deadline_s)
    if not results:
        return bench.client.silence(bench.deadline_s)
    more = bench.client.results(request_id, SETTLE_S)
    return "it answers a request twice that was sent once" if more else ""


def repeats_its_answer(bench: Bench) -> str:
    """The same request again gets the same answer again."""
    request_id = bench.client.new_id()
    answers: list[PlanResult] = []
    for _ in range(N_RESENT):
        results = bench.client.insist(request_id, EASY, bench.deadline_s)
        if not results:
            return f"after {len(answers)} answers: {bench.client.silence(bench.deadline_s)}"
        answers += results
        if different := differences(answers[0].plan, results[0].plan):
            return f"the same request gets another answer when it is sent again: {different}"
    return ""


def refuses_another_query(bench: Bench) -> str:
    """A request id that was used for another query."""
    request_id = bench.client.new_id()
    for asked, expected in ((EASY, "exact"), (replace(EASY, seed=EASY.seed + 1), "invalid")):
        bench.client.send(request_id, asked)
        results = bench.client.results(request_id, bench.deadline_s)
        if not results:
            return bench.client.silence(bench.deadline_s)
        if results[0].plan.status != expected:
            which = "the first" if expected == "exact" else "another query under the same request id"
            return f"{which} gets the status {results[0].plan.status}, expected {expected}"
    return ""


def is_deterministic(bench: Bench) -> str:
    """Equal queries get equal plans, also from a process that was started anew."""
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
    for result in (a, b):
        if isinstance(result, str):
            return result
    if isinstance(a, str) or isinstance(b, str):
        return ""
    different = differences(a.plan, b.plan)
    return f"{what}: {different}" if different else ""


def survives_nonsense(bench: Bench) -> str:
    """Messages that are not valid get no answer and do no harm."""
    good = bench.client.example(EASY)
    bench.client.results(bench.client.new_id(), SETTLE_S)
    header = good["header"]
    if not isinstance(header, dict):
        raise TypeError(f"Expected a map, got {header}")
    broken = {
        "bytes that are no MessagePack": b"\xc1\xff\x00",
        "an empty message": b"",
        "no map": msgpack.packb([1, 2, 3]),
        "a missing field": msgpack.packb({key: value for key, value in good.items() if key != "query"}),
        "another protocol version": msgpack.packb({**good, "header": {**header, "protocol": 999}}),
        "a start that is not a number": msgpack.packb(
            {**good, "query": {**_map(good["query"]), "start": {"x_m": nan, "y_m": 0.0, "yaw_rad": 0.0}}}
        ),
        "a text for a number": msgpack.packb({**good, "query": {**_map(good["query"]), "clearance_m": "wide"}}),
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
    if not isinstance(value, dict):
        raise TypeError(f"Expected a map, got {value}")
    return value


def comes_back(bench: Bench) -> str:
    """Killed while it plans, and started again: the request that is sent again is answered."""
    request_id = bench.client.new_id()
    asked = huge()
    bench.client.send(request_id, asked)
    bench.client.results(request_id, 0.1)
    bench.planner.kill()
    bench.planner.start()
    if wrong := bench.client.wait_for_planner(START_S):
        return wrong
    results = bench.client.insist(request_id, asked, bench.deadline_s)
    return judged(asked, results[0].plan, ("exact",)) if results else bench.client.silence(bench.deadline_s)


def answers_the_newest(bench: Bench) -> str:
    """Of several requests of a client at once, the newest is answered."""
    ids = [bench.client.new_id() for _ in range(3)]
    for index, request_id in enumerate(ids):
        bench.client.send(request_id, replace(EASY, seed=index))
    results = bench.client.results(ids[-1], bench.deadline_s)
    return "" if results else f"the newest of three requests: {bench.client.silence(bench.deadline_s)}"


def serves_a_client_anew(bench: Bench) -> str:
    """A client that was started anew counts its requests from the first id on, and gets its own answers."""
    bench.client.new_id()  # the next one is higher than the first one of the client that starts anew
    before = bench.client.ask(query(room(8.0, 6.0), (1.0, 5.0), (7.0, 5.0)), bench.deadline_s)
    if isinstance(before, str):
        return before
    with Bus(RUN, "agent", bench.client.bus.name, bench.planner.endpoints) as bus:
        anew = Client(bus, bench.planner)
        wrong = anew.wait_for_planner(START_S)
        result = wrong or anew.ask(EASY, bench.deadline_s)
    if isinstance(result, str):
        return f"a client that was started anew: {result}"
    return judged(EASY, result.plan, ("exact",))


def serves_two_clients(bench: Bench) -> str:
    """Two clients at once get each its own answer."""
    questions = {bench.client: EASY, bench.other: query(room(8.0, 6.0), (1.0, 5.0), (7.0, 5.0))}
    asked = {client: client.new_id() for client in questions}
    for client, one in questions.items():
        client.send(asked[client], one)
    for client, one in questions.items():
        results = client.results(asked[client], bench.deadline_s)
        if not results:
            return f"client {client.bus.name}: {client.silence(bench.deadline_s)}"
        if wrong := judged(one, results[0].plan, ("exact",)):
            return f"client {client.bus.name}: {wrong}"
    return ""


def cancels(bench: Bench) -> str:
    """A request that would take long and is taken back gets a last answer at once, and the next one is answered."""
    asked = query(room(8.0, 6.0, (3.9, 4.1, 0.0, 6.0)), (1.0, 3.0), (7.0, 3.0), max_iterations=10_000_000)
    request_id = bench.client.new_id()
    bench.client.send(request_id, asked)
    early = bench.client.results(request_id, CANCEL_AFTER_S)
    bench.client.cancel(request_id)
    results = early or bench.client.results(request_id, min(CANCELLED_S, bench.deadline_s))
    if not results:
        return f"no last answer within {min(CANCELLED_S, bench.deadline_s):g} s to a request that was cancelled"
    if not results[0].final:
        return "the answer to a request that was cancelled says that more will come"
    if early and results[0].plan.status == "exact":
        return "it finds a way through a wall"
    after = bench.client.ask(EASY, bench.deadline_s)
    return f"after it: {after}" if isinstance(after, str) else ""


def improves(bench: Bench) -> str:
    """Better plans, in order, each no worse than the one before, the last one marked; a planner may have none."""
    asked = replace(EASY, planner="rrt_star", anytime=Anytime(n_improvements=N_BETTER, improvement_iterations=200))
    request_id = bench.client.new_id()
    answers = bench.client.insist(request_id, asked, bench.deadline_s)
    while answers and not answers[-1].final:
        more = bench.client.results(request_id, bench.deadline_s)
        if not more:
            return (
                f"after revision {answers[-1].revision}, which is not final: {bench.client.silence(bench.deadline_s)}"
            )
        answers += more
    if not answers:
        return bench.client.silence(bench.deadline_s)
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
