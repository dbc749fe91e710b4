"""Bindings: TOML files that map topics and fields of recorded messages to declared names."""

from __future__ import annotations

import tomllib
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import replace
from enum import StrEnum
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeVar, Unpack

from msgspec import structs

from rvmon.errors import RvmonError, UnknownNameError
from rvmon.language.checked.arithmetic import NumericOp
from rvmon.language.checked.specification import CheckedSpec
from rvmon.recordings import DATABASES
from rvmon.recordings.messages import Topic
from rvmon.recordings.messages.field_meanings import expect_units
from rvmon.texts import cannot_read, did_you_mean, text_of_file
from rvmon.trace.schema import Applied, Binding, Bound, Clock, Constant, Kind, Schema, Term, gaps_of
from rvmon.trace.stamps import stamps_of
from rvmon.units import UnknownUnitError, parse_unit

if TYPE_CHECKING:
    from rvmon.recordings.source import SchemaArguments

_Choice = TypeVar("_Choice", bound=StrEnum)


class On(StrEnum):
    """Which messages are updates: all, or only those with a changed value."""

    MESSAGE = "message"
    CHANGE = "change"


_TOP = ("clock", "definitions", "robot", "bind")
_SIGNAL = ("topic", "type", "value", "unit", "labels", "on", "clock")
_EVENT = ("topic", "type", "value", "fields", "on", "clock")


def load_binding(path: str | Path, spec: CheckedSpec) -> Binding:
    """Read a binding; docs/reference/bindings.md describes the format.

    Raises:
        RvmonError: the file cannot be read, or does not fit the specification.
    """
    try:
        content = tomllib.loads(text_of_file(path))
    except (OSError, UnicodeDecodeError) as error:
        raise RvmonError(cannot_read(path, error)) from None
    except tomllib.TOMLDecodeError as error:
        raise RvmonError(f"{path}: no TOML: {error}") from None
    try:
        return _binding(content, spec, Path(path).parent)
    except RvmonError as error:
        raise RvmonError(f"{path}: {error}") from None


def _binding(content: Mapping[str, Any], spec: CheckedSpec, folder: Path) -> Binding:
    _expect_keys(content, _TOP, "")
    bounds: dict[str, Bound] = {}
    for name, table in _tables(_table(content, "bind", ""), ""):
        try:
            bound = bounds[name] = _bound(name, table, spec)
            expect_units(name, bound, spec.schema, Topic(bound.topic, bound.type, {}))
        except RvmonError as error:
            raise RvmonError(f"[bind.{name}]: {error}") from None
    listed = content.get("definitions", [])
    if not isinstance(listed, list) or not all(isinstance(one, str) for one in listed):
        raise RvmonError('`definitions` is a list of files: ["shop_msgs/msg/Pick.msg"]')
    robot = content.get("robot", "")
    if not isinstance(robot, str):
        raise RvmonError('`robot` stands for `*` in topics: robot = "robot_1"')
    clock = _choice(content, "clock", Clock) or Clock.LOG
    return Binding(bounds, clock, dict(_definition(folder / one) for one in listed), robot)


def _tables(content: Mapping[str, Any], prefix: str) -> Iterator[tuple[str, Mapping[str, Any]]]:
    """Yield each name and its table; `[bind.robot.state]` means the name `robot.state`."""
    for key, value in content.items():
        name = prefix + key
        if not isinstance(value, dict):
            raise RvmonError(f'[bind] `{name}`: expected a table: {name} = {{topic = "/…"}}')
        inner = {
            one: table
            for one, table in value.items()
            if isinstance(table, dict) and one not in ("fields", "labels")
        }
        own = {one: entry for one, entry in value.items() if one not in inner}
        if own or not inner:
            yield name, own
        yield from _tables(inner, f"{name}.")


def _bound(name: str, table: Mapping[str, Any], spec: CheckedSpec) -> Bound:
    is_signal = name in spec.signals
    if not is_signal and name not in spec.events:
        known = [*spec.signals, *spec.events]
        meant = did_you_mean(name, known, f"there are {', '.join(known)}")
        raise RvmonError(f"nothing named `{name}` is declared: {meant}")
    _expect_keys(table, _SIGNAL if is_signal else _EVENT, "a signal" if is_signal else "an event")
    topic = table.get("topic")
    if not isinstance(topic, str) or not topic:
        raise RvmonError('which topic feeds it? topic = "/…"')
    type_name = table.get("type", "")
    if not isinstance(type_name, str):
        raise RvmonError('what is the type of the messages? type = "nav_msgs/msg/Odometry"')
    value = None if "value" not in table else _value(table["value"], "value")
    on_change = _choice(table, "on", On) is On.CHANGE
    clock = _choice(table, "clock", Clock)
    if not is_signal:
        kinds = spec.schema.events[name]
        fields = _table(table, "fields", "value")
        for field in fields:
            if field not in kinds:
                there = f"there are {', '.join(kinds)}" if kinds else "it has none"
                meant = did_you_mean(field, kinds, there)
                raise RvmonError(f"no field `{field}` is declared: {meant}")
        if on_change and value is None and not fields:
            raise RvmonError('`on = "change"` needs a `value` or `fields` that can change')
        terms = {field: _value(text, f"fields.{field}") for field, text in fields.items()}
        return Bound(topic, value, terms, {}, clock, on_change, type_name)
    if value is None:
        raise RvmonError('a signal has a value: value = "data"')
    declared = spec.signals[name].type
    labels = _table(table, "labels", "label")
    if labels and declared.kind is not Kind.LABEL:
        raise RvmonError(f"`labels` are for signals of labels, and it is declared {declared.kind}")
    for label in labels.values():
        if label not in declared.labels:
            meant = did_you_mean(str(label), declared.labels, ", ".join(declared.labels))
            raise RvmonError(f"no label `{label}` is declared: {meant}")
    unit = str(table.get("unit", ""))
    if unit:
        value = _converted(value, unit, declared.kind, declared.unit)
    return Bound(topic, value, {}, labels, clock, on_change, type_name, unit)


def _value(text: Any, key: str) -> Term:
    if isinstance(text, bool | int | float):
        return Constant(text)
    if not isinstance(text, str):
        raise RvmonError(f'`{key}` is an expression in quotes: {key} = "pose.position.x"')
    # Imported on use: it builds a grammar, which runs without bindings do not need.
    from rvmon.recordings.binding.expression import term_of

    try:
        return term_of(text)
    except RvmonError as error:
        raise RvmonError(f"{key} = {text!r}: {error}") from None


def _converted(value: Term, given: str, kind: Kind, declared: str) -> Term:
    if kind is not Kind.REAL or not declared:
        raise RvmonError(f"`unit` is for signals that are declared with one: real [{given}]")
    try:
        source, target = parse_unit(given), parse_unit(declared)
    except UnknownUnitError as error:
        raise RvmonError(f"unknown unit `{error}`") from None
    if source.dimension != target.dimension:
        raise RvmonError(f"[{given}] cannot be converted to [{declared}], its declared unit")
    factor = source.factor / target.factor
    if factor == 1:
        return value
    if factor.numerator == 1:  # dividing by an integer rounds once, its inverse would round twice
        divide = NumericOp.DIV.entry.apply
        return Applied(divide, (value, Constant(float(factor.denominator))), "")
    return Applied(NumericOp.MUL.entry.apply, (value, Constant(float(factor))), "")


def _definition(path: Path) -> tuple[str, str]:
    """Type and text of a definition, whose path must end like `shop_msgs/msg/Pick.msg`.

    A CAN database has the name of its file in place of a type.
    """
    is_database = path.suffix.lower() in DATABASES
    is_message = path.suffix == ".msg" and len(path.parts) >= 3 and path.parts[-2] == "msg"
    if not is_message and not is_database:
        listed = ", ".join(DATABASES)
        raise RvmonError(f"definition {path}: expected PACKAGE/msg/NAME.msg, or one of {listed}")
    try:
        text = text_of_file(path)
    except (OSError, UnicodeDecodeError) as error:
        raise RvmonError(f"definition {cannot_read(path, error)}") from None
    return path.name if is_database else "/".join((*path.parts[-3:-1], path.stem)), text


def _table(content: Mapping[str, Any], key: str, what: str) -> Mapping[str, Any]:
    table = content.get(key, {})
    if not isinstance(table, dict):
        raise RvmonError(f'`{key}` is a table: {key} = {{name = "{what}"}}')
    return table


def _choice(content: Mapping[str, Any], key: str, choices: type[_Choice]) -> _Choice | None:
    value = content.get(key)
    if value is not None and value not in list(choices):
        raise RvmonError(f"{key} = {value!r}: expected {' or '.join(choices)}")
    return None if value is None else choices(value)


def _expect_keys(content: Mapping[str, Any], known: Sequence[str], what: str) -> None:
    for key in content:
        if key not in known:
            of = f" of {what}" if what else ""
            meant = did_you_mean(key, known, f"there are {', '.join(known)}")
            raise RvmonError(f"no key `{key}`{of}: {meant}")


def reading_schema(spec: CheckedSpec, schema: Schema, **options: Unpack[SchemaArguments]) -> Schema:
    """A schema with the options of `rvmon.session.Spec.reading`, which documents them.

    Raises:
        RvmonError: the binding cannot be read, or an option does not fit the specification.
    """
    path, time, clock = options.get("binding"), options.get("time"), options.get("clock")
    bound = schema.binding if path is None else load_binding(path, spec)
    fields = [f"{name}.{field}" for name, own in schema.events.items() for field in own]
    declared = [*schema.signals, *schema.events, *fields]
    columns = options.get("columns") or {}
    if not isinstance(columns, Mapping):
        raise RvmonError(f"columns={columns!r}: expected columns by name, such as {{'speed': 'v'}}")
    given = dict(columns)
    for name, column in given.items():
        if name not in declared:
            meant = did_you_mean(name, declared, f"there are {', '.join(declared)}")
            raise UnknownNameError(f"nothing named `{name}` to map `{column}` to: {meant}")
        if list(given.values()).count(column) > 1:
            raise RvmonError(f"column `{column}` is mapped to two names: one column, one name")
    if clock is not None and clock not in list(Clock):
        raise UnknownNameError(f"clock={clock!r}: expected {' or '.join(Clock)}")
    nan, no_update = options.get("nan"), options.get("no_update")
    return replace(
        schema,
        stamps=schema.stamps if time is None else stamps_of(time),
        columns={**schema.columns, **given},
        gaps=gaps_of(
            schema.gaps.reading_of_nan if nan is None else nan,
            schema.gaps.no_update if no_update is None else no_update,
        ),
        binding=bound if clock is None else structs.replace(bound, clock=Clock(clock)),
    )
