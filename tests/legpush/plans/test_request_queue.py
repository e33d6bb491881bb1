"""The request queue of the planner, without a network: what is planned, repeated, improved, cancelled, and put off."""

from collections.abc import Iterator

from msgspec.structs import replace

from legpush.messages.planning import Plan, PlanCancel, PlanQuery, PlanRequest
from legpush.plans.planner import Interrupted, PlanningInterruptedError
from legpush.plans.request_queue import MAX_CLIENTS, Answer, RequestQueue
from legpush.scene.plan_settings import Anytime
from tests.legpush.examples import QUERY, header
from tests.legpush.fakes import fake_plan

ANYTIME = Anytime(n_improvements=2, improvement_iterations=10)


class Planner:
    """Remembers the seeds that it planned for; each improvement is 1 m shorter, `invalid` where there is no seed."""

    def __init__(self) -> None:
        self.seeds: list[int] = []
        self.n_plans = 0

    def __call__(self, query: PlanQuery, interrupted: Interrupted) -> Iterator[Plan]:
        self.seeds.append(query.seed)
        for k in range(3):
            if interrupted():
                raise PlanningInterruptedError
            self.n_plans += 1
            if query.seed == 0:
                yield Plan(status="invalid", reason="no seed")
                return
            yield replace(fake_plan(query), length_m=10.0 - k)


def request(
    request_id: int, seed: int = 1, client: str = "main", incarnation: str = "a", **fields: object
) -> PlanRequest:
    head = replace(header("agent"), name=client, incarnation=incarnation)
    return PlanRequest(header=head, request_id=request_id, query=replace(QUERY, seed=seed, **fields))


def cancel(request_id: int, client: str = "main", incarnation: str = "a") -> PlanCancel:
    return PlanCancel(header=replace(header("agent"), name=client, incarnation=incarnation), request_id=request_id)


def asked(queue: RequestQueue, one: PlanRequest) -> list[Answer]:
    """What is answered once it has been worked on."""
    at_once = queue.ask(one)
    assert at_once is not None
    return at_once or worked(queue)


def worked(queue: RequestQueue) -> list[Answer]:
    """All that there is to do."""
    answers = []
    while queue.next_case():
        answer = queue.work(lambda: False)
        assert answer is not None
        answers.append(answer)
    return answers


def test_a_request_is_planned_once_and_its_copies_get_the_same_answer() -> None:
    planner = Planner()
    queue = RequestQueue(planner)
    first = asked(queue, request(0))
    assert [(answer.revision, answer.final) for answer in first] == [(0, True)]
    assert asked(queue, request(0)) == first
    assert planner.seeds == [1]


def test_a_copy_that_comes_while_the_request_waits_is_no_request_of_its_own() -> None:
    planner = Planner()
    queue = RequestQueue(planner)
    assert queue.ask(request(0)) == []
    assert queue.ask(request(0)) == []
    assert len(worked(queue)) == 1


def test_a_request_older_than_the_newest_is_not_answered() -> None:
    queue = RequestQueue(Planner())
    asked(queue, request(4))
    assert queue.ask(request(3)) is None


def test_the_newest_request_of_a_client_supersedes_the_one_that_waits() -> None:
    planner = Planner()
    queue = RequestQueue(planner)
    for request_id in (0, 2):
        queue.ask(request(request_id, seed=request_id + 5))
    assert queue.ask(request(1)) is None
    assert [answer.request_id for answer in worked(queue)] == [2]
    assert planner.seeds == [7]


def test_another_query_under_the_same_request_id_is_invalid() -> None:
    queue = RequestQueue(Planner())
    asked(queue, request(4, seed=1))
    (answer,) = asked(queue, request(4, seed=2))
    assert answer.plan.status == "invalid"
    assert answer.final
    assert "request id 4" in answer.plan.reason


def test_a_client_that_was_restarted_begins_anew() -> None:
    queue = RequestQueue(Planner())
    asked(queue, request(4, seed=1, incarnation="a"))
    (answer,) = asked(queue, request(0, seed=2, incarnation="b"))
    assert (answer.incarnation, answer.plan.n_iterations) == ("b", 2)


def test_answers_are_kept_for_a_bounded_number_of_clients() -> None:
    planner = Planner()
    queue = RequestQueue(planner)
    for index in range(1, MAX_CLIENTS + 2):
        asked(queue, request(0, seed=index, client=f"c{index}"))
    asked(queue, request(0, seed=2, client="c2"))
    asked(queue, request(0, seed=1, client="c1"))
    assert planner.seeds == [*range(1, MAX_CLIENTS + 2), 1]


def test_improvements_follow_the_first_answer_and_all_are_repeated_on_demand() -> None:
    planner = Planner()
    queue = RequestQueue(planner)
    answers = asked(queue, request(0, anytime=ANYTIME))
    assert [(answer.revision, answer.final) for answer in answers] == [(0, False), (1, False), (2, True)]
    assert [answer.plan.length_m for answer in answers] == [10.0, 9.0, 8.0]
    assert queue.ask(request(0, anytime=ANYTIME)) == answers
    assert planner.seeds == [1]


def test_what_is_invalid_is_not_improved() -> None:
    queue = RequestQueue(Planner())
    (answer,) = asked(queue, request(0, seed=0, anytime=ANYTIME))
    assert answer.final


def test_a_first_answer_comes_before_improvements_of_others_which_go_on_where_they_were() -> None:
    planner = Planner()
    queue = RequestQueue(planner)
    queue.ask(request(0, seed=1, client="a", anytime=ANYTIME))
    first = queue.work(lambda: False)
    queue.ask(request(0, seed=2, client="b"))
    assert queue.should_stop()
    rest = worked(queue)
    assert first is not None
    assert [(answer.client, answer.revision) for answer in [first, *rest]] == [("a", 0), ("b", 0), ("a", 1), ("a", 2)]
    assert [answer.plan.length_m for answer in rest if answer.client == "a"] == [9.0, 8.0]
    assert planner.seeds == [1, 2, 1]


def test_a_search_that_is_interrupted_gives_no_answer_and_is_begun_anew() -> None:
    planner = Planner()
    queue = RequestQueue(planner)
    queue.ask(request(0))
    assert queue.work(lambda: True) is None
    assert [answer.revision for answer in worked(queue)] == [0]
    assert planner.seeds == [1, 1]


def test_a_cancelled_request_ends_with_the_best_so_far() -> None:
    queue = RequestQueue(Planner())
    queue.ask(request(0, anytime=ANYTIME))
    first = queue.work(lambda: False)
    assert first is not None
    assert queue.cancel(cancel(0)) == [first._replace(final=True)]
    assert queue.should_stop()
    assert not queue.next_case()
    assert queue.ask(request(0, anytime=ANYTIME)) == [first._replace(final=True)]


def test_one_that_is_cancelled_before_there_was_a_plan_says_so() -> None:
    planner = Planner()
    queue = RequestQueue(planner)
    queue.ask(request(3))
    (answer,) = queue.cancel(cancel(3))
    assert (answer.plan.status, answer.final) == ("cancelled", True)
    assert worked(queue) == []
    assert planner.seeds == []


def test_a_cancel_that_overtakes_its_request_holds_and_one_of_an_old_request_does_not() -> None:
    planner = Planner()
    queue = RequestQueue(planner)
    (answer,) = queue.cancel(cancel(5))
    assert queue.ask(request(5)) == [answer]
    assert queue.cancel(cancel(4)) == []
    assert [answer.request_id for answer in asked(queue, request(6))] == [6]
    assert planner.seeds == [1]


def test_a_search_that_is_begun_anew_may_be_interrupted_before_it_comes_to_something_new() -> None:
    planner = Planner()
    queue = RequestQueue(planner)
    queue.ask(request(0, client="a", anytime=ANYTIME))
    first = queue.work(lambda: False)
    queue.ask(request(0, client="b", seed=2))
    second = queue.work(lambda: False)
    assert queue.work(lambda: True) is None
    rest = worked(queue)
    assert (first is not None, second is not None) == (True, True)
    assert [(answer.client, answer.revision) for answer in rest] == [("a", 1), ("a", 2)]


def test_the_improvements_at_hand_go_on_before_those_of_others() -> None:
    planner = Planner()
    queue = RequestQueue(planner)
    for client in ("a", "b"):
        queue.ask(request(0, client=client, anytime=ANYTIME))
    order = [(answer.client, answer.revision) for answer in worked(queue)]
    assert order == [("a", 0), ("b", 0), ("b", 1), ("b", 2), ("a", 1), ("a", 2)]
    assert len(planner.seeds) == 3


def test_a_client_that_is_alive_is_not_displaced_by_another_one_of_its_name() -> None:
    live = {("main", "a"), ("main", "b")}
    queue = RequestQueue(Planner(), lambda name, incarnation: (name, incarnation) in live)
    queue.ask(request(4, seed=1, incarnation="a"))
    queue.ask(request(7, seed=2, incarnation="b"))
    assert [(one.incarnation, one.plan.n_iterations) for one in worked(queue)] == [("a", 1), ("b", 2)]
    queue.ask(request(5, seed=3, incarnation="a"))
    live.remove(("main", "a"))
    queue.ask(request(8, seed=4, incarnation="b"))
    assert [(one.incarnation, one.plan.n_iterations) for one in worked(queue)] == [("b", 4)]


def test_of_too_many_clients_those_that_are_gone_are_forgotten_first() -> None:
    planner = Planner()
    queue = RequestQueue(planner, lambda name, incarnation: name == "main")
    first = asked(queue, request(0))
    for k in range(MAX_CLIENTS):
        asked(queue, request(0, client=f"client{k}"))
    planner.seeds.clear()
    assert asked(queue, request(0)) == first
    assert planner.seeds == []


def test_a_planner_that_fails_at_one_request_answers_it_and_the_next() -> None:
    def fail_at_first(query: PlanQuery, interrupted: Interrupted) -> Iterator[Plan]:
        del interrupted
        if query.seed == 1:
            raise OverflowError("math range error")
        yield fake_plan(query)

    queue = RequestQueue(fail_at_first)
    for anytime in (None, ANYTIME):
        failed = asked(queue, request(0, client=f"with {anytime}", anytime=anytime))
        assert {one.plan.status for one in failed} == {"failed"}
        assert "OverflowError: math range error" in failed[0].plan.reason
        assert failed[-1].final
    assert asked(queue, request(1, seed=2))[0].plan.status == "exact"


def test_a_planner_that_fails_at_a_better_plan_leaves_the_last_one_as_the_final_one() -> None:
    def fail_at_second(query: PlanQuery, interrupted: Interrupted) -> Iterator[Plan]:
        del interrupted
        yield fake_plan(query)
        raise ValueError("no")

    answers = asked(RequestQueue(fail_at_second), request(0, anytime=ANYTIME))
    assert [(one.revision, one.final) for one in answers] == [(0, False), (0, True)]
    assert {one.plan.status for one in answers} == {"exact"}
