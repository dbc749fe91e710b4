"""Failures that are known: a file says which, why they are accepted, and until when."""

from __future__ import annotations

import datetime
import tomllib
from collections.abc import Collection, Iterator, Sequence
from dataclasses import dataclass, field
from fnmatch import fnmatchcase
from pathlib import Path, PurePath

import msgspec

from rvmon.errors import RvmonError
from rvmon.texts import did_you_mean
from rvmon.verdict import Verdict
from rvmon.verdict.report import Report


class KnownFailure(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A requirement that is accepted to fail.

    Attributes:
        requirement: its id.
        reason: why that is accepted, for people.
        until: the last day on which it is.
        recording: pattern of the recordings in which it is, such as `monday/*.csv`, for the whole
            name or its end; `*` stands for any characters.
    """

    requirement: str
    reason: str
    until: datetime.date
    recording: str = "*"

    def is_about(self, recording: str, requirement: str) -> bool:
        """Whether it accepts that a requirement fails in a recording, but for its last day.

        >>> known = KnownFailure("R1", "worn", datetime.date(2030, 1, 31), "monday/*.csv")
        >>> known.is_about("logs/monday/3.csv", "R1"), known.is_about("logs/tuesday/3.csv", "R1")
        (True, False)
        """
        if requirement != self.requirement:
            return False
        parts = PurePath(recording).parts
        ends = ["/".join(parts[start:]) for start in range(len(parts))]
        return any(fnmatchcase(one, self.recording) for one in (recording, *ends))


@dataclass(frozen=True, slots=True)
class KnownFailures:
    """What is accepted on a day.

    Attributes:
        known: in the order of the file.
        today: later than its last day, a known failure is a failure again.
    """

    known: Sequence[KnownFailure] = ()
    today: datetime.date = field(default_factory=datetime.date.today)

    def accepting(self, recording: str, requirement: str) -> KnownFailure | None:
        """What accepts that a requirement fails in a recording, if something does."""
        about = (one for one in self.known if one.is_about(recording, requirement))
        return next((one for one in about if self.today <= one.until), None)

    def failures(self, report: Report) -> list[str]:
        """The requirements that fail in a recording and are not accepted to."""
        return [
            name
            for name, verdict in report.verdicts.items()
            if verdict is Verdict.FAIL and self.accepting(report.trace, name) is None
        ]

    def expected(self, report: Report) -> dict[str, str]:
        """The requirements that are accepted to fail in a recording, each with reason and day."""
        found = ((name, self.accepting(report.trace, name)) for name in report.verdicts)
        return {name: f"{one.reason} (until {one.until})" for name, one in found if one is not None}

    def remarks(self, reports: Sequence[Report]) -> Iterator[str]:
        """What has to be reported of the file: what is over, and what is needed no more."""
        for one in self.known:
            about = [
                (report.trace, report.verdicts[one.requirement])
                for report in reports
                if one.requirement in report.verdicts
                and one.is_about(report.trace, one.requirement)
            ]
            failed = [trace for trace, verdict in about if verdict is Verdict.FAIL]
            what = f"{one.requirement} ({one.reason})"
            if failed and self.today > one.until:
                yield f"{what} was known to fail until {one.until}, and fails still: {failed[0]}"
            elif about and not failed:
                yield f"{what} is known to fail, and does not: take it out of the file"


NONE_KNOWN = KnownFailures()
"""Nothing is accepted to fail."""


class _File(msgspec.Struct, forbid_unknown_fields=True):
    known: list[KnownFailure] = []


def read_known(path: str | Path, requirements: Collection[str]) -> list[KnownFailure]:
    """Read a file of known failures: TOML, a table `[[known]]` for each.

    Args:
        path: of the file.
        requirements: ids of those that there are.

    Raises:
        RvmonError: it cannot be read, is wrong, or names no requirement; the message says where.
    """
    try:
        found = msgspec.convert(tomllib.loads(Path(path).read_text("utf-8")), _File).known
    except OSError as error:
        raise RvmonError(f"cannot read {path}: {error.strerror or error}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, msgspec.ValidationError) as error:
        raise RvmonError(
            f"{path}: {error}: a known failure is a table [[known]] with requirement, reason, "
            'until = 2030-01-31, and recording = "*.csv" if it is about some only'
        ) from None
    for one in found:
        if one.requirement not in requirements:
            meant = did_you_mean(one.requirement, list(requirements), "see `rvmon check`")
            raise RvmonError(f"{path}: no requirement `{one.requirement}`: {meant}")
    return found
