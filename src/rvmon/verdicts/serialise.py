"""Conversion of reports to JSON and back, and of verdicts to table rows and data frames."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Annotated, Any, Literal, NamedTuple, get_args, get_type_hints

import msgspec

from rvmon.errors import TraceError, needed
from rvmon.trace.sample import Health
from rvmon.trace.time import TICKS_PER_SECOND
from rvmon.verdicts import LAW, Verdict
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.run_coverage import CoveredGroup, IllegalHit

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow

    from rvmon.language.checked.specification import Requirement


_ALWAYS = ("number", "triggered", "decided", "verdict", "decision", "reason")
"""The keys that every attempt has in JSON; other keys are omitted if empty."""

_UNLESS_EMPTY = ("at_trigger", "at_decision", "required", "captured", "blame", "forecast")


def packed(attempt: Attempt) -> msgspec.Raw:
    """The `record` of an attempt as JSON text, which takes much less memory than the object."""
    return msgspec.Raw(msgspec.json.encode(record(attempt)))


def record(attempt: Attempt) -> dict[str, object]:
    """The JSON object of an attempt, without requirement and origin.

    Instants are in ticks; those whose key ends in `_s` are in seconds since the origin.
    """
    shown: dict[str, object] = {name: getattr(attempt, name) for name in _ALWAYS}
    if attempt.deadline is not None:
        shown["deadline"] = attempt.deadline
    for name in _UNLESS_EMPTY:
        if value := getattr(attempt, name):
            shown[name] = value
    if attempt.robustness is not None:
        shown["robustness"] = attempt.robustness
    if attempt.in_doubt:
        shown["in_doubt"] = True
    return shown | seconds(attempt)


def seconds(attempt: Attempt) -> dict[str, float | None]:
    """The trigger and the decision of an attempt in seconds since the origin of its run."""
    origin, decided = attempt.origin, attempt.decided
    return {
        "triggered_s": (attempt.triggered - origin) / TICKS_PER_SECOND,
        "decided_s": None if decided is None else (decided - origin) / TICKS_PER_SECOND,
    }


def encoded(value: object) -> str:
    """A value as JSON text."""
    return msgspec.json.encode(value).decode()


class RequirementJson(msgspec.Struct):
    """One requirement of a report."""

    attempts: list[dict[str, Any]]
    verdict: Verdict
    nearest_miss: str = ""
    late: dict[int, int] = {}
    values: dict[int, dict[str, str]] = {}
    dropped: dict[Literal["P", "F", "I"], Annotated[int, msgspec.Meta(gt=0)]] = {}


class ReportJson(msgspec.Struct):
    """The JSON document of a report; counts are not read but recomputed."""

    requirements: dict[str, RequirementJson]
    health: list[Health]
    law: int = 1  # version 1 did not write it
    trace: str = ""
    origin: int = 0
    end: int | None = None
    goals: dict[str, Verdict] = {}
    illegal: tuple[IllegalHit, ...] = ()
    coverage: tuple[CoveredGroup, ...] = ()


def labels(requirement: Requirement | None) -> dict[str, object]:
    """A requirement's severity and tags, without those that are not set."""
    if requirement is None:
        return {}
    members = {"severity": requirement.severity, "tags": requirement.tags}
    return {name: value for name, value in members.items() if value}


def encode_broken(trace: str, error: str, before: Sequence[Attempt]) -> str:
    """The JSON text for a recording that broke off: its error and the attempts before it.

    It contains no verdicts, because later samples could have changed them.
    """
    attempts: dict[str, list[dict[str, object]]] = {}
    for attempt in before:
        attempts.setdefault(attempt.requirement, []).append(record(attempt))
    return encoded({"law": LAW, "trace": trace, "error": error, "judged_before": attempts})


def decode(text: str | bytes) -> tuple[ReportJson, list[Attempt]]:
    """Decode a report written by `Report.to_json` into the document and its attempts.

    Raises:
        TraceError: the text is not a report.
    """
    try:
        document = msgspec.json.decode(text, type=ReportJson)
        attempts = [
            msgspec.convert(shown | {"requirement": name, "origin": document.origin}, Attempt)
            for name, entry in document.requirements.items()
            for shown in entry.attempts
        ]
    except (msgspec.DecodeError, msgspec.ValidationError, UnicodeDecodeError) as error:
        raise TraceError(f"this is not a report of rvmon: {error}") from None
    return document, attempts


class VerdictRow(NamedTuple):
    """One attempt, one requirement without attempts, or one recording without verdicts."""

    recording: str
    requirement: str | None = None  # its id; `None` if the recording has no verdicts
    attempt: str | None = None  # its name, such as `R1#3`; `None` without attempts
    number: int | None = None  # from 1 per requirement; attempts in doubt are numbered separately
    # `P`, `F` or `I` of an attempt, `NT` or `I` of a requirement without attempts; `None` if the
    # recording has no verdicts
    verdict: str | None = None
    # the way the attempt was settled, a value of `rvmon.verdicts.attempt.Decision`
    decision: str | None = None
    in_doubt: bool = False  # whether the trigger itself is uncertain
    triggered: int | None = None  # instant, ns
    decided: int | None = None  # instant, ns; `None` if undecided
    deadline: int | None = None  # instant, ns; `None` if there is none
    triggered_s: float | None = None  # seconds since the recording's origin
    decided_s: float | None = None  # seconds since the recording's origin
    robustness: float | None = None  # in SI units; `None` if not measured
    captured: str = ""  # values captured by `let` and `for each`, as JSON; "" if there are none
    reason: str = ""  # one sentence
    error: str = ""  # the error of a recording without verdicts; else ""


def broken_rows(recording: str, error: str, before: Iterable[Attempt]) -> Iterator[VerdictRow]:
    """The rows of a recording that broke off: first the error, then the attempts before it."""
    yield VerdictRow(recording, error=error)
    for attempt in before:
        yield attempt_row(recording, attempt)._replace(error=error)


def attempt_row(recording: str, attempt: Attempt) -> VerdictRow:
    """The row of an attempt in a recording."""
    since = seconds(attempt)
    return VerdictRow(
        recording,
        attempt.requirement,
        attempt.name,
        attempt.number,
        attempt.verdict.value,
        attempt.decision.value,
        attempt.in_doubt,
        attempt.triggered,
        attempt.decided,
        attempt.deadline,
        since["triggered_s"],
        since["decided_s"],
        attempt.robustness,
        encoded(attempt.captured) if attempt.captured else "",
        attempt.reason,
    )


def column_types() -> dict[str, type]:
    """The type of each column; all but `str` and `bool` are nullable."""
    hints = get_type_hints(VerdictRow)
    return {name: (get_args(hint) or (hint,))[0] for name, hint in hints.items()}


def arrow_table(rows: Iterable[VerdictRow], about: Mapping[str, str]) -> pyarrow.Table:
    """Rows as an Arrow table; `about` becomes metadata of its schema."""
    with needed("this table", "pyarrow"):
        import pyarrow
    types = {
        str: pyarrow.string(),
        int: pyarrow.int64(),
        float: pyarrow.float64(),
        bool: pyarrow.bool_(),
    }
    schema = pyarrow.schema(
        {name: types[kind] for name, kind in column_types().items()},
        metadata={f"rvmon.{key}": text for key, text in about.items()},
    )
    # Without rows, `zip` gives no columns.
    columns = list(zip(*rows, strict=True)) or [() for _ in schema]
    return pyarrow.table(dict(zip(schema.names, columns, strict=True)), schema=schema)


def pandas_frame(table: pyarrow.Table) -> pandas.DataFrame:
    """A table of verdicts as a pandas data frame; instants are the nullable `Int64`."""
    with needed("this table", "pandas"):
        import pandas
    import pyarrow

    whole = {pyarrow.int64(): pandas.Int64Dtype()}
    frame: pandas.DataFrame = table.to_pandas(types_mapper=whole.get)
    return frame


def polars_frame(table: pyarrow.Table) -> polars.DataFrame:
    """A table of verdicts as a polars data frame."""
    with needed("this table", "polars"):
        import polars
    frame = polars.from_arrow(table)
    assert isinstance(frame, polars.DataFrame), "as a table is no column"
    return frame
