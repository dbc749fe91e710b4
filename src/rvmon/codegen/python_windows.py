"""Windows within windows as Python source: where values change, and since when one is known.

A value of the base changes at some positions; so does the value of each window over it. A stretch
on which one position decides begins as far before that of the operand as the window reaches, and
ends as its last position leaves the window; shorter gaps vanish. So one change of the base is one
of each window: it comes to stand behind the others, or takes the last one away. The lists hold what
will be if the letter stays: a change that lies ahead is taken back if it does not.

Source: AUTOMATA 4; `rvmon.dataflow.chain` says why what is known is known in order.
"""

from __future__ import annotations

from bisect import bisect_left, bisect_right
from collections.abc import Iterator
from typing import Any

from rvmon.codegen.python_visit import indented
from rvmon.dataflow.chain import Chain, Windows, reach_of
from rvmon.dataflow.nodes import Junction, NetworkPlan
from rvmon.runtime.values import NEVER


def windows_class(plan: NetworkPlan, chain: Chain, gap: int | None) -> type[Windows]:
    """The class of a chain.

    Args:
        plan: that the chain is.
        chain: as `chain_of` gives it.
        gap: ticks between two positions; `None` if only samples are positions.
    """
    namespace: dict[str, Any] = {
        "__name__": "rvmon.generated",
        "Windows": Windows,
        "bisect_left": bisect_left,
        "bisect_right": bisect_right,
        "NEVER": 2 * NEVER,
    }
    source = windows_source(plan, chain, gap)
    # The source holds numbers of the plan only.
    exec(compile(source, "<generated windows>", "exec"), namespace)  # noqa: S102
    made: type[Windows] = namespace["Generated"]
    return made


def windows_source(plan: NetworkPlan, chain: Chain, gap: int | None) -> str:
    """The source of a class `Generated(Windows)`; the arguments are those of `windows_class`."""
    return "\n".join(_Writer(plan, chain, gap).lines()) + "\n"


class _Writer:
    """Writes the class.

    `changes` of each level are the positions at which its value changes, `begun` is the value
    before all of them; level 0 is the base. `ends` are those of the leaf that ends what is kept up.
    """

    def __init__(self, plan: NetworkPlan, chain: Chain, gap: int | None) -> None:
        self.plan, self.chain = plan, chain
        self.gap, self.sparse = gap or 1, gap is None
        self.levels = range(len(chain.windows) + (chain.left is not None))
        """The last one is asked by its stamps alone where nothing is kept up."""
        self.index = {place: index for index, (place, _) in enumerate(plan.leaves)}

    def lines(self) -> Iterator[str]:
        """The class."""
        yield "class Generated(Windows):"
        for signature, body in (
            ("__init__(self, start, letter)", self._init()),
            ("note(self, position, letter)", self._note()),
            ("outcome(self, position)", self._outcome()),
            ("forget(self, position)", self._forget()),
        ):
            yield f"    def {signature}:"
            yield from indented(body, 2)

    def _value(self, place: int) -> str:
        node = self.plan.nodes[place]
        if isinstance(node, Junction):
            word = " and " if node.every else " or "
            return f"({word.join(map(self._value, node.operands))})"
        return f"letter[{self.index[place]}]"

    def _init(self) -> Iterator[str]:
        yield f"self.value = {self._value(self.chain.base)}"
        for level in self.levels:
            yield f"self.changes{level} = []"
            yield f"self.begun{level} = self.value"
        if self.chain.left is not None:
            yield f"self.ended = self.end_begun = {self._value(self.chain.left)}"
            yield "self.ends = []"
            yield "self.start = start"
        if self.sparse:
            yield "self.stamps = []"

    def _note(self) -> Iterator[str]:
        if self.sparse:
            yield "self.stamps.append(position)"
        if self.chain.left is not None:
            yield f"if {self._value(self.chain.left)} is not self.ended:"
            yield "    self.ended = not self.ended"
            yield "    self.ends.append(position)"
        yield f"value = {self._value(self.chain.base)}"
        yield "if value is self.value:"
        yield "    return"
        yield "self.value = value"
        yield "self.changes0.append(position)"
        if len(self.levels) > 1:
            yield "added = True"
        for level in self.levels[1:]:
            yield from self._changed(level)

    def _reached(self, low_or_high: int) -> str:
        """The first position from which a window reaches one."""
        back = f"position - {low_or_high}" if low_or_high else "position"
        if not self.sparse or not low_or_high:
            return back
        return f"self.stamps[bisect_left(self.stamps, {back})]"

    def _changed(self, level: int) -> Iterator[str]:
        """Take the change of the operand at `position`, which is `added` or taken away.

        Its last value is that of the base, as that of all levels is.
        """
        window = self.chain.windows[level - 1]
        back = f" - {window.low}" if window.low else ""
        decides = "not value" if window.every else "value"
        yield f"given, own = self.changes{level - 1}, self.changes{level}"
        yield f"if ({decides}) is added:"  # what decides begins here, or does not any more
        yield f"    start = {self._reached(window.high)}"
        yield "    if added:"
        yield "        added = not (own and own[-1] >= start)"
        yield "    else:"  # the stretch before, if that was joined to it, ends again
        yield f"        position = given[-1]{back} if given else start - 1"
        yield "        added = position >= start"
        yield "        start = position"
        yield "else:"
        yield f"    start = position{back}"
        yield "if added:"
        yield "    own.append(start)"
        yield "    position = start"
        yield "else:"
        yield "    position = own.pop()"

    def _outcome(self) -> Iterator[str]:
        top = len(self.chain.windows)
        if self.chain.left is None:
            yield from self._known(top, returns=True)
            return
        yield "if position < self.start:"
        yield "    position = self.start"
        for name, changes, begun in (
            ("ends", "self.ends", "self.end_begun"),
            ("fails", f"self.changes{top}", f"not self.begun{top}"),
        ):
            yield f"changes, index = {changes}, bisect_right({changes}, position)"
            yield f"if ({begun}) is not (index & 1 == 1):"
            yield f"    {name} = position"
            yield "else:"
            yield f"    {name} = changes[index] if index < len(changes) else NEVER"
        yield "if fails < ends:"
        yield "    position = fails"
        yield from indented(self._known(top, returns=False))
        yield f"    return False, max(at, {2 * self.gap} * position + 1)"
        yield "if ends == NEVER:"
        yield "    return False, NEVER"
        yield f"at = {2 * self.gap} * ends + 1"
        yield "if ends == position:"
        yield "    return True, at"
        yield "end = at"
        if self.sparse:
            yield "position = self.stamps[bisect_left(self.stamps, ends) - 1]"
        else:
            yield "position = ends - 1"
        yield from self._known(top, returns=False)
        yield f"return True, max(at, end, {2 * self.gap} * position + 1)"

    def _known(self, top: int, *, returns: bool) -> Iterator[str]:
        """Find since when the value of a window is known: `at` that of the base at `position`."""
        yield "at = -NEVER"
        for level in range(top, 0, -1):
            window = self.chain.windows[level - 1]
            first = f"position + {window.low}" if window.low else "position"
            yield f"changes, first = self.changes{level - 1}, {first}"
            yield "index = bisect_right(changes, first)"
            begun = f"self.begun{level - 1}"
            # Whether the operand decides at the first position of the window.
            decides = f"({begun} is not (index & 1 == 1)) is {not window.every}"
            yield f"decides = {decides}"
            yield "if not decides:"
            yield f"    if index < len(changes) and changes[index] <= position + {window.high}:"
            yield "        decides = True"
            yield "        first = changes[index]"
            yield "    else:"
            yield f"        over = {2 * self.gap} * position + {2 * (window.over or 0)}"
            yield "        if over > at:"
            yield "            at = over"
            if self.sparse:
                stamps = f"bisect_right(self.stamps, position + {window.high}) - 1"
                yield f"        first = self.stamps[{stamps}]"
            else:
                yield f"        first = position + {window.high}"
            if returns and level == top:
                yield f"value = decides is {not window.every}"
            yield "position = first"
        if returns:
            yield f"return value, max(at, {2 * self.gap} * position + 1)"

    def _forget(self) -> Iterator[str]:
        yield f"start = position - {(reach_of(self.plan) or 0) // self.gap + 2}"
        if self.sparse:
            yield "stamps = self.stamps"
            yield "del stamps[:min(bisect_left(stamps, start), len(stamps) - 1)]"
            yield "start = stamps[0]"
        lists = [(f"changes{level}", f"begun{level}") for level in self.levels]
        if self.chain.left is not None:
            lists.append(("ends", "end_begun"))
        for changes, begun in lists:
            yield f"count = bisect_left(self.{changes}, start)"
            yield f"del self.{changes}[:count]"
            yield "if count & 1:"
            yield f"    self.{begun} = not self.{begun}"
        if self.chain.left is not None:
            yield "start = self.start = max(start, self.start)"
        yield "return start"
