"""What each role may say and hear, as access rules for Zenoh. Everything else is denied.

Every process and router has all rules and applies them to the certificate at the other end of each link. So what a
process may say depends on its certificate alone, and its own configuration cannot widen it.

Behind a router, the certificate at the other end is the router's. So each router enforces the rules on its own clients,
and is trusted to have done so: from a router comes what any role may say, of which a process takes what its role hears.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Final

from legpush.bus import keys
from legpush.bus.secure.certificate_names import OF_ROUTERS, CertificateRole
from legpush.messages.common import Role

ANY: Final = "*"
VIEWS: Final = "view-$*"
"""Names that views give themselves."""


@dataclass(frozen=True, kw_only=True)
class Rights:
    """Keys, with wildcards, of one role."""

    says: tuple[str, ...]
    hears: tuple[str, ...]
    shows: str
    """Its liveliness tokens."""


def _own(role: Role) -> tuple[str, str]:
    """Return the keys under which a process says what it does, and hands copies to recorders."""
    return keys.status(ANY, role, ANY), keys.copies(ANY, role, ANY)


def _live(role: Role, name: str = ANY) -> str:
    return keys.liveliness_of_any_version(ANY, role, name, ANY)


RIGHTS: Final[Mapping[CertificateRole, Rights]] = {
    "planner": Rights(
        says=(keys.plan_result(ANY, ANY), *_own("planner")),
        hears=(keys.plan_request(ANY, ANY), keys.plan_cancel(ANY, ANY), keys.taken(ANY, "planner", ANY)),
        shows=_live("planner"),
    ),
    "sim": Rights(
        says=(keys.observation(ANY, ANY), keys.bundled_answers(ANY, ANY), *_own("sim")),
        hears=(keys.action(ANY, ANY), keys.bundled_actions(ANY, ANY), keys.taken(ANY, "sim", ANY)),
        shows=_live("sim"),
    ),
    "agent": Rights(
        says=(
            keys.plan_request(ANY, ANY),
            keys.plan_cancel(ANY, ANY),
            keys.action(ANY, ANY),
            keys.bundled_actions(ANY, ANY),
            keys.job_request(ANY, ANY),
            keys.reward(ANY, ANY),
            *_own("agent"),
        ),
        hears=(
            keys.plan_result(ANY, ANY),
            keys.observation(ANY, ANY),
            keys.bundled_answers(ANY, ANY),
            keys.job_result(ANY, ANY),
            keys.status(ANY, "planner", ANY),
            keys.status(ANY, "sim", ANY),
            keys.status(ANY, "worker", ANY),
            keys.taken(ANY, "agent", ANY),
        ),
        shows=_live("agent"),
    ),
    "worker": Rights(
        says=(keys.job_result(ANY, ANY), *_own("worker")),
        hears=(keys.job_request(ANY, ANY), keys.taken(ANY, "worker", ANY)),
        shows=_live("worker"),
    ),
    "launcher": Rights(
        says=_own("launcher"),
        hears=(keys.status(ANY, ANY, ANY), keys.taken(ANY, "launcher", ANY)),
        shows=_live("launcher"),
    ),
    "recorder": Rights(
        says=(keys.taken(ANY, ANY, ANY), keys.status(ANY, "recorder", ANY)),
        hears=(keys.copies(ANY, ANY, ANY),),
        shows=_live("recorder"),
    ),
    "viewer": Rights(
        says=(keys.taken(ANY, ANY, ANY),),
        hears=(keys.copies(ANY, ANY, ANY),),
        shows=_live("recorder", VIEWS),
    ),
}
"""What each role may say and hear."""
OF_ALL: Final = (keys.status(ANY, ANY, ANY), keys.copies(ANY, ANY, ANY))
"""What a launcher and a recorder ask for: keys of all roles at once, so no rule for one role includes them."""
EVERYBODY: Final = keys.liveliness_of_any_version(ANY, ANY, ANY, ANY)
"""All tokens: every process sees who is there, and who of another version is."""


def access_control(names: Mapping[CertificateRole, Sequence[str]], own: CertificateRole = OF_ROUTERS) -> dict[str, Any]:
    """Return Zenoh's configuration `access_control` of a process of the role `own`.

    `names` are those of the certificates that may take part, by role. A role without a name gets no subject: Zenoh
    takes one without names for everybody, and refuses an empty list.
    """
    rights = {**RIGHTS, OF_ROUTERS: _of_router(own)}
    present = [role for role in rights if names.get(role)]
    rules = {role: _rules(role, rights[role]) for role in present}
    return {
        "enabled": True,
        "default_permission": "deny",
        "rules": [rule for role in present for rule in rules[role]],
        "subjects": [{"id": role, "cert_common_names": list(names[role])} for role in present],
        "policies": [{"subjects": [role], "rules": [rule["id"] for rule in rules[role]]} for role in present],
    }


def _of_router(own: CertificateRole) -> Rights:
    """Return what a router may say to a process of this role and hear from it; to another router, everything."""
    if own != OF_ROUTERS:
        return Rights(says=RIGHTS[own].hears, hears=(*RIGHTS[own].says, *OF_ALL), shows=EVERYBODY)
    says = {key for rights in RIGHTS.values() for key in rights.says}
    hears = {key for rights in RIGHTS.values() for key in rights.hears}
    return Rights(says=tuple(sorted(says | hears)), hears=tuple(sorted(says | hears)), shows=EVERYBODY)


def _rules(role: CertificateRole, rights: Rights) -> list[dict[str, Any]]:
    """Return what may come from a certificate of this role (ingress), and what may go to it (egress)."""
    lookups = ["declare_liveliness_subscriber", "liveliness_query"]
    return [
        _allow(f"{role} says", "ingress", ["put"], rights.says),
        _allow(f"{role} is asked for what it says", "egress", ["declare_subscriber"], (*rights.says, *OF_ALL)),
        _allow(f"{role} hears", "egress", ["put"], rights.hears),
        _allow(f"{role} asks for what it hears", "ingress", ["declare_subscriber"], rights.hears),
        _allow(f"{role} shows itself", "ingress", ["liveliness_token"], (rights.shows,)),
        _allow(f"{role} sees others", "egress", ["liveliness_token"], (EVERYBODY,)),
        _allow(f"{role} looks for others", "ingress", lookups, (EVERYBODY,)),
        _allow(f"{role} is looked for", "egress", lookups, (EVERYBODY,)),
    ]


def _allow(name: str, flow: str, messages: list[str], key_expressions: Sequence[str]) -> dict[str, Any]:
    return {
        "id": name,
        "permission": "allow",
        "flows": [flow],
        "messages": messages,
        "key_exprs": list(key_expressions),
    }
