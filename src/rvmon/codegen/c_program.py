"""A plan as a C program that reads recordings and prints verdicts."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import replace

from rvmon.codegen.c_build import THREADS, Build
from rvmon.codegen.c_captured import CapturedValues
from rvmon.codegen.c_exact import EXACT, whole_limits
from rvmon.codegen.c_margins import Measures
from rvmon.codegen.c_names import Names
from rvmon.codegen.c_source import c_files
from rvmon.codegen.c_text import filled, template
from rvmon.codegen.comment import comment
from rvmon.diagnostics.shown import shown_json
from rvmon.plan.numbers import events_of
from rvmon.plan.plan import Plan
from rvmon.spec.checked.formula import Compare
from rvmon.spec.checked.reads import names_of_requirement
from rvmon.spec.checked.specification import Type
from rvmon.trace.schema import Kind
from rvmon.verdict.attempt_json import encoded
from rvmon.verdict.verdict import LAW

_PARTS = (
    "program_head.c.in",
    "program_words.c.in",
    "program_text.c.in",
    "program_numbers.c.in",
    "program_samples.c.in",
    "program_blocks.c.in",
    "program_echoes.c.in",
    "read_csv.c.in",
    "read_json.c.in",
    "read_jsonl.c.in",
    "read_binary.c.in",
    "program_report.c.in",
    "program_main.c.in",
)

_KINDS = {
    Kind.BOOL: "KIND_BOOL",
    Kind.INT: "KIND_INT",
    Kind.REAL: "KIND_REAL",
    Kind.LABEL: "KIND_LABEL",
}


def program_build(plan: Plan, *, measured: bool = False) -> Build:
    """The program of a plan, for `rvmon.codegen.c_build.built`.

    Args:
        plan: what it judges.
        measured: whether it prints robustness, too; the plan then says of what.

    Raises:
        RvmonError: a number of the specification is no double.
    """
    if measured:  # under the specification's own name functions might be called alike
        plan = replace(plan, spec=replace(plan.spec, name="rvmon"))
    made = c_files(plan)
    name = f"{made.prefix}_program.c"
    texts = {**made.texts, name: program_source(plan, measured=measured)}
    main = f"{made.prefix}.c"
    if measured:  # which includes that
        main = f"{made.prefix}_margins.c"
        texts[main] = _margins_source(plan)
    return Build(texts, [main, *made.units, name], ".program", ["-O3", THREADS])


def _margins_source(plan: Plan) -> str:
    """The monitor, and what measures robustness beside it."""
    places = {"MEASURING": Measures(plan).source(), "prefix": Names(plan).prefix}
    return filled(template("margin_head.c.in") + template("program_margins.c.in"), places)


def program_source(plan: Plan, *, measured: bool = False) -> str:
    """The source of the program; it includes the header of `rvmon.codegen.c_source.c_files`.

    Args:
        plan: see `program_build`.
        measured: see there.
    """
    names = Names(plan)
    places = {
        "ENTRIES": "\n".join(_entries(plan, names)),
        "STEADY": str(int(_is_steady(plan))),
        "MEASURES": str(int(measured)),
        "LAW": str(LAW),
        "SPEC": comment(plan.spec.name),
        "HEADER": f"{names.prefix}.h",
        "PREFIX": names.prefix.upper(),
        "prefix": names.prefix,
    }
    return filled("\n".join(template(part) for part in _PARTS), places)


def _is_steady(plan: Plan) -> bool:
    """Whether a sample that says again what signals are changes nothing."""
    signals = plan.spec.signals.values()
    return (
        plan.gap is not None
        and not any(use.history or use.marked for use in plan.uses.values())
        and all(signal.stale_after is None for signal in signals)
    )


def _entries(plan: Plan, names: Names) -> Iterator[str]:
    spec = plan.spec
    limits = whole_limits(plan)
    read = {name for rule in plan.asked for name in names_of_requirement(rule.requirement)}
    things: list[tuple[str, int, int, Type | None]] = [
        (name, names.signal(name), -1, signal.type) for name, signal in spec.signals.items()
    ]
    things += [(name, names.event(name), -1, None) for name in spec.events]
    things += [
        (f"{event}.{field}", number, names.event(event), spec.events[event].fields[field])
        for (event, field), number in names.fields.items()
    ]
    for place, (_, _, _, type_) in enumerate(things):
        labels = type_.labels if type_ is not None else ()
        if labels:
            yield from _labels(place, labels, names)
    yield "static const entry entries[] = {"
    for place, (name, number, event, type_) in enumerate(things):
        kind = _KINDS[Kind.BOOL if type_ is None else type_.kind]
        labels = type_.labels if type_ is not None else ()
        tables = f"labels{place}, label_numbers{place}" if labels else "NULL, NULL"
        # What is larger than all that doubles tell apart may have been rounded to that.
        most = f"{min(limits.get(name, EXACT), EXACT - 1)}.0"
        is_event = "true" if type_ is None else "false"
        ignores = "true" if name in spec.ignoring else "false"
        is_read = "true" if name in read else "false"
        fields = f"{number}, {event}, {kind}, {is_event}, {is_read}, {ignores}, {tables}, {most}"
        yield f"    {{{c_string(name)}, {fields}}},"
    if not things:
        yield '    {"", 0, -1, KIND_BOOL, false, false, false, NULL, NULL, 0.0},'
    yield "};"
    order = sorted(range(len(things)), key=lambda place: things[place][0].encode())
    yield f"static const int32_t by_name[] = {{{', '.join(map(str, order or [0]))}}};"
    yield f"#define ENTRY_COUNT {max(len(things), 1)}"
    yield ""
    yield from _several(plan)
    yield from _captured(plan, names)
    # As JSON, which the program prints as it is.
    ids = [_json(rule.requirement.id) for rule in plan.asked]
    yield f"static const char *const requirements[] = {{{', '.join(ids)}}};"


def _several(plan: Plan) -> Iterator[str]:
    """The events of which an instant can hold several payloads: all that read them are apart."""
    each = {one.value.event for rule in plan.asked if (one := rule.requirement.for_each)}
    for part in (plan, *plan.units):
        own = {one.value.event for rule in part.rules if (one := rule.requirement.for_each)}
        leaves = [state.leaf for state in part.graph.nodes if isinstance(state.leaf, Compare)]
        sides = [side for leaf in leaves for side in (leaf.left, leaf.right)]
        each -= {*events_of(*sides)} - own
    flags = ", ".join(str(event in each).lower() for event in plan.events)
    yield f"static const bool several[] = {{{flags or 'false'}}};"


def _captured(plan: Plan, names: Names) -> Iterator[str]:
    """What the values are called that attempts capture, as JSON, and what they are."""
    captured = CapturedValues(plan)
    if not captured.count:
        return
    yield "typedef struct {"
    yield "    const char *name;"
    yield "    uint8_t kind;"
    yield "} captured;"
    yield f"static const captured captured_of[][{captured.count}] = {{"
    for own in captured.names:
        entries = [f"{{{_json(name)}, {_KINDS[type_.kind]}}}" for name, type_ in own.items()]
        yield f"    {{{', '.join(entries or ['{NULL, KIND_BOOL}'])}}},"
    yield "};"
    labels = ", ".join(map(_json, names.labels)) or "NULL"
    yield f"static const char *const label_texts[] = {{{labels}}};"


def _json(text: str) -> str:
    """A C string literal of a text as JSON."""
    return c_string(shown_json(encoded(text)))


def _labels(place: int, labels: Sequence[str], names: Names) -> Iterator[str]:
    texts = ", ".join(c_string(label) for label in labels)
    yield f"static const char *const labels{place}[] = {{{texts}, NULL}};"
    numbers = ", ".join(str(names.label(label)) for label in labels)
    yield f"static const int32_t label_numbers{place}[] = {{{numbers}}};"


def c_string(text: str) -> str:
    r"""A C string literal of the UTF-8 bytes of a text.

    >>> print(c_string('say "é"'))
    "say \"\303\251\""
    """
    made = ""
    for byte in text.encode():
        plain = chr(byte)
        if plain in '"\\?':
            made += "\\" + plain
        elif 0x20 <= byte < 0x7F and plain != "@":  # which marks places of the templates
            made += plain
        else:
            made += f"\\{byte:03o}"
    return f'"{made}"'
