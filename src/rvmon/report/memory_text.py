"""The memory of measured windows, in words."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.language.checked.classify import windows_of
from rvmon.language.checked.formula import WindowValue
from rvmon.language.checked.specification import CheckedSpec, Requirement
from rvmon.language.print import format_duration, format_window


def memory_lines(spec: CheckedSpec) -> list[str]:
    r"""A line for each window of each requirement, and one for their sum, in bytes.

    >>> import rvmon
    >>> text = "event e\nrequirement R\n  always count(e, 5 s) <= 3\n"
    >>> memory_lines(rvmon.loads(text).checked)
    ['memory: R keeps count(e, 5 s) in 128 bytes, and up to 64 a member in the last 5 s']
    """
    return [line for requirement in spec.requirements.values() for line in _lines(requirement)]


def _lines(requirement: Requirement) -> Iterator[str]:
    windows = {
        format_window(window): window
        for window in windows_of(requirement.trigger, requirement.consequent)
    }
    again = ""
    if requirement.for_each is not None:
        again = f", for each {requirement.for_each.name} anew"
    elif requirement.captures:
        again = ", for each open attempt anew"
    for text, window in windows.items():
        yield f"memory: {requirement.id} keeps {text} in {_of(window)}{again}"
    if len(windows) > 1:
        fixed = sum(_fixed(window) for window in windows.values())
        yield f"memory: {requirement.id} keeps {fixed:,} bytes in all, and what is in its windows"


def _fixed(window: WindowValue) -> int:
    return window.measured.fixed + window.measured.each * (window.most or 0)


def _of(window: WindowValue) -> str:
    each = f"and up to {window.measured.each} a member"
    if window.most is not None:
        return f"{_fixed(window):,} bytes at most"
    if window.window is not None:
        return f"{_fixed(window):,} bytes, {each} in the last {format_duration(window.window)}"
    if not window.measured.steady:
        return f"{_fixed(window):,} bytes, {each} of another value"
    return f"{_fixed(window):,} bytes, however long the run"
