"""Contacts that no plan asked for, counted by the parts that touch."""

from copy import copy
from functools import lru_cache
from typing import Final

import numpy as np

from legpush.arrays import Flags, Floats
from legpush.errors import MotionError
from legpush.messages.measures import MAX_PAIRS, UnexpectedContact
from legpush.scene.conventions import FRONT_LEGS, LEGS, FrontLeg
from sim_proc.headless import mujoco
from sim_proc.physics.sensors import Sensors

UNKNOWN: Final = -1
"""A number of contacts that no step has."""
MAX_SETS: Final = 4096
"""Most sets of touching parts that are remembered."""


class ContactWatch:
    """Counts the physics steps in which parts touch that should not.

    Feet may touch the floor, and so may the box. A pushing leg may touch the box with its foot and its lower leg. The
    contacts of a step are looked at when their number has changed, in the first step of each tick, and in each step
    after one with an unexpected contact.
    """

    def __init__(self, model: mujoco.MjModel, sensors: Sensors) -> None:
        """Watch a world in which no leg pushes."""
        self._counts = sensors.n_contacts
        """Columns of the numbers of contacts: feet and floor, box and floor, front feet and box, and all."""
        self._names = tuple(model.geom(geom).name for geom in range(model.ngeom))
        box = np.flatnonzero(model.geom_bodyid == model.body("box").id).tolist()
        expected = _expected(model, box)
        self._allowed: dict[FrontLeg | None, Flags] = {None: expected}
        for leg in FRONT_LEGS:
            self._allowed[leg] = _with(expected, [model.geom(f"{leg}_{part}").id for part in ("foot", "lower")], box)
        self.n_known = UNKNOWN
        """Number of contacts in the step that was looked at last, if all of them are expected."""
        self.expect(None)

    def expect(self, pushing: FrontLeg | None) -> None:
        """Begin to count again. The leg `pushing` may touch the box."""
        allowed = self._allowed[pushing]
        self._weights = np.array([1.0] * (len(LEGS) + 1) + [float(leg == pushing) for leg in FRONT_LEGS] + [-1.0])
        """The sum of the numbers of contacts with these weights is 0 in a step with expected contacts, (n,)."""

        @lru_cache(maxsize=MAX_SETS)
        def unexpected(geoms: bytes) -> tuple[tuple[int, tuple[int, int]], ...]:
            """Places of the unexpected contacts among all, and their geoms."""
            pairs = np.frombuffer(geoms, dtype=np.int32).reshape(-1, 2)
            return tuple((k, (min(pair), max(pair))) for k, pair in enumerate(pairs.tolist()) if not allowed[*pair])

        self._unexpected = unexpected
        self._found: dict[tuple[int, int], tuple[int, float]] = {}
        self.n_steps = 0
        """Number of physics steps with an unexpected contact."""

    def copy(self) -> "ContactWatch":
        """Return a watch with the same counts, which counts apart from this one."""
        other = copy(self)
        other._found = dict(self._found)
        return other

    def suspects(self, readings: Floats) -> bool:
        """Whether sensors (..., n) of physics steps tell of more contacts than those of feet, floor and box."""
        return bool((readings[..., self._counts] @ self._weights).any())

    def begin_tick(self) -> None:
        """Let the next step be looked at."""
        self.n_known = UNKNOWN

    def look(self, model: mujoco.MjModel, data: mujoco.MjData) -> None:
        """Count the unexpected contacts of the step that was just simulated."""
        unexpected = self._unexpected(data.contact.geom.tobytes())
        if not unexpected:
            self.n_known = data.ncon
            return
        self.n_known = UNKNOWN
        self.n_steps += 1
        force, largest = np.empty(6), dict[tuple[int, int], float]()
        for index, pair in unexpected:
            mujoco.mj_contactForce(model, data, index, force)
            largest[pair] = max(largest.get(pair, 0.0), float(np.linalg.norm(force[:3])))
        for pair, force_n in largest.items():
            n_steps, before_n = self._found.get(pair, (0, 0.0))
            self._found[pair] = n_steps + 1, max(before_n, force_n)

    def found(self) -> tuple[UnexpectedContact, ...]:
        """The pairs that touched, those with the most steps first, `MAX_PAIRS` at most."""
        contacts = []
        for pair, (n_steps, force_n) in self._found.items():
            first, second = sorted(self._names[geom] for geom in pair)
            contacts.append(UnexpectedContact(first=first, second=second, n_steps=n_steps, max_force_n=force_n))
        contacts.sort(key=lambda each: (-each.n_steps, each.first, each.second))
        return tuple(contacts[:MAX_PAIRS])


def _expected(model: mujoco.MjModel, box: list[int]) -> Flags:
    """Which geoms may touch while no leg pushes, (ngeom, ngeom)."""
    nothing: Flags = np.zeros((model.ngeom, model.ngeom), dtype=bool)
    feet = [model.geom(f"{leg}_foot").id for leg in LEGS]
    floor = model.geom("floor").bodyid[0]
    surfaces = [model.geom("floor").id] if floor == 0 else np.flatnonzero(model.geom_bodyid == floor).tolist()
    return _with(nothing, surfaces, [*feet, *box])


def _with(allowed: Flags, some: list[int], others: list[int]) -> Flags:
    """Allow contacts between two groups of geoms as well."""
    more = allowed.copy()
    more[np.ix_(some, others)] = more[np.ix_(others, some)] = True
    return more


def require_apart(model: mujoco.MjModel, data: mujoco.MjData, allowed_m: float) -> None:
    """Check that no part of robot, box and room is deeper than `allowed_m` in another one.

    Raises:
        MotionError: Two parts are; names them.
    """
    if data.ncon == 0:
        return
    deepest = int(np.argmin(data.contact.dist))
    depth_m = -float(data.contact.dist[deepest])
    if depth_m > allowed_m:
        first, second = (model.geom(geom).name for geom in data.contact.geom[deepest])
        raise MotionError(
            f"Expected robot, box and walls apart at the start, got `{first}` {depth_m:.2f} m deep in `{second}`"
        )
