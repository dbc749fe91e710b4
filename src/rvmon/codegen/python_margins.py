"""The nodes of a network as they measure, as Python source: one step takes what is new through all.

What a node has is a step function over the integers, known up to one of them. A step of the class
hands from node to node, operands first, what is new: from which integer on it has which value, and
up to which integer that is known. Where only samples are positions, a step of the function belongs
to the position at which it begins, and each position has one of its own. A value is reported as
soon as nothing that may still come can change it; what is kept is what is not settled.

Source: Lemire 2006 (the wedge); Donze, Ferrere and Maler 2013, Efficient robust monitoring for STL.
"""

from __future__ import annotations

from collections import deque
from collections.abc import Iterator
from typing import Any

from rvmon.codegen.python_gauge_joins import JoinWriter
from rvmon.codegen.python_gauge_windows import WindowWriter
from rvmon.codegen.python_visit import indented
from rvmon.dataflow.margin_end import Rest
from rvmon.dataflow.margins import INFINITE
from rvmon.dataflow.nodes import Junction, Leaf, NetworkPlan, Node, Shift, Sweep, Window
from rvmon.dataflow.piecewise import FAR
from rvmon.dataflow.robust import Gauge


def gauge_source(plan: NetworkPlan, gap: int | None) -> str:
    """The source of a class `Generated(Gauge)`, see `rvmon.dataflow.robust.Gauge`.

    Args:
        plan: of the formula that is measured.
        gap: ticks between two positions; `None` if only samples are positions.
    """
    return "\n".join(_Writer(plan, gap).lines()) + "\n"


def gauge_class(plan: NetworkPlan, gap: int | None) -> type[Gauge]:
    """The class; see `gauge_source`."""
    namespace: dict[str, Any] = {
        "__name__": "rvmon.generated",
        "Gauge": Gauge,
        "Rest": Rest,
        "deque": deque,
        "FAR": FAR,
        "INF": INFINITE,
    }
    # The source holds numbers of the plan only.
    exec(compile(gauge_source(plan, gap), "<generated gauge>", "exec"), namespace)  # noqa: S102
    made: type[Gauge] = namespace["Generated"]
    return made


class _Writer(WindowWriter, JoinWriter):
    """Writes the class."""

    def lines(self) -> Iterator[str]:
        """The class."""
        step, end = [*self._step()], [*self._end()]
        yield "class Generated(Gauge):"
        yield f"    __slots__ = {tuple(self.state)!r}"
        yield ""
        yield "    def __init__(self, first):"
        yield "        super().__init__(first)"
        yield from indented((f"self.{name} = {value}" for name, value in self.state.items()), 2)
        yield ""
        yield "    def step(self, start, values, now, reached):"
        yield from indented(step, 2)
        yield ""
        yield "    def end(self, end, reached):"
        yield from indented(end, 2)

    def _step(self) -> Iterator[str]:
        """Take a letter from `start` on, or none, that is known up to `now`."""
        read = [(n, place) for n, (place, _) in enumerate(self.plan.leaves)]
        read = [(n, place) for n, place in read if place not in self.fixed]
        yield "if values is None:"
        yield f"    {' = '.join(f'm{place}' for _, place in read)} = False"
        yield "else:"
        for number, place in read:
            yield f"    x{place} = values[{number}]"
            if self.sparse:
                yield f"    m{place} = True"
            else:
                self.state[f"x{place}"] = "None"
                yield f"    m{place} = x{place} != self.x{place}"
                yield f"    self.x{place} = x{place}"
        for place, node in self.plan.inner:
            yield from self._node(place, node)
        yield from self._answers()

    def _end(self) -> Iterator[str]:
        """Tell all that is left, when all that is read is known up to the last position."""
        yield "now = end.last"
        yield f"start = {' = '.join(f'm{place}' for place, _ in self.plan.leaves)} = 0"
        for place, _ in self.plan.leaves:
            yield f"x{place} = 0.0"
        for place, node in self.plan.inner:
            yield from self._node(place, node, end=True)
        yield from self._answers()

    def _answers(self) -> Iterator[str]:
        """What is asked for of the formula and is settled now."""
        root = len(self.plan.nodes) - 1
        news, known = f"n{root}", f"k{root}"
        if self.is_leaf(root):
            news, known = f"[(start, x{root})] if m{root} else ()", "now"
        yield f"news = {news}"
        yield "if self.asked:"
        yield f"    return self.answers(news, {known})"
        yield "if news:"
        yield "    self.reported = news[-1][1]"
        yield "return ()"

    def _node(self, place: int, node: Node, *, end: bool = False) -> Iterator[str]:
        yield f"# {place}: {node!r}".replace("\n", " ")
        yield f"n{place} = []"
        match node:
            case Window():
                yield from self.window(place, node, end=end)
            case Shift():
                yield from self.shift(place, node, end=end)
            case Junction():
                yield from self.junction(place, node)
            case Sweep(future=False):
                yield from self.since(place, node)
            case Sweep():
                yield from self.until(place, node, end=end)
            case Leaf():
                raise AssertionError("it reads a letter")
