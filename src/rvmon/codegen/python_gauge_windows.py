"""Nodes of a gauge that look along the trace, as Python source: windows, and what is moved."""

from __future__ import annotations

from collections.abc import Iterator

from rvmon.codegen.python_gauge import GaugeWriter
from rvmon.codegen.python_visit import indented
from rvmon.dataflow.nodes import Shift, Sweep, Window


class WindowWriter(GaugeWriter):
    """Writes windows and shifts."""

    def window(self, place: int, node: Window, *, end: bool) -> Iterator[str]:
        """The extreme of the operand over a window, by a monotonic wedge.

        `wedge` has the values that may be the extreme of a window to come, the best one first, and
        `exits` of each the last integer whose window holds it. `late` is what the operand is behind
        that; `next` is the first integer whose value is not reported.
        """
        state = self.state
        state |= {f"{name}{place}": "deque()" for name in ("wedge", "exits", "late")}
        state |= {f"next{place}": "first"}
        nothing = "INF" if node.every else "-INF"
        low, high = node.low, node.high
        yield f"wedge, exits, late = self.wedge{place}, self.exits{place}, self.late{place}"
        yield f"until = limit = {self._limit(node)}"
        if low <= high:  # else no window holds anything
            yield from self.given(node.operand, "late")
            yield f"known = {self.known(node.operand)} - {high}"
            yield "if known < until:"
            yield "    until = known"
        yield f"next_, nothing = self.next{place}, {nothing}"
        if self.sparse:
            state[f"at{place}"] = "deque()"
            yield f"at = self.at{place}"
            if not end:
                yield "if values is not None:"
                yield "    at.append(start)"
        else:
            state[f"reported{place}"] = "None"
            yield f"reported = self.reported{place}"
        lines = [*self._wedge(place, node.every, low, high)]
        if end:
            yield f"late.append((end.last + 1, {nothing}))"
            yield "for until in (limit if limit < end.last else end.last, end.last):"
            yield from indented(lines)
            if node.over is not None:
                yield f"    if end.pending != {nothing}:"
                yield "        nothing = end.pending"
                yield "        wedge.clear()"
                yield "        exits.clear()"
                yield "        late.clear()"
        else:
            yield from lines
        yield f"self.next{place} = next_"
        if not self.sparse:
            yield f"self.reported{place} = reported"
        yield f"k{place} = next_ - 1"

    def _limit(self, node: Window) -> str:
        """The last integer of which no further position comes to lie in its window."""
        if node.over is None:
            return "now"
        return (
            f"reached - {node.over}" if self.gap == 1 else f"(reached - {node.over}) // {self.gap}"
        )

    def _wedge(self, place: int, every: bool, low: int, high: int) -> Iterator[str]:
        """Take in what is `late` and report all values, up to where windows are known."""
        yield "while True:"
        yield f"    if late and late[0][0] <= until + {high + 1}:"
        yield "        entry, value = late.popleft()"
        yield f"        stop = entry - {high + 1}"
        yield "    else:"
        yield "        entry, stop = None, until"
        yield from indented(self._report_sparsely(place) if self.sparse else self._report(place))
        yield "    if entry is None:"
        yield "        break"
        if not self.sparse:
            yield "    if exits:"
            yield f"        exits[-1] = entry - {low + 1}"
        yield f"    while wedge and wedge[-1] {'>=' if every else '<='} value:"
        yield "        wedge.pop()"
        yield "        exits.pop()"
        yield "    wedge.append(value)"
        yield f"    exits.append({f'entry - {low}' if self.sparse else 'FAR'})"

    def _report(self, place: int) -> Iterator[str]:
        yield "while next_ <= stop:"
        yield "    while exits and exits[0] < next_:"
        yield "        exits.popleft()"
        yield "        wedge.popleft()"
        yield "    best, right = nothing, stop"
        yield "    if exits:"
        yield "        best = wedge[0]"
        yield "        if exits[0] < stop:"
        yield "            right = exits[0]"
        yield "    if best != reported:"
        yield "        reported = best"
        yield f"        n{place}.append((next_, best))"
        yield "    next_ = right + 1"

    def _report_sparsely(self, place: int) -> Iterator[str]:
        yield "while at and at[0] <= stop:"
        yield "    position = at.popleft()"
        yield "    while exits and exits[0] < position:"
        yield "        exits.popleft()"
        yield "        wedge.popleft()"
        yield f"    n{place}.append((position, wedge[0] if wedge else nothing))"
        yield "if next_ <= stop:"
        yield "    next_ = stop + 1"

    def shift(self, place: int, node: Shift, *, end: bool) -> Iterator[str]:
        """An `until` or `since` so many integers further on; `late` counts as it does."""
        sweep, offset = self.plan.sweep_of(node), node.offset
        before = f"[(first, {'INF' if sweep.dual else '-INF'})]" if offset < 0 else ""
        self.state[f"late{place}"] = f"deque({before})"
        self.state[f"k{place}"] = "first - 1"
        yield f"late = self.late{place}"
        yield f"for entry, value in n{node.operand}:"
        yield f"    late.append((entry - {offset}, value))"
        yield f"known = {'FAR' if end else f'k{node.operand} - {offset}'}"
        if end and offset > 0:
            yield from self._moved_end(node, sweep)
        if self.sparse:
            yield from self._moved_sparsely(place, offset > 0, end=end)
        else:
            yield "until = known if known < now else now"
            yield "if until >= self.first:"
            yield "    while late and late[0][0] <= until:"
            yield "        entry, value = late.popleft()"
            yield "        right = late[0][0] - 1 if late and late[0][0] <= until else until"
            yield "        if entry < self.first:"
            yield "            entry = self.first"
            yield "        if entry <= right:"
            yield f"            n{place}.append((entry, value))"
            yield f"    self.k{place} = until"
        yield f"k{place} = self.k{place}"

    def _moved_sparsely(self, place: int, ahead: bool, *, end: bool) -> Iterator[str]:
        """An `until` has the value of the next position, a `since` that of the last."""
        self.state[f"at{place}"] = "deque()"
        yield f"at = self.at{place}"
        if not end:
            yield "if values is not None:"
            yield "    at.append(start)"
        yield f"until = {'late[-1][0] if late else known' if ahead else 'known'}"
        yield "if now < until:"
        yield "    until = now"
        yield "while at and at[0] <= until:"
        yield "    position = at.popleft()"
        first, last = (0, 1) if ahead else (1, 0)
        yield f"    while len(late) > 1 and late[{first}][0] <= position - {last}:"
        yield "        late.popleft()"
        yield f"    n{place}.append((position, late[0][1]))"
        yield f"self.k{place} = until"

    def _moved_end(self, node: Shift, sweep: Sweep) -> Iterator[str]:
        """Take what is assumed of the operand behind the end, up to where its windows opened."""
        yield f"opened = (end.instant - {node.opens}) // {self.gap}"
        if self.sparse:
            yield "if end.rest is Rest.END:"
            yield f"    late.append((opened, end.behind({sweep.kept})))"
            yield "late.append((FAR, -INF if end.rest is Rest.END else end.pending))"
            return
        yield f"late.append((end.last - {node.offset - 1}, end.behind({sweep.kept})))"
        yield "if end.rest is Rest.END:"
        yield "    late.append((opened + 1, -INF))"
