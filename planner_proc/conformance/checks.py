"""Runs the checks, all or some of them by name."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import partial
from typing import Final

from legpush.errors import ConfigError
from planner_proc.conformance import exchange_checks, path_checks
from planner_proc.conformance.bench import REMARK, START_S, Bench
from planner_proc.conformance.cases import AHEAD, ASIDE, HERE, cases


@dataclass(frozen=True, kw_only=True)
class Finding:
    """The outcome of one check."""

    name: str
    passed: bool
    reason: str
    """What is wrong if it did not pass; else a remark, or empty."""


def run_checks(bench: Bench, only: Sequence[str] = ()) -> Iterator[Finding]:
    """Run all checks in order, or those with one of the texts `only` in their name, and yield their findings.

    If the planner does not start, no check is run.

    Raises:
        ConfigError: No check has one of the texts in its name.
        StopRequestedError: The checks were interrupted.
    """
    planned = {f"plans: {case.name}": partial(path_checks.plans, case=case) for case in cases()} | CHECKS
    chosen = {name: check for name, check in planned.items() if not only or any(text in name for text in only)}
    if not chosen:
        raise ConfigError(f"Expected a part of the name of a check for --only ({', '.join(planned)}), got {only}")
    wrong = bench.client.wait_for_planner(START_S) or bench.other.wait_for_planner(START_S)
    yield Finding(name="starts and shows its token", passed=not wrong, reason=wrong)
    if wrong:
        return
    for name, check in chosen.items():
        yield _finding(name, bench, check)


def _finding(name: str, bench: Bench, check: Callable[[Bench], str]) -> Finding:
    """Run a check. If it failed, or the planner ended during it, start the planner again for the next one.

    A planner that did not answer in time may be busy with this query for long, and would fail the checks behind it.
    """
    reason = check(bench)
    passed = not reason or reason.startswith(REMARK)
    if bench.planner.end() or not passed:
        bench.planner.kill()
        bench.planner.start()
        bench.client.wait_for_planner(START_S)
    return Finding(name=name, passed=passed, reason=reason.removeprefix(REMARK))


CHECKS: Final[dict[str, Callable[[Bench], str]]] = {
    "answers once": exchange_checks.answers_once,
    "repeats its answer to a request that is sent again": exchange_checks.repeats_its_answer,
    "refuses another query under a used request id": exchange_checks.refuses_another_query,
    "answers the newest of several requests": exchange_checks.answers_the_newest,
    "equal queries, equal plans, also after a restart": exchange_checks.is_deterministic,
    "serves a client that was restarted": exchange_checks.serves_a_restarted_client,
    "serves two clients at once": exchange_checks.serves_two_clients,
    "survives messages that are not valid": exchange_checks.survives_nonsense,
    "comes back when it is killed while it plans": exchange_checks.comes_back,
    "answers a request that is cancelled": exchange_checks.cancels,
    "better plans after the first one": exchange_checks.improves,
    "turning radius between straight lines": partial(path_checks.steers, steering="straight"),
    "turning radius, forward only (Dubins)": partial(path_checks.steers, steering="dubins"),
    "turning radius, backward too (Reeds and Shepp)": partial(path_checks.steers, steering="reeds_shepp"),
    "the body of the robot turns where it has room": path_checks.minds_the_body,
    "paths of the box: already at its goal": partial(path_checks.knows_boxes, goal=HERE),
    "paths of the box: straight ahead": partial(path_checks.knows_boxes, goal=AHEAD),
    "paths of the box: to the side and turned": partial(path_checks.knows_boxes, goal=ASIDE),
}
"""The checks that follow those of the cases."""
