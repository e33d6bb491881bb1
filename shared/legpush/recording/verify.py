"""`legpush replay --verify`: sends the recorded motions to a fresh simulator, which must give the recorded answers."""

from collections.abc import Callable, Iterable
from dataclasses import dataclass
from typing import Protocol

from legpush.errors import MotionError, RecordingError
from legpush.messages.stepping import Motion, Outcome, Reset
from legpush.numerics.computed_with import ComputedWith
from legpush.recording.damage import damage_of
from legpush.recording.episodes import Asked, Damage, EpisodeRecord, difference, read_episodes, same
from legpush.recording.facts import STILL, recorded_with
from legpush.recording.mcap_file.contents import Recording
from legpush.scene.conventions import CONTROL_PERIOD_S


class Perform(Protocol):
    """A simulator; a `Reset` begins a new episode."""

    def __call__(self, motion: Motion, *, with_trace: bool) -> Outcome:
        """Carry out one motion.

        Raises:
            MotionError: The motion cannot be carried out.
        """


@dataclass(frozen=True, kw_only=True)
class Divergence:
    """The first difference between a recording and a simulator."""

    episode: int
    step: int
    field: str
    expected: str
    got: str
    is_damage: bool = False
    """Whether the recording is damaged there, so that it says nothing about the simulator."""

    def __str__(self) -> str:
        """Return a sentence for people."""
        where = f"episode {self.episode}, step {self.step}, field {self.field}"
        return f"first divergence at {where}: expected {self.expected}, got {self.got}"


@dataclass(frozen=True, kw_only=True)
class Verified:
    """How far recording and simulator agree."""

    n_steps: int
    n_ticks: int
    """Number of simulated ticks in all these steps."""
    divergence: Divergence | None


@dataclass(frozen=True, kw_only=True)
class Checked:
    """What is identical in a recording, and what is damaged or missing."""

    verified: Verified | None
    """None if the steps cannot be verified because of the damage."""
    why_not: str = ""
    """Why they cannot be verified."""
    damage: list[str]
    other_version: str = ""
    """Says that the recording has other bits because it is of another version; empty if it is not so."""
    other_numerics: str = ""
    """Why other bits are no surprise: the recording has other numerics; empty if they are the same."""

    @property
    def is_sound(self) -> bool:
        """Whether all steps are identical and nothing is damaged."""
        return self.verified is not None and self.verified.divergence is None and not self.damage

    def words(self, wall_s: float) -> str:
        """Return the result as lines for people; the verification took `wall_s`."""
        damaged = f"damaged: {', '.join(self.damage)}" if self.damage else ""
        if self.verified is None:
            return f"not verified: {self.why_not}\n{damaged}\n"
        if self.other_version:
            return f"{self.other_version}; {STILL}\n" + (f"{damaged}\n" if damaged else "")
        if self.verified.divergence is not None:
            found = str(self.verified.divergence)
            if self.other_numerics:
                found = f"{self.other_numerics}; {found.replace('divergence', 'difference', 1)}"
            return f"{found}\n" + (f"{damaged}\n" if damaged else "")
        seconds = self.verified.n_ticks * CONTROL_PERIOD_S
        steps = f"identical: {self.verified.n_steps} steps, {seconds:.1f} s simulated in {wall_s:.1f} s"
        return f"steps {steps}; {damaged}\n" if damaged else f"{steps}\n"


def check(
    recording: Recording,
    perform: Perform,
    numerics: Callable[[], str],
    progress: Callable[[str], None] = lambda text: None,
) -> Checked:
    """Do every step again, up to the first divergence, and list all damage.

    `numerics` returns the name of the simulator's numerics; it is called only if the simulator diverges.

    Raises:
        RecordingError: There are no steps, or steps are missing, although nothing is damaged.
    """
    damage = damage_of(recording)
    try:
        verified = verify(_episodes(recording), perform, progress)
    except RecordingError as error:
        if not damage:
            raise
        return Checked(verified=None, why_not=str(error), damage=damage)
    recorded = _recorded_with(recording)
    if verified.divergence is None or verified.divergence.is_damage or recorded is None:
        return Checked(verified=verified, damage=damage)
    if other := recorded.other_version():
        return Checked(verified=verified, damage=damage, other_version=other)
    return Checked(verified=verified, damage=damage, other_numerics=recorded.other_numerics(numerics()))


def _recorded_with(recording: Recording) -> ComputedWith | None:
    """Return what the recording was computed with; None if that is not known."""
    try:
        return recorded_with(recording)
    except RecordingError:  # the file that notes it is damaged, which is told as damage
        return None


def _episodes(recording: Recording) -> list[EpisodeRecord]:
    episodes = read_episodes(recording)
    if not any(episode.carried_out() or episode.damage for episode in episodes):
        raise RecordingError(
            f"{recording.files[0]}: expected a recording with an episode from its reset on, got one of "
            f"{len(recording.messages)} messages without one"
        )
    return episodes


def verify(
    episodes: Iterable[EpisodeRecord], perform: Perform, progress: Callable[[str], None] = lambda text: None
) -> Verified:
    """Do every step of every episode again, up to the first divergence.

    Raises:
        RecordingError: Steps are missing.
    """
    n_steps = n_ticks = 0
    for episode in episodes:
        require_steps(episode)
        for number in range(max([*episode.steps, *(d.step for d in episode.damage)], default=-1) + 1):
            progress(f"{episode.label}, step {number}")
            damage = next((d for d in episode.damage if d.step == number), None)
            found = _damaged(episode, damage) if damage is not None else None
            for asked in episode.steps.get(number, []):
                found = found or _compare(episode, number, asked, perform)
                n_steps += asked.answer is not None and found is None
            if found is not None:
                return Verified(n_steps=n_steps, n_ticks=n_ticks, divergence=found)
        last = episode.carried_out()[-1:]
        n_ticks += sum(one.outcome.world.tick for one in last if one.outcome is not None)
    return Verified(n_steps=n_steps, n_ticks=n_ticks, divergence=None)


def require_steps(episode: EpisodeRecord) -> None:
    """Check that every step from the reset on is in the recording.

    Raises:
        RecordingError: One is not.
    """
    damaged = {damage.step for damage in episode.damage}
    for number in range(max(episode.steps, default=-1) + 1):
        if number not in episode.steps and number not in damaged:
            raise RecordingError(
                f"{episode.label} (simulator {episode.sim}): expected steps 0 to {max(episode.steps)}, but step "
                f"{number} is not in the recording; `legpush info` says what is missing"
            )
    first = episode.steps.get(0)
    if first and not isinstance(first[0].motion, Reset):
        raise RecordingError(f"{episode.label}: expected a reset as step 0, got {type(first[0].motion).__name__}")


def _damaged(episode: EpisodeRecord, damage: Damage) -> Divergence:
    return Divergence(
        episode=episode.index,
        step=damage.step,
        field=damage.field,
        expected=damage.expected,
        got=damage.got,
        is_damage=True,
    )


def _compare(episode: EpisodeRecord, step: int, asked: Asked, perform: Perform) -> Divergence | None:
    """Do one step again, if it was answered."""

    def parted(field: str, expected: str, got: str) -> Divergence:
        return Divergence(episode=episode.index, step=step, field=field, expected=expected, got=got)

    if not asked.is_told:
        return None
    expected = asked.outcome
    try:
        outcome = perform(asked.motion, with_trace=asked.with_trace)
    except MotionError as error:
        if expected is None and str(error).endswith(asked.refusal or ""):
            return None
        return parted("kind", "observation" if expected else f"refusal: {asked.refusal}", f"refusal: {error}")
    if expected is None:
        return parted("kind", f"refusal: {asked.refusal}", "observation")
    return None if same(expected, outcome) else parted(*difference(expected, outcome))
