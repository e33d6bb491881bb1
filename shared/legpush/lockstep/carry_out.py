"""Carries out one motion, and tells a motion that was refused from one at which the simulator failed."""

from msgspec.structs import replace

from legpush.errors import (
    BrokenEpisodeError,
    LegpushError,
    MotionError,
    OtherVersionError,
    RecordingError,
    ScenarioError,
)
from legpush.lockstep.simulator import Stepper
from legpush.messages import codec
from legpush.messages.stepping import Motion, Outcome


def carry_out(stepper: Stepper, motion: Motion, *, with_trace: bool) -> Outcome:
    """Carry out one motion, and return an outcome whose state a message can hold. Its trace is large and not checked.

    Raises:
        MotionError: The motion cannot be carried out; the state is as it was.
        ScenarioError: The world of a reset cannot be built; the state is as it was.
        RecordingError: The simulator plays a recording, which does not have this motion.
        OtherVersionError: The same, and the recording is of another version.
        BrokenEpisodeError: Another exception was raised, or the state holds a number that is not finite: nobody
            knows the state any more.
    """
    try:
        outcome = stepper.perform(motion, with_trace=with_trace)
        codec.encode(replace(outcome, trace=None))
    except (MotionError, ScenarioError, RecordingError, OtherVersionError):
        raise
    except Exception as error:
        what = str(error) if isinstance(error, LegpushError) else f"{type(error).__name__}: {error}"
        raise BrokenEpisodeError(f"The simulator failed in a {kind_of(motion)}: {what}") from error
    return outcome


def kind_of(motion: Motion) -> str:
    """Return the name of a kind of motion, for people."""
    return type(motion).__name__.lower()
