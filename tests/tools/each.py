"""Tests of many small cases, each of which takes less than a test by itself costs."""

import inspect
from collections.abc import Callable, Iterable, Sequence
from functools import wraps
from typing import Any

import pytest

Test = Callable[..., None]


def each(names: str | Sequence[str], cases: Iterable[Any]) -> Callable[[Test], Test]:
    """A test of all cases, one after the other, instead of a test for each.

    They share its fixtures. All are tried; each that fails has a note that names it, and several
    are raised as a group.

    Args:
        names: of the arguments that a case is, as `pytest.mark.parametrize` takes them.
        cases: a value for one name, else a tuple; perhaps a `pytest.param`.
    """
    given = [one.strip() for one in names.split(",")] if isinstance(names, str) else list(names)
    rows = [one if isinstance(one, _PARAM) else _row(given, one) for one in cases]
    assert rows, "a test of no case"

    def decorated(test: Test) -> Test:
        @wraps(test)
        def run(**fixtures: Any) -> None:
            failed: list[BaseException] = []
            for number, row in enumerate(rows, 1):
                try:
                    test(**fixtures, **dict(zip(given, row.values, strict=True)))
                except (Exception, pytest.fail.Exception) as error:  # noqa: BLE001 - raised below
                    name = row.id or ", ".join(map(repr, row.values))
                    error.add_note(f"case {number} of {len(rows)}: {name}")
                    failed.append(error)
            if len(failed) > 1:
                raise BaseExceptionGroup(f"{len(failed)} of {len(rows)} cases failed", failed)
            for only in failed:
                raise only

        own = inspect.signature(test)
        kept = [one for name, one in own.parameters.items() if name not in given]
        run.__signature__ = own.replace(parameters=kept)  # type: ignore[attr-defined]
        return run

    return decorated


_PARAM = type(pytest.param())


def _row(names: Sequence[str], case: Any) -> Any:
    return pytest.param(*case) if len(names) > 1 else pytest.param(case)
