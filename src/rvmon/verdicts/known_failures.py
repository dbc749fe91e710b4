"""Known failures: a file that lists which failures are accepted, why, and until when."""

from __future__ import annotations

import datetime
from collections.abc import Collection, Iterator, Sequence
from fnmatch import fnmatchcase
from pathlib import Path, PurePath

import msgspec
from msgspec import Struct, field

from rvmon.errors import RvmonError
from rvmon.texts import did_you_mean
from rvmon.verdicts import Verdict
from rvmon.verdicts.report import Report


class KnownFailure(msgspec.Struct, frozen=True, forbid_unknown_fields=True):
    """A requirement that is accepted to fail."""

    requirement: str  # its id
    reason: str  # the reason for accepting the failure
    until: datetime.date  # the last day on which it is accepted
    # pattern of the recordings, such as `monday/*.csv`, matched against the whole name or its last
    # segments; `*` stands for any characters
    recording: str = "*"

    def is_about(self, recording: str, requirement: str) -> bool:
        """Whether it concerns a requirement in a recording, regardless of `until`.

        >>> known = KnownFailure("R1", "worn", datetime.date(2030, 1, 31), "monday/*.csv")
        >>> known.is_about("logs/monday/3.csv", "R1"), known.is_about("logs/tuesday/3.csv", "R1")
        (True, False)
        """
        if requirement != self.requirement:
            return False
        parts = PurePath(recording).parts
        ends = ["/".join(parts[start:]) for start in range(len(parts))]
        return any(fnmatchcase(name, self.recording) for name in (recording, *ends))


class KnownFailures(Struct, frozen=True):
    """The failures accepted on a day; an entry whose `until` is earlier accepts nothing."""

    known: Sequence[KnownFailure] = ()
    today: datetime.date = field(default_factory=datetime.date.today)

    def accepting(self, recording: str, requirement: str) -> KnownFailure | None:
        """The entry that accepts a failure of a requirement in a recording; `None` if none."""
        about = (failure for failure in self.known if failure.is_about(recording, requirement))
        return next((failure for failure in about if self.today <= failure.until), None)

    def failures(self, report: Report) -> list[str]:
        """The requirements whose failure in a recording is not accepted."""
        return [
            name
            for name, verdict in report.verdicts.items()
            if verdict is Verdict.FAIL and self.accepting(report.trace, name) is None
        ]

    def expected(self, report: Report) -> dict[str, str]:
        """The requirements that may fail in a recording, each with the reason and the last day."""
        accepted = ((name, self.accepting(report.trace, name)) for name in report.verdicts)
        return {
            name: f"{failure.reason} (until {failure.until})"
            for name, failure in accepted
            if failure is not None
        }

    def remarks(self, reports: Sequence[Report]) -> Iterator[str]:
        """Remarks on expired entries that still fail and on entries that no longer fail."""
        for failure in self.known:
            about = [
                (report.trace, report.verdicts[failure.requirement])
                for report in reports
                if failure.requirement in report.verdicts
                and failure.is_about(report.trace, failure.requirement)
            ]
            failed = [trace for trace, verdict in about if verdict is Verdict.FAIL]
            what = f"{failure.requirement} ({failure.reason})"
            if failed and self.today > failure.until:
                until = failure.until
                yield f"{what} was known to fail until {until}, and still fails: {failed[0]}"
            elif about and not failed:
                yield f"{what} is known to fail, but does not: remove it from the file"


NONE_KNOWN = KnownFailures()  # no failure is accepted


class _File(msgspec.Struct, forbid_unknown_fields=True):
    known: list[KnownFailure] = []


def read_known(path: str | Path, requirements: Collection[str]) -> list[KnownFailure]:
    """Read a file of known failures: TOML with a table `[[known]]` for each.

    Raises:
        RvmonError: the file cannot be read, is malformed, or has an unknown requirement.
    """
    import tomllib  # imported late: most runs have no such file

    try:
        failures = msgspec.convert(tomllib.loads(Path(path).read_text("utf-8")), _File).known
    except OSError as error:
        raise RvmonError(f"cannot read {path}: {error.strerror or error}") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError, msgspec.ValidationError) as error:
        raise RvmonError(
            f"{path}: {error}: a known failure is a table [[known]] with requirement, reason, "
            'until = 2030-01-31, and recording = "*.csv" if it is about some only'
        ) from None
    for failure in failures:
        if failure.requirement not in requirements:
            meant = did_you_mean(failure.requirement, list(requirements), "see `rvmon check`")
            raise RvmonError(f"{path}: no requirement `{failure.requirement}`: {meant}")
        if not failure.reason.strip():
            raise RvmonError(f"{path}: {failure.requirement}: say in `reason` why it may fail")
    return failures
