"""The errors that legpush reports to its user: one sentence each, no traceback."""


class LegpushError(Exception):
    """Something the user, a peer process or a file got wrong; its text says what was expected, what came and where."""


class ScenarioError(LegpushError):
    """A scenario file that cannot be used; names the file and the field."""


class MessageError(LegpushError):
    """Bytes that are not a valid message; names the path of the first field that is wrong."""


class PeerError(LegpushError):
    """A peer process that is missing, frozen, refuses, or answers something else; names the peer and the step."""


class JournalError(LegpushError):
    """An episode journal that does not belong to this run or contradicts it; names the entry."""


class MotionError(LegpushError):
    """A motion that the simulator cannot carry out in its present state, such as walking before a path was given."""
