"""A looked-over recording as the text of a specification."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from pathlib import Path

from rvmon.spec.print.formatter import format_text
from rvmon.spec.print.printer import format_duration
from rvmon.starter.column import Column, Profile
from rvmon.starter.skeletons import Skeleton, name_text, round_up, skeletons_of
from rvmon.trace.schema import Kind
from rvmon.trace.time import TICKS_PER_SECOND

_LISTED = 6
"""Names that are listed with the reason why they are not declared."""


def starter_text(profile: Profile) -> str:
    """A starter specification in the canonical layout; it runs on the recording as it is."""
    skeletons = skeletons_of(profile)
    read = {name for skeleton in skeletons for name in skeleton.names}
    lines = [*_header(profile), ""]
    lines += [_declaration(column) for column in profile.columns if column.name in read]
    for number, skeleton in enumerate(skeletons, 1):
        lines += ["", *_requirement(f"R{number}", skeleton)]
    others = [column for column in profile.columns if column.name not in read]
    if others:
        # What is declared and not read would be warned of.
        lines += ["", "# What else there is: take away the `#` before what a requirement reads."]
        lines += [f"# {_declaration(column)}" for column in others]
    if profile.left_out:
        lines += ["", "# What cannot be declared as it is:"]
        lines += [f"#   {name}: {why}" for why, name in _by_reason(profile.left_out)]
    return format_text("\n".join(lines) + "\n")


def _by_reason(left_out: Mapping[str, str]) -> Iterator[tuple[str, str]]:
    names: dict[str, list[str]] = {}
    for name, why in left_out.items():
        names.setdefault(why, []).append(_plain(name))
    for why, own in names.items():
        more = f" and {len(own) - _LISTED} more" if len(own) > _LISTED else ""
        yield why, f"{', '.join(own[:_LISTED])}{more}"


def _header(profile: Profile) -> Iterator[str]:
    file = Path(profile.path).name
    stem = re.sub(r"\W", "_", Path(profile.path).stem) or "recording"
    span = (profile.end - profile.start) / TICKS_PER_SECOND
    name = stem if stem[0].isalpha() else f"recording_{stem}"
    yield f"# From {_plain(file)}: {profile.samples} samples in {span:.6g} s."
    units = (
        "" if any(column.shape.unit for column in profile.columns) else "units (`real [m/s]`) and "
    )
    yield f"# The types are guessed; add {units}roles (`input`, `output`)."
    yield f'spec {name_text(name)} "{_plain(stem)}"'
    yield "time held"
    if profile.lateness:
        late = profile.lateness / TICKS_PER_SECOND
        yield f"max delay {round_up(profile.lateness)}  # stamps go back by up to {late:.6g} s"


def _declaration(column: Column) -> str:
    remark = "; ".join(_remarks(column))
    line = _declared(column)
    return f"{line}  # {remark}" if remark else line


def _declared(column: Column) -> str:
    name, shape = name_text(column.name), column.shape
    if shape.kind is None:
        fields = ", ".join(f"{field}: {kind}" for field, kind in shape.fields.items())
        return f"event  {name}({fields})" if fields else f"event  {name}"
    if shape.kind is Kind.LABEL:
        return f"signal {name} : {{{', '.join(map(name_text, shape.labels))}}}"
    unit = f" [{shape.unit}]" if shape.unit else ""
    return f"signal {name} : {shape.kind}{unit}"


def _remarks(column: Column) -> Iterator[str]:
    if column.is_event:
        yield f"{column.updates} times" if column.updates != 1 else "once"
        if column.guessed_event:
            yield "a guess: true in single samples"
        return
    if column.low is not None and column.high is not None:
        low, high = f"{column.low + 0:.6g}", f"{column.high + 0:.6g}"
        yield f"always {low}" if column.low == column.high else f"{low} … {high}"
    if column.rate:
        gap = format_duration(column.longest_gap)
        if len(gap) > 8:
            gap = f"{column.longest_gap / TICKS_PER_SECOND:.3g} s"
        yield f"{column.rate:.3g} Hz, longest gap {gap}"
    elif column.updates == 1:
        yield "one value"
    elif not column.updates:
        yield "no value"


def _requirement(name: str, skeleton: Skeleton) -> Iterator[str]:
    yield f'requirement {name} "{_plain(skeleton.title)}"'
    for line in skeleton.body:
        yield f"  {line}"
    yield f"  # {skeleton.remark}"


def _plain(text: str) -> str:
    """Text that cannot end a line, a comment or a string."""
    return "".join(char if char.isprintable() and char not in '"\\' else "_" for char in text)
