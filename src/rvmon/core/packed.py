"""What a packed plan is, and what its numbers stand for."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

from rvmon.spec.checked.specification import CheckedSpec
from rvmon.trace.schema import Kind


@dataclass(frozen=True, slots=True)
class Packed:
    """A plan as bytes, and what its numbers stand for.

    Attributes:
        data: the bytes.
        signals: by name, what values they take; in the order of their numbers.
        events: their names; their numbers are those behind the signals.
        fields: by event and name, what values they take; in the order of their numbers.
        labels: by label, the number that it is given to the core as.
        ids: of the requirements, by number.
    """

    data: bytes
    signals: Mapping[str, Kind]
    events: tuple[str, ...]
    fields: Mapping[tuple[str, str], Kind]
    labels: Mapping[str, int]
    ids: tuple[str, ...]


def packed(spec: CheckedSpec, ids: tuple[str, ...], data: bytes) -> Packed:
    """What the bytes of a plan of some requirements stand for, which only these say.

    Args:
        spec: declares the names.
        ids: of the requirements, in the order of the file.
        data: the bytes.
    """
    return Packed(
        data,
        {name: signal.type.kind for name, signal in spec.signals.items()},
        tuple(spec.events),
        {
            (name, field): type_.kind
            for name, event in spec.events.items()
            for field, type_ in event.fields.items()
        },
        Numbering(spec).labels,
        ids,
    )


class Numbering:
    """The numbers of what a specification declares.

    Attributes:
        names: of signals, then events.
        labels: whatever types they belong to.
    """

    def __init__(self, spec: CheckedSpec) -> None:
        self.names = numbered([*spec.signals, *spec.events])
        types = [signal.type for signal in spec.signals.values()]
        for event in spec.events.values():
            types += event.fields.values()
        self.labels = numbered(list(dict.fromkeys(one for type_ in types for one in type_.labels)))


def numbered(names: Sequence[str]) -> dict[str, int]:
    """The place of each of some names."""
    return {name: number for number, name in enumerate(names)}
