"""The measures of windows of the past: one entry each, shared by all users of windows."""

from __future__ import annotations

from enum import Enum, StrEnum


class Members(Enum):
    """What the members of a window are, as documentation names it."""

    TRUTHS = "a formula that is true at single instants"
    TIME = "a formula"
    EVENTS = "a field of an event, or one signal, at its updates"
    HELD = "signals"
    EITHER = "signals, or fields of an event, but not of both"


class Dimension(Enum):
    """The unit of a measure, as documentation names it."""

    PLAIN = "a plain number"
    TIME = "a duration"
    SAME = "its unit"
    TIMES_TIME = "its unit times s"
    SQUARE = "the square of its unit"


class Measured(StrEnum):
    """The measures of a formula or a number over a window, such as the last D.

    >>> Measured.SUM.dimension.value, Measured("integral").of.value
    ('its unit', 'signals')
    """

    COUNT = (
        *("count", Members.TRUTHS, Dimension.PLAIN, "how often φ was true in the last D"),
        *("between its extremes", 64, 128),
    )
    DURATION = (
        *("duration", Members.TIME, Dimension.TIME),
        "for how long φ was true in the last D, up to this instant",
        *("between its extremes", 64, 128),
    )
    SUM = (
        *("sum", Members.EVENTS, Dimension.SAME, "the sum of x over the last D"),
        *("unknown; between its extremes if only a condition is", 64, 980),
    )
    MEAN = (
        *("mean", Members.EITHER, Dimension.SAME),
        "the mean of x over all instants of the last D; of a field, over its occurrences",
        *("unknown, also without members", 64, 980),
    )
    INTEGRAL = (
        *("integral", Members.HELD, Dimension.TIMES_TIME),
        "x times the time for which it was held, in the last D, up to this instant",
        *("unknown; between its extremes if only a condition is", 64, 980),
    )
    VARIANCE = (
        *("variance", Members.EITHER, Dimension.SQUARE),
        "the mean squared deviation of x from its mean in the last D; in `time held`, of fields",
        *("unknown, also without members", 64, 980),
    )
    DELTA = (
        *("delta", Members.HELD, Dimension.SAME),
        "the increase of x since the first instant of the last D",
        *("unknown if either value is", 64, 128),
    )
    DISTINCT = (
        *("distinct", Members.EVENTS, Dimension.PLAIN),
        "the number of different values among the updates of x in the last D",
        *("at least the number of known values", 96, 128, False),
    )
    MIN = (
        *("min", Members.EITHER, Dimension.SAME, "the least value that x had in the last D"),
        *("between its extremes; unknown in an expression, or without members", 64, 128),
    )
    MAX = (
        *("max", Members.EITHER, Dimension.SAME, "the greatest value that x had in the last D"),
        *("between its extremes; unknown in an expression, or without members", 64, 128),
    )
    AGO = (
        *("ago", Members.HELD, Dimension.SAME, "the value of x D ago; only in `time held`"),
        *(
            "unknown if that value is; none until D has passed since the first known value of x",
            64,
            128,
        ),
    )

    of: Members
    dimension: Dimension
    doc: str  # its value in a few words
    unknown: str  # its value where a member of the window is unknown
    each: int  # the most bytes per member, or per stretch of equal members
    fixed: int  # bytes in addition to those of members
    steady: bool  # whether a window without D needs bounded memory, however long the run

    def __new__(
        cls,
        name: str,
        of: Members = Members.TIME,
        dimension: Dimension = Dimension.PLAIN,
        doc: str = "",
        unknown: str = "",
        each: int = 0,
        fixed: int = 0,
        steady: bool = True,
    ) -> Measured:
        """A member: the name of its function, with the rest of its entry."""
        member = str.__new__(cls, name)
        member._value_ = name
        member.of, member.dimension, member.doc, member.unknown = of, dimension, doc, unknown
        member.each, member.fixed, member.steady = each, fixed, steady
        return member

    @property
    def memory(self) -> str:
        """The memory that a window needs, in words."""
        return f"{self.fixed} bytes, and up to {self.each} per member or stretch of equal members"

    @property
    def of_numbers(self) -> bool:
        """Whether its members are numbers, not truths of a formula."""
        return self.of not in (Members.TRUTHS, Members.TIME)

    @property
    def asks_for_one(self) -> bool:
        """Whether it has no value without a member, and so is unborn until its numbers are born."""
        return self.dimension in (Dimension.SAME, Dimension.SQUARE) and self is not Measured.SUM

    @property
    def recalls(self) -> bool:
        """Whether its value is one of the values in the window."""
        return self in (Measured.MIN, Measured.MAX, Measured.AGO)

    @property
    def of_time(self) -> bool:
        """Whether it integrates over time, so that stretches between positions count."""
        return self.dimension in (Dimension.TIME, Dimension.TIMES_TIME)
