"""Options of reading recordings, put into the schema of a specification."""

from __future__ import annotations

from typing import TYPE_CHECKING, Unpack

from rvmon.readers.naming import read_as
from rvmon.trace.schema import Schema

if TYPE_CHECKING:
    from rvmon.readers.reading import SchemaArguments
    from rvmon.spec.checked.specification import CheckedSpec


def reading_schema(spec: CheckedSpec, schema: Schema, **options: Unpack[SchemaArguments]) -> Schema:
    """A schema for recordings that are read with other options.

    Args:
        spec: the specification.
        schema: of it; what no option gives stays as it says.
        **options: see `rvmon.session.Spec.reading`; so are the errors.
    """
    binding = None
    if (path := options.get("binding")) is not None:
        from rvmon.binding.load import load_binding

        binding = load_binding(path, spec)
    return read_as(
        schema,
        time=options.get("time"),
        columns=options.get("columns"),
        nan=options.get("nan"),
        no_update=options.get("no_update"),
        binding=binding,
        clock=options.get("clock"),
    )
