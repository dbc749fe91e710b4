"""Models from files and texts."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import replace
from pathlib import Path

from rvmon.diagnostics import Source
from rvmon.models.language.elaborate import elaborate
from rvmon.models.language.parse import parse_document
from rvmon.models.language.uppaal_reader import read_uppaal
from rvmon.models.network.network import Network
from rvmon.models.network.rules import model_error
from rvmon.texts import cannot_read, text_of_file


def load_network(path: str | Path, *, constants: Mapping[str, int] | None = None) -> Network:
    """Read a model from a `.ta` file, or from one in UPPAAL's XML.

    Raises:
        ModelError: the file cannot be read, or is no model; it has all findings.
    """
    try:
        text = text_of_file(path, "utf-8-sig")
    except OSError as error:
        raise model_error("TA022", cannot_read(path, error), None) from None
    except UnicodeDecodeError:
        fix = "save it as UTF-8 text"
        raise model_error("TA022", f"{path} is no text", None, fix) from None
    return loads_network(text, name=str(path), constants=constants)


def loads_network(
    text: str, *, name: str = "<string>", constants: Mapping[str, int] | None = None
) -> Network:
    """Read a model from a text.

    Args:
        text: as in a `.ta` file, or UPPAAL's XML.
        name: its name in findings.
        constants: other values for constants of the model.

    Raises:
        ModelError: the text is no model; it has all findings.

    >>> loads_network("automaton a { location l start l }").automata[0].locations[0].name
    'l'
    """
    source = Source(name, text)
    if not text.lstrip().startswith("<"):
        return elaborate(parse_document(source), constants)
    document, warnings = read_uppaal(source)
    network = elaborate(document, constants)
    return replace(network, warnings=(*network.warnings, *warnings))
