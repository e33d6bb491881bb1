"""A moment of the running world, to which a simulation can go back."""

from typing import NamedTuple

from legpush.arrays import Floats
from legpush.messages.stepping import Appearance
from sim_proc.physics.appearing import Waiting
from sim_proc.physics.contacts import ContactWatch
from sim_proc.physics.delay import CommandDelay


class Moment(NamedTuple):
    """What a motion changes. The parts that change in place are copies."""

    state: Floats
    """MuJoCo's integration state."""
    tick: int
    waiting: Waiting
    appeared: tuple[Appearance, ...]
    contacts: ContactWatch
    delay: CommandDelay
