"""What a person tells of recordings, put into the schema of a specification."""

from __future__ import annotations

from typing import TYPE_CHECKING, Unpack

from rvmon.readers.naming import read_as
from rvmon.trace.schema import Schema

if TYPE_CHECKING:
    from rvmon.readers.reading import SchemaArguments
    from rvmon.spec.checked.specification import CheckedSpec


def schema_told(spec: CheckedSpec, schema: Schema, **told: Unpack[SchemaArguments]) -> Schema:
    """A schema for recordings that tell things otherwise.

    Args:
        spec: the specification.
        schema: of it; what is not told stays as it says.
        **told: see `rvmon.session.Spec.reading`; so are the errors.
    """
    binding = None
    if (path := told.get("binding")) is not None:
        from rvmon.binding.load import load_binding

        binding = load_binding(path, spec)
    return read_as(
        schema,
        time=told.get("time"),
        columns=told.get("columns"),
        nan=told.get("nan"),
        no_update=told.get("no_update"),
        binding=binding,
        clock=told.get("clock"),
    )
