"""Loads models from files and texts, and builds them in Python as lines of a `.ta` text."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path

from rvmon.diagnostics import Source
from rvmon.models import model_error
from rvmon.models.language.elaborate import elaborate
from rvmon.models.language.parse import parse_document
from rvmon.models.language.uppaal_reader import read_uppaal
from rvmon.models.network import Network
from rvmon.models.network.expressions import LocationKind
from rvmon.texts import cannot_read, text_of_file


def load_network(path: str | Path, *, constants: Mapping[str, int] | None = None) -> Network:
    """Read a model from a `.ta` file or from UPPAAL's XML.

    Raises:
        ModelError: the file cannot be read or is no valid model; it has all findings.
    """
    try:
        text = text_of_file(path, "utf-8-sig")
    except OSError as error:
        raise model_error("TA022", cannot_read(path, error), None) from None
    except UnicodeDecodeError:
        fix = "save it as UTF-8 text"
        raise model_error("TA022", f"{path} is not text", None, fix) from None
    return loads_network(text, name=str(path), constants=constants)


def loads_network(
    text: str, *, name: str = "<string>", constants: Mapping[str, int] | None = None
) -> Network:
    """Read a model from a text.

    Args:
        text: a `.ta` text or UPPAAL's XML.
        name: the name of the text in findings.
        constants: values that replace those of constants of the model.

    Raises:
        ModelError: the text is no valid model; it has all findings.

    >>> loads_network("automaton a { location l start l }").automata[0].locations[0].name
    'l'
    """
    source = Source(name, text)
    if not text.lstrip().startswith("<"):
        return elaborate(parse_document(source), constants)
    document, warnings = read_uppaal(source)
    network = elaborate(document, constants)
    return replace(network, warnings=(*network.warnings, *warnings))


@dataclass(slots=True)
class AutomatonBuilder:
    """Builds an automaton; `NetworkBuilder.automaton` creates it."""

    lines: list[str]
    initial: str = ""

    def location(
        self,
        name: str,
        *,
        invariant: str = "",
        kind: LocationKind = LocationKind.NORMAL,
        initial: bool = False,
    ) -> AutomatonBuilder:
        """Add a location. The first one is initial unless another is added with `initial`."""
        prefix = "" if kind is LocationKind.NORMAL else f"{kind} "
        self.lines.append(f"  {prefix}location {name}{_clause('invariant', invariant)}")
        if initial or not self.initial:
            self.initial = name
        return self

    def edge(
        self,
        source: str,
        target: str,
        *,
        select: str = "",
        guard: str = "",
        sync: str = "",
        update: str = "",
        weight: float = 1.0,
        label: str = "",
    ) -> AutomatonBuilder:
        """Add an edge; its weight is a share in (0, 1]."""
        clauses = {"select": select, "when": guard, "on": sync, "do": update}
        clauses |= {"weight": f"{weight}", "as": f'"{label}"' if label else ""}
        written = "".join(_clause(word, text) for word, text in clauses.items())
        self.lines.append(f"  edge {source} -> {target}{written}")
        return self


@dataclass(slots=True)
class NetworkBuilder:
    """Builds a network.

    Args:
        name: of the network.
        title: for people.
        unit: ticks of one unit of time, needed to compare recordings with the network.

    >>> net = NetworkBuilder("light").declare("clock x")
    >>> lamp = net.automaton("Lamp").location("off").location("on", invariant="x <= 5")
    >>> lamp = lamp.edge("off", "on", update="x = 0").edge("on", "off", guard="x >= 3")
    >>> from rvmon.models.search.verify import verify
    >>> verify(net.build(), "E<> Lamp.on and x == 5").holds
    True
    """

    name: str
    title: str = ""
    unit: int | None = None
    declarations: list[str] = field(default_factory=list)
    automata: list[AutomatonBuilder] = field(default_factory=list)
    queries: list[str] = field(default_factory=list)

    def declare(self, text: str) -> NetworkBuilder:
        """Add constants, clocks, variables, channels or types."""
        self.declarations.append(text)
        return self

    def automaton(self, name: str, declarations: str = "") -> AutomatonBuilder:
        """Add an automaton with local declarations."""
        self.automata.append(AutomatonBuilder([f"automaton {name} {{", f"  {declarations}"]))
        return self.automata[-1]

    def query(self, text: str, *, id: str = "", remark: str = "") -> NetworkBuilder:  # noqa: A002 - its name
        """Add a query."""
        named = " ".join(filter(None, ("query", id, f'"{remark}"' if remark else "")))
        self.queries.append(f"{named}: {text}")
        return self

    @property
    def text(self) -> str:
        """The model built so far, as a `.ta` text."""
        lines = [*self.declarations]
        for builder in self.automata:
            lines += [*builder.lines, f" {_clause('start', builder.initial)}", "}"]
        return "\n".join([*lines, *self.queries])

    def build(self) -> Network:
        """Build the network.

        Raises:
            ModelError: with everything that is wrong, at its place in `text`.
        """
        made = loads_network(self.text, name=self.name)
        return replace(made, name=self.name, title=self.title, unit=self.unit)


def _clause(word: str, text: str) -> str:
    """A clause of a line; nothing for an empty text."""
    return f" {word} {text}" if text.strip() else ""
