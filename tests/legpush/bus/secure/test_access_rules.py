"""Who may say and hear what, as a table of its own beside that of the rules."""

from typing import Final, Literal

import pytest

from legpush.bus import channels, keys
from legpush.bus.secure.access_rules import EVERYBODY, RIGHTS, access_control
from legpush.bus.secure.certificate_names import PROCESS_ROLES, CertificateRole

RUN: Final = "*"
RECORDING: Final[set[CertificateRole]] = {"recorder", "viewer"}
MAY: Final[dict[str, tuple[set[CertificateRole], set[CertificateRole]]]] = {
    channels.plan_requests(RUN, "*").key: ({"agent"}, {"planner"}),
    channels.plan_cancels(RUN, "*").key: ({"agent"}, {"planner"}),
    channels.plan_results(RUN, "*").key: ({"planner"}, {"agent"}),
    channels.actions(RUN, "*").key: ({"agent"}, {"sim"}),
    channels.answers(RUN, "*").key: ({"sim"}, {"agent"}),
    keys.bundled_actions(RUN, "*"): ({"agent"}, {"sim"}),
    keys.bundled_answers(RUN, "*"): ({"sim"}, {"agent"}),
    channels.job_requests(RUN, "*").key: ({"agent"}, {"worker"}),
    channels.job_results(RUN, "*").key: ({"worker"}, {"agent"}),
    channels.rewards(RUN, "*").key: ({"agent"}, set()),
    channels.statuses(RUN, "planner").key: ({"planner"}, {"agent", "launcher"}),
    channels.statuses(RUN, "sim").key: ({"sim"}, {"agent", "launcher"}),
    channels.statuses(RUN, "agent").key: ({"agent"}, {"launcher"}),
    channels.statuses(RUN, "worker").key: ({"worker"}, {"agent", "launcher"}),
    channels.statuses(RUN, "recorder").key: ({"recorder"}, {"launcher"}),
    channels.statuses(RUN, "launcher").key: ({"launcher"}, {"launcher"}),
    channels.copies(RUN, "planner").key: ({"planner"}, RECORDING),
    channels.copies(RUN, "sim").key: ({"sim"}, RECORDING),
    channels.copies(RUN, "agent").key: ({"agent"}, RECORDING),
    channels.copies(RUN, "worker").key: ({"worker"}, RECORDING),
    channels.copies(RUN, "launcher").key: ({"launcher"}, RECORDING),
    channels.taken(RUN, "planner", "*").key: (RECORDING, {"planner"}),
    channels.taken(RUN, "sim", "*").key: (RECORDING, {"sim"}),
    channels.taken(RUN, "agent", "*").key: (RECORDING, {"agent"}),
    channels.taken(RUN, "worker", "*").key: (RECORDING, {"worker"}),
    channels.taken(RUN, "launcher", "*").key: (RECORDING, {"launcher"}),
}
"""Key to the roles that say it, and to those that hear it."""


def covers(pattern: str, key: str) -> bool:
    """Whether each segment of a pattern is `*` or that of the key."""
    mine, others = pattern.split("/"), key.split("/")
    return len(mine) == len(others) and all(a in ("*", b) for a, b in zip(mine, others, strict=True))


def those(key: str, what: Literal["says", "hears"]) -> set[str]:
    """The roles that may say or hear a key."""
    return {role for role, rights in RIGHTS.items() if any(covers(pattern, key) for pattern in getattr(rights, what))}


@pytest.mark.parametrize("key", MAY)
def test_a_message_is_said_and_heard_by_the_roles_that_have_to_do_with_it(key: str) -> None:
    assert (those(key, "says"), those(key, "hears")) == MAY[key]


def test_a_viewer_says_nothing_but_what_it_has_taken() -> None:
    assert RIGHTS["viewer"].says == (keys.taken("*", "*", "*"),)


def test_each_role_shows_its_own_tokens_and_a_viewer_only_those_of_views() -> None:
    shown = {role: rights.shows.partition("/live/")[2] for role, rights in RIGHTS.items()}
    plain = {role: f"{role}/*/*" for role in PROCESS_ROLES}
    assert shown == {**plain, "viewer": "recorder/view-$*/*"}


def test_the_rules_name_each_certificate_once_and_deny_what_they_do_not_name() -> None:
    access = access_control({"sim": ("sim.a.1", "sim.a.2"), "agent": ("agent.a.1",), "planner": ()})
    assert (access["enabled"], access["default_permission"]) == (True, "deny")
    named = {subject["id"]: subject["cert_common_names"] for subject in access["subjects"]}
    assert named == {"sim": ["sim.a.1", "sim.a.2"], "agent": ["agent.a.1"]}
    assert {rule["permission"] for rule in access["rules"]} == {"allow"}
    by_role = {policy["subjects"][0]: policy["rules"] for policy in access["policies"]}
    assert all(
        len(rules) == 8 and all(rule.startswith(f"{role} ") for rule in rules) for role, rules in by_role.items()
    )
    assert sum(map(len, by_role.values())) == len(access["rules"])


def test_everybody_sees_all_tokens_of_any_version_and_no_other_key() -> None:
    assert keys.liveliness_of_any_version("*", "*", "*", "*") == EVERYBODY


def test_from_a_router_a_process_takes_what_its_role_hears_and_to_another_router_goes_everything() -> None:
    for own in PROCESS_ROLES:
        rules = {rule["id"]: rule for rule in access_control({"router": ("router.hub.1",)}, own)["rules"]}
        assert set(rules["router says"]["key_exprs"]) == set(RIGHTS[own].hears)
        assert set(rules["router hears"]["key_exprs"]) >= set(RIGHTS[own].says)
    rules = {rule["id"]: rule for rule in access_control({"router": ("router.hub.1",)})["rules"]}
    assert set(rules["router says"]["key_exprs"]) >= {key for rights in RIGHTS.values() for key in rights.says}
