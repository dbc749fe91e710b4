"""Whether a sample is one that the specification can take."""

from __future__ import annotations

from collections.abc import Mapping
from typing import Any

from rvmon.errors import TraceError
from rvmon.readers.coalesce import updates_in
from rvmon.spec.checked.specification import CheckedSpec, Type
from rvmon.trace.sample import Scalar, Value
from rvmon.trace.schema import Kind
from rvmon.trace.time import format_ticks

_TAKES: Mapping[Kind, tuple[type, ...]] = {
    Kind.BOOL: (bool,),
    Kind.INT: (int,),
    Kind.REAL: (float, int),
    Kind.LABEL: (str,),
}


class Validator:
    """Checks samples against the declarations.

    Args:
        spec: declares signals and events.
        sources: the names that can arrive; `None`: all.
        single: events of which only one payload can be judged at one instant.
    """

    def __init__(
        self, spec: CheckedSpec, sources: frozenset[str] | None, single: frozenset[str]
    ) -> None:
        self._signals = {name: signal.type for name, signal in spec.signals.items()}
        self._events = {name: event.fields for name, event in spec.events.items()}
        self._ignoring = spec.ignoring
        self._single = single
        declared = {*self._signals, *self._events}
        self._expected = frozenset(declared if sources is None else declared & sources)
        self._declared = declared

    def check(self, t: int, values: Mapping[str, Any]) -> Mapping[str, Value]:
        """The sample in plain Python values, without what is no update.

        Raises:
            TraceError: a name or a value that the specification does not know; it is named.
        """
        if not isinstance(values, Mapping):
            raise TraceError(
                f"sample at {format_ticks(t)}: expected values by name, found {values!r}"
            )
        plain: dict[str, Value] = {}
        for name, value in values.items():
            if name not in self._expected:
                raise TraceError(self._unknown(name, t))
            type_ = self._signals.get(name)
            if type_ is None:
                plain[name] = self._occurrence(name, value, t)
            else:
                plain[name] = _scalar(value, type_, f"`{name}`", t)
        return updates_in(plain, self._ignoring)

    def _unknown(self, name: str, t: int) -> str:
        where = f"sample at {format_ticks(t)}: "
        if name in self._declared:
            return f"{where}`{name}` arrived, but it is not among the sources of this monitor"
        return f"{where}no signal or event named `{name}`: declare it in the spec, or leave it out"

    def _occurrence(self, name: str, value: Any, t: int) -> Value:
        if value is None or value is True or value is False:
            return value
        if isinstance(value, Mapping):
            return self._payload(name, value, t)
        if isinstance(value, tuple | list):
            if len(value) > 1 and name in self._single:
                raise TraceError(
                    f"sample at {format_ticks(t)}: {len(value)} payloads of `{name}`: only "
                    "`for each` can distinguish them, and not all that reads its fields has it"
                )
            return tuple(self._payload(name, payload, t) for payload in value)
        raise TraceError(
            f"sample at {format_ticks(t)}: `{name}` is an event: expected True, False, None or its "
            f"payload, found {value!r}"
        )

    def _payload(self, name: str, payload: Any, t: int) -> Mapping[str, Scalar]:
        fields = self._events[name]
        if not isinstance(payload, Mapping):
            raise TraceError(
                f"sample at {format_ticks(t)}: `{name}`: expected a payload, found {payload!r}"
            )
        unknown = [field for field in payload if field not in fields]
        if unknown:
            known = ", ".join(fields) or "none"
            raise TraceError(
                f"sample at {format_ticks(t)}: `{name}` has no field `{unknown[0]}`: it has {known}"
            )
        return {
            field: _scalar(value, fields[field], f"`{name}.{field}`", t)
            for field, value in payload.items()
        }


def _scalar(value: Any, type_: Type, name: str, t: int) -> Scalar:
    takes = _TAKES[type_.kind]
    if type(value) in takes and (type_.kind is not Kind.LABEL or value in type_.labels):
        known: Scalar = value
        return known
    if value is None:
        return None
    item = getattr(value, "item", None)
    if callable(item) and type(value) not in (bool, int, float, str):
        try:
            plain = item()
        except (TypeError, ValueError):  # an array of several values
            plain = value
        if not hasattr(plain, "item"):
            return _scalar(plain, type_, name, t)  # a NumPy scalar
    if isinstance(value, float | int) and isinstance(value, takes) and type(value) is not bool:
        return value + 0  # an instance of a subclass
    if type_.kind is Kind.LABEL:
        expected = "one of " + ", ".join(type_.labels)
    else:
        expected = {Kind.BOOL: "True or False", Kind.INT: "a whole number"}.get(
            type_.kind, "a number"
        )
    raise TraceError(f"sample at {format_ticks(t)}: {name}: expected {expected}, found {value!r}")
