"""Networks built from Python, piece by piece; conditions and updates are texts as in a `.ta`."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import Any

from rvmon.diagnostics import Source, Span
from rvmon.timed.language import automaton_syntax, syntax
from rvmon.timed.language.automaton_syntax import Document
from rvmon.timed.language.elaborate import elaborate
from rvmon.timed.language.parse import parse_part
from rvmon.timed.model.expressions import LocationKind
from rvmon.timed.model.network import Network
from rvmon.timed.model.rules import model_error


@dataclass(slots=True)
class AutomatonBuilder:
    """An automaton in the making; `NetworkBuilder.automaton` makes one."""

    name: str
    declarations: tuple[syntax.Declared, ...]
    locations: list[automaton_syntax.LocationText] = field(default_factory=list)
    edges: list[automaton_syntax.EdgeText] = field(default_factory=list)
    initial: syntax.Name | None = None

    def location(
        self,
        name: str,
        *,
        invariant: str = "",
        kind: LocationKind = LocationKind.NORMAL,
        initial: bool = False,
    ) -> AutomatonBuilder:
        """Add a location; the first one is initial unless another says so.

        Raises:
            ModelError: the invariant cannot be read.
        """
        span = _span(f"location {self.name}.{name}", name)
        condition = _read("conditions", invariant, f"invariant of {self.name}.{name}", None)
        self.locations.append(automaton_syntax.LocationText(name, kind, condition, span))
        if initial or self.initial is None:
            self.initial = syntax.Name(name, span)
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
        """Add an edge.

        Raises:
            ModelError: one of its texts cannot be read, or the weight is not in (0, 1].
        """
        place = f"{self.name}: {source} → {target}"
        span = _span(place, f"{source} → {target}")
        if not 0 < weight <= 1:
            fix = "a weight is a share: above 0, at most 1"
            raise model_error("TA017", f"weight {weight}", span, fix)
        self.edges.append(
            automaton_syntax.EdgeText(
                syntax.Name(source, _span(place, source)),
                syntax.Name(target, _span(place, target)),
                span,
                _read("selections", select, f"selection of {place}", ()),
                _read("conditions", guard, f"guard of {place}", None),
                _read("sync", sync, f"synchronisation of {place}", None),
                _read("updates", update, f"update of {place}", ()),
                weight,
                label,
            )
        )
        return self


@dataclass(slots=True)
class NetworkBuilder:
    """A network in the making.

    Args:
        name: of the network.
        title: for people.
        unit: ticks of one unit of time, if recordings shall be held against it.

    >>> net = NetworkBuilder("light").declare("clock x")
    >>> lamp = net.automaton("Lamp").location("off").location("on", invariant="x <= 5")
    >>> lamp = lamp.edge("off", "on", update="x = 0").edge("on", "off", guard="x >= 3")
    >>> from rvmon.timed.search.verify import verify
    >>> verify(net.build(), "E<> Lamp.on and x == 5").holds
    True
    """

    name: str
    title: str = ""
    unit: int | None = None
    declarations: tuple[syntax.Declared, ...] = ()
    automata: list[AutomatonBuilder] = field(default_factory=list)
    queries: list[automaton_syntax.QueryText] = field(default_factory=list)

    def declare(self, text: str) -> NetworkBuilder:
        """Add constants, clocks, variables, channels or types.

        Raises:
            ModelError: the text is no declaration.
        """
        self.declarations += _read("declarations", text, "declaration", ())
        return self

    def automaton(self, name: str, declarations: str = "") -> AutomatonBuilder:
        """Add an automaton, with names of its own.

        Raises:
            ModelError: the text is no declaration.
        """
        own = _read("declarations", declarations, f"declaration of {name}", ())
        made = AutomatonBuilder(name, own)
        self.automata.append(made)
        return made

    def query(self, text: str, *, id: str = "", remark: str = "") -> NetworkBuilder:  # noqa: A002 - its name
        """Add a query.

        Raises:
            ModelError: the text is no query.
        """
        formula = _read("query", text, f"query {id}".strip(), None)
        self.queries.append(
            automaton_syntax.QueryText(id, remark, text, formula, _span("query", text))
        )
        return self

    def build(self) -> Network:
        """The network.

        Raises:
            ModelError: with everything that is wrong with it.
        """
        templates = tuple(
            automaton_syntax.Template(
                one.name,
                (),
                one.declarations,
                tuple(one.locations),
                one.initial,
                tuple(one.edges),
                _span("automaton", one.name),
            )
            for one in self.automata
        )
        return elaborate(
            Document(
                Source(self.name, ""),
                self.name,
                self.title,
                self.unit,
                self.declarations,
                templates,
                (),
                None,
                tuple(self.queries),
            )
        )


def _span(place: str, text: str) -> Span:
    return Span(Source(place, text), 0, len(text))


def _read(rule: str, text: str, place: str, default: Any) -> Any:
    """A text read by a rule of the grammar; `default` if it is empty."""
    if not text.strip():
        return default
    source = Source(place, text)
    return parse_part(text, rule, lambda start, end: Span(source, start, end))
