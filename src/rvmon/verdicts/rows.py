"""Verdicts as rows of a table, one per attempt or requirement without attempts; data frames."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Mapping
from typing import TYPE_CHECKING, NamedTuple, get_args, get_type_hints

from rvmon.errors import needed
from rvmon.verdicts.attempt import Attempt
from rvmon.verdicts.report_json import encoded, seconds

if TYPE_CHECKING:
    import pandas
    import polars
    import pyarrow


class VerdictRow(NamedTuple):
    """An attempt; or a requirement that has none in a recording; or a recording without verdicts.

    Attributes:
        recording: its name.
        requirement: its id; `None` where the recording has no verdicts.
        attempt: its name, such as `R1#3`; `None` where there is none.
        number: from 1 per requirement; attempts in doubt are numbered separately.
        verdict: `P`, `F` or `I` of an attempt, `NT` or `I` of a requirement without one; `None`
            where the recording has none.
        decision: the way the attempt was settled, a value of `rvmon.verdicts.attempt.Decision`.
        in_doubt: whether the trigger itself is uncertain.
        triggered: instant, ns.
        decided: instant, ns; `None` if undecided.
        deadline: instant, ns; `None` if there is none.
        triggered_s: seconds since the recording's origin.
        decided_s: likewise.
        robustness: in SI units; `None` if not measured.
        captured: values captured by `let` and `for each`, as JSON; "" if there are none.
        reason: one sentence.
        error: the error of a recording without verdicts; else "".
    """

    recording: str
    requirement: str | None = None
    attempt: str | None = None
    number: int | None = None
    verdict: str | None = None
    decision: str | None = None
    in_doubt: bool = False
    triggered: int | None = None
    decided: int | None = None
    deadline: int | None = None
    triggered_s: float | None = None
    decided_s: float | None = None
    robustness: float | None = None
    captured: str = ""
    reason: str = ""
    error: str = ""


def broken_rows(recording: str, error: str, before: Iterable[Attempt]) -> Iterator[VerdictRow]:
    """The rows of a recording that broke off: one with the error, then the attempts before it."""
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
    """Rows as an Arrow table; `about` becomes metadata of its schema.

    Raises:
        RvmonError: pyarrow is needed.
    """
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
    """A table of verdicts as a pandas data frame; instants are the nullable `Int64`.

    Raises:
        RvmonError: pandas is needed.
    """
    with needed("this table", "pandas"):
        import pandas
    import pyarrow

    whole = {pyarrow.int64(): pandas.Int64Dtype()}
    frame: pandas.DataFrame = table.to_pandas(types_mapper=whole.get)
    return frame


def polars_frame(table: pyarrow.Table) -> polars.DataFrame:
    """A table of verdicts as a polars data frame.

    Raises:
        RvmonError: polars is needed.
    """
    with needed("this table", "polars"):
        import polars
    frame = polars.from_arrow(table)
    assert isinstance(frame, polars.DataFrame), "as a table is no column"
    return frame
