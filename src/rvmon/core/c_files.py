"""Exports a specification as C that runs without rvmon: the core, and the plan it interprets."""

from __future__ import annotations

import re
import sys
from array import array
from collections import Counter
from collections.abc import Iterator, Sequence
from pathlib import Path
from textwrap import wrap

from rvmon.core.pack import pack
from rvmon.core.sections import Packed
from rvmon.errors import RvmonError
from rvmon.language.checked.specification import CheckedSpec, Type
from rvmon.logic.plan import Plan
from rvmon.native import memory_of, sources
from rvmon.trace.schema import Kind
from rvmon.version import __version__

_CORES = "rv"  # the prefix of the core's own identifiers
_PLAIN = frozenset(range(0x20, 0x7F)) - frozenset(map(ord, '"?\\'))
"""The bytes that stand for themselves in a string literal; a `?` may start a trigraph."""


def prefix_of(name: str) -> str:
    """The prefix of all identifiers of a specification.

    >>> prefix_of("Base v2"), prefix_of("2nd"), prefix_of("rv"), prefix_of("名前")
    ('base_v2', 'spec_2nd', 'spec_rv', 'spec')
    """
    made = _safe(name).lower()
    return made if made and made[0].isalpha() and made != _CORES else f"spec_{made}".rstrip("_")


def identifiers(names: Sequence[str]) -> list[str]:
    """Distinct identifiers for names, to follow a prefix.

    Names that would get the same identifier have their number appended; no other identifier can
    equal the result, as its `n` is lower case.

    >>> identifiers(["speed", "the speed", "the_speed", "名前"])
    ['SPEED', 'THE_SPEED_n1', 'THE_SPEED_n2', 'n3']
    """
    made = [_safe(name).upper() for name in names]
    count = Counter(made)
    return [
        one if one and count[one] == 1 else f"{one}_n{number}".lstrip("_")
        for number, one in enumerate(made)
    ]


def string(text: str) -> str:
    r"""A string literal with the text in UTF-8.

    >>> print(string('a "b" ??/ ä'))
    "a \042b\042 \077\077/ \303\244"
    """
    data = text.encode("utf-8", "surrogatepass")
    return '"' + "".join(chr(one) if one in _PLAIN else f"\\{one:03o}" for one in data) + '"'


def _safe(name: str) -> str:
    """The ASCII letters and digits of a name, with one underscore for each gap between them."""
    return re.sub(r"[^A-Za-z0-9]+", "_", name).strip("_")


_HARMLESS = {"\\": "/", '"': "'", "*/": "* /", "/*": "/ *"}
"""The characters that could end a comment or a docstring, replaced in this order."""


def comment(text: str) -> str:
    r"""A text as one line that cannot end a comment of C or Python, nor a docstring.

    >>> comment('*\\ int x; /*')
    '* // int x; / *'
    """
    text = ascii(text)[1:-1]
    for sign, harmless in _HARMLESS.items():
        text = text.replace(sign, harmless)
    return text


CORE = "rvmon_core"  # the name of the core's files
ALIGNMENT = 16  # the most bytes lost to aligning the start of a block
FEWEST, MOST = 4, 64
"""The least and most open attempts for which the memory they take is measured."""


def c_files(plan: Plan) -> dict[str, str]:
    """The texts of all files by name: C99, and a header for C++11.

    Args:
        plan: the plan to run without rvmon.

    Raises:
        RvmonError: there is no requirement, an expression exceeds the limits of the core, or there
            is a `max delay`.
    """
    if plan.spec.max_delay is not None:
        raise RvmonError(
            "a monitor in C takes samples in order of time, and holds none back: leave out "
            "`max delay` and give it samples in order, or use `rvmon run` or `rvmon watch`"
        )
    return {**core_files(), **plan_files(plan)}


def core_files() -> dict[str, str]:
    """The texts of the core's files, which are the same for all specifications."""
    head = f"/* The monitor core of rvmon {__version__}. SPDX-License-Identifier: Apache-2.0 */\n"
    face = Path(sources.FOLDER, "core.hpp").read_text(encoding="utf-8")
    return {
        f"{CORE}.h": head + sources.core_header(),
        f"{CORE}.c": head + sources.core_source(f"{CORE}.h"),
        f"{CORE}.hpp": head + face.replace(f'"{sources.HEADER}"', f'"{CORE}.h"'),
    }


def plan_files(plan: Plan) -> dict[str, str]:
    """The texts of all files except the core's; see `c_files`."""
    packed = pack(plan)
    prefix = prefix_of(plan.spec.name)
    return {
        f"{prefix}_plan.h": "\n".join(_header(plan.spec, packed, prefix)) + "\n",
        f"{prefix}_plan.c": "\n".join(_source(packed, prefix)) + "\n",
    }


def _header(spec: CheckedSpec, packed: Packed, prefix: str) -> Iterator[str]:
    """The sizes and names of a plan."""
    upper = prefix.upper()
    base = memory_of(packed.data, 0)
    more = max(
        -((base - memory_of(packed.data, attempts)) // attempts)
        for attempts in range(FEWEST, MOST + 1)
    )
    yield _remark(
        f"The plan of `{comment(spec.name)}`, made by rvmon {__version__} for the core in the same "
        f"folder ({CORE}.h) and for {sys.byteorder}-endian processors."
    )
    yield from ("", f"#ifndef {upper}_PLAN_H", f"#define {upper}_PLAN_H", "")
    yield from (f'#include "{CORE}.h"', "")
    yield from ("#ifdef __cplusplus", 'extern "C" {', "#endif", "")
    yield from (f"#define {upper}_PLAN_SIZE {len(packed.data)} /* bytes */", "")
    yield _remark(
        "The size in bytes of a block in which a run can start and `rv_reserve` finds room for "
        f"this number of open attempts ({MOST} at most): for all requirements without `let` and "
        "`for each` together, and for each of the others. Measured with pointers of 8 bytes; with "
        "4 bytes, less is needed. Memory for past operators and windows comes on top as the run "
        "needs it: `rv_memory_used` returns the total."
    )
    yield f"#define {upper}_MEMORY(attempts) \\"
    room = f"((attempts) < {FEWEST} ? {FEWEST} : (attempts))"
    yield from (f"    ({base + ALIGNMENT}U + {more}U * (unsigned){room})", "")
    signals, events = list(packed.signals), list(packed.events)
    signal_types = [spec.signals[name].type for name in signals]
    yield from _enum(f"{upper}_SIGNAL", signals, list(map(_words, signal_types)))
    yield from _enum(f"{upper}_EVENT", events, start=len(signals), of="in names: after the signals")
    yield from _fields(spec, packed, f"{upper}_FIELD")
    if packed.labels:
        yield from _enum(f"{upper}_LABEL", list(packed.labels))
    yield from _enum(f"{upper}_REQUIREMENT", list(packed.ids))
    yield f"extern const uint64_t {prefix}_plan[{upper}_PLAN_SIZE / 8];"
    for name, (type_, values, note) in _tables(packed).items():
        if values:
            yield f"extern {type_} {prefix}_{name}[{len(values)}]; /* {note} */"
    yield from ("", "#ifdef __cplusplus", "}", "#endif", "", "#endif")


def _remark(text: str) -> str:
    """A comment of several lines."""
    return "\n".join(wrap(f"{text} */", 100, initial_indent="/* ", subsequent_indent=" * "))


def _words(type_: Type) -> str:
    return " ".join(filter(None, (type_.kind.value, comment(type_.unit))))


def _enum(
    what: str,
    names: Sequence[str],
    notes: Sequence[str] = (),
    *,
    start: int = 0,
    of: str = "",
) -> Iterator[str]:
    """An enumeration of names, and their count."""
    yield f"enum {{{f' /* {of} */' if of and names else ''}"
    for number, (name, made) in enumerate(zip(names, identifiers(names), strict=True)):
        words = f": {notes[number]}" if notes else ""
        yield f"    {what}_{made} = {start + number}, /* {comment(name)}{words} */"
    yield from (f"    {what}S = {len(names)}", "};", "")


def _fields(spec: CheckedSpec, packed: Packed, what: str) -> Iterator[str]:
    """An enumeration of the fields of events, numbered within each event."""
    if not packed.fields:
        return
    names = identifiers([f"{event} {field}" for event, field in packed.fields])
    yield "enum { /* numbered within each event */"
    for (event, field), made in zip(packed.fields, names, strict=True):
        fields = spec.events[event].fields
        words = _words(fields[field])
        number = list(fields).index(field)
        yield f"    {what}_{made} = {number}, /* {comment(event)}.{comment(field)}: {words} */"
    yield from (f"    {what}S = {len(packed.fields)}", "};", "")


def _tables(packed: Packed) -> dict[str, tuple[str, list[str], str]]:
    """Tables for programs that read or print names: type, values and comment of each."""
    text = "const char *const"
    kinds = ["RV_REAL" if kind is Kind.REAL else "RV_WHOLE" for kind in packed.signals.values()]
    return {
        "names": (text, [*map(string, (*packed.signals, *packed.events))], "signals, then events"),
        "kinds": ("const uint8_t", kinds, "of signals: the type of their numbers"),
        "labels": (text, [*map(string, packed.labels)], "by number"),
        "requirements": (text, [*map(string, packed.ids)], "by number"),
    }


def _source(packed: Packed, prefix: str) -> Iterator[str]:
    """The plan, aligned to 8 bytes, and the tables of names."""
    order = f"__ORDER_{sys.byteorder.upper()}_ENDIAN__"
    yield from (f'#include "{prefix}_plan.h"', "")
    yield f"#if defined(__BYTE_ORDER__) && (__BYTE_ORDER__ != {order})"
    yield from (f'#error "this plan is for {sys.byteorder}-endian processors"', "#endif", "")
    yield from ("#ifdef __GNUC__", "__attribute__((aligned(8)))", "#endif")
    yield f"const uint64_t {prefix}_plan[{prefix.upper()}_PLAN_SIZE / 8] = {{"
    words = [f"0x{word:016x}U" for word in array("Q", packed.data)]
    yield from (f"    {', '.join(words[i : i + 4])}," for i in range(0, len(words), 4))
    yield "};"
    for name, (type_, values, _note) in _tables(packed).items():
        if values:
            yield from ("", f"{type_} {prefix}_{name}[{len(values)}] = {{")
            yield from (f"    {value}," for value in values)
            yield "};"
