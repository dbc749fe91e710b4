"""The exceptions of rvmon, all under one root.

::

    RvmonError
    ├── SpecError(ValueError)        a specification has errors; carries all diagnostics
    ├── ModelError(ValueError)       a model or query has errors; carries all diagnostics
    ├── TraceError(ValueError)       a recording or a sample has errors; names file and line
    │   ├── TimeOrderError           a sample is not later than the sample before it
    │   └── MissingNameError         a recording has no column for a name that is read
    ├── CoverageError(ValueError)    a coverage database has errors, or does not fit another
    ├── UnknownNameError(KeyError)   a requirement, signal or option of that name does not exist
    ├── SnapshotError(ValueError)    a monitor's snapshot does not belong to this spec
    ├── WorkerLostError              a worker process was killed from outside
    ├── OverlapError(RuntimeError)   a monitor was called during another call
    └── CoreError(ImportError)       the native core is not built, or differs from its sources
"""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from rvmon.texts import escaped

if TYPE_CHECKING:
    from collections.abc import Sequence

    from rvmon.diagnostics import Diagnostic


class RvmonError(Exception):
    """Base of all exceptions of rvmon; `str` of it contains no terminal escapes."""

    def __str__(self) -> str:
        return escaped(super().__str__())


class DiagnosedError(RvmonError, ValueError):
    """A specification, model or query has errors; `diagnostics` says where, why and the fix.

    Attributes:
        diagnostics: all diagnostics of the text, in order of place.
    """

    def __init__(self, diagnostics: Sequence[Diagnostic], rendered: str) -> None:
        super().__init__(rendered)
        self.diagnostics = tuple(diagnostics)

    def __reduce__(self) -> tuple[object, ...]:
        return type(self), (self.diagnostics, *self.args)


class SpecError(DiagnosedError):
    """A specification cannot be used; `diagnostics` lists all its errors."""


class ModelError(DiagnosedError):
    """A timed-automata model or a query on it cannot be used; `diagnostics` lists all errors."""


class TraceError(RvmonError, ValueError):
    """A recording or a sample cannot be read; the message names its place."""


class TimeOrderError(TraceError):
    """A sample is not later than the sample before it."""


class MissingNameError(TraceError):
    """A recording in columns lacks names that the judged requirements read; lists the names."""


class CoverageError(RvmonError, ValueError):
    """A coverage database cannot be read or written, or does not fit a model or another one."""


class UnknownNameError(RvmonError, KeyError):
    """A name does not exist; the message lists the existing ones."""

    def __str__(self) -> str:
        return escaped(str(self.args[0])) if self.args else ""


class SnapshotError(RvmonError, ValueError):
    """A snapshot was made by another specification or version."""


class WorkerLostError(RvmonError):
    """A worker process was killed from outside."""


class OverlapError(RvmonError, RuntimeError):
    """A monitor was called during another call of it; the refused call changed nothing."""


class CoreError(RvmonError, ImportError):
    """The native core is not built, or its sources have changed since it was built."""


EXTRAS = {
    "asammdf": "mdf",
    "backports.zstd": "zstd",
    "cantools": "can",
    "cbor2": "mcap",
    "coverage": "cdv",
    "cyclonedds": "dds",
    "distributed": "dask",
    "fsspec": "remote",
    "gymnasium": "gym",
    "h5py": "h5",
    "mcap": "mcap",
    "mcap-protobuf-support": "mcap",
    "paho-mqtt": "mqtt",
    "pyarrow": "arrow",
    "pygls": "lsp",
    "pymavlink": "mavlink",
    "pymunk": "handover",
    "python-can": "can",
    "pyulog": "px4",
    "rosbags": "ros",
    "scipy": "h5",
}
"""For each optional package, the extra of rvmon that installs it."""


@contextmanager
def needed(what: str, package: str) -> Iterator[None]:
    """Turn an `ImportError` in its block into the error of `not_installed`.

    Args:
        what: the feature that needs the package.
        package: as for `not_installed`.

    Raises:
        RvmonError: the package is not installed.

    >>> with needed("this", "nowhere"):
    ...     import nowhere
    Traceback (most recent call last):
        ...
    rvmon.errors.RvmonError: this needs nowhere, which is not installed: pip install nowhere
    """
    try:
        yield
    except ImportError:
        raise not_installed(what, package) from None


@contextmanager
def writing(path: object) -> Iterator[None]:
    """Turn an `OSError` in its block into a message about a file that the user named.

    Raises:
        RvmonError: the file cannot be written; the message says why.
    """
    try:
        yield
    except OSError as error:
        raise RvmonError(f"cannot write {path}: {error.strerror or error}") from None


def not_installed(what: str, package: str) -> RvmonError:
    """The error for a missing package, with the command that installs it.

    Args:
        what: the feature that needs the package.
        package: one of an extra of rvmon, or any other that rvmon can use.

    >>> print(not_installed("Parquet", "pyarrow"))
    Parquet needs pyarrow, which is not installed: pip install 'rvmon[arrow]'
    """
    extra = f"'rvmon[{EXTRAS[package]}]'" if package in EXTRAS else package
    return RvmonError(f"{what} needs {package}, which is not installed: pip install {extra}")
