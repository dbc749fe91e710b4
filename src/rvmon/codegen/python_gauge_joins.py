"""Nodes of a gauge that join values, as Python source: `and`, `or`, `since`, `until`."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from rvmon.codegen.python_gauge import GaugeWriter
from rvmon.codegen.python_visit import indented
from rvmon.dataflow.nodes import Junction, Sweep, operands_of


class JoinWriter(GaugeWriter):
    """Writes junctions and sweeps."""

    def _join(self, place: int, node: Junction | Sweep, joined: Sequence[str]) -> Iterator[str]:
        """Bring operands to common steps; `at` is where one begins, `c0`, `c1`, … their values."""
        self.state[f"k{place}"] = "first - 1"
        operands = operands_of(node)
        numbered = [(n, one) for n, one in enumerate(operands) if one not in self.fixed]
        known = [*dict.fromkeys(self.known(one) for _, one in numbered)]
        for number, one in enumerate(operands):
            if one in self.fixed:
                yield f"c{number} = {self.fixed[one]}"
        if known == ["now"]:
            yield f"if {' or '.join(f'm{one}' for _, one in numbered)}:"
            yield "    at = start"
            yield from indented((f"c{n} = x{one}" for n, one in numbered))
            yield from indented(list(joined))
            yield f"k{place} = self.k{place} = now"
            return
        if len(numbered) == 1:
            [(number, one)] = numbered
            yield f"for at, c{number} in n{one}:"
            yield from indented(list(joined))
            yield f"k{place} = self.k{place} = k{one}"
            return
        waiting = {number: f"w{number}" for number, _ in numbered}
        for number, one in numbered:
            own = f"{place}_{number}"
            self.state |= {f"w{own}": "deque()", f"c{own}": "-INF"}
            yield f"w{number} = self.w{own}"
            yield from self._held(place, one, f"w{number}")
        least = known[0] if len(known) == 1 else f"min({', '.join(known)})"
        yield f"known = {least}"
        yield f"if known > self.k{place}:"
        yield f"    self.k{place} = known"
        yield from indented((f"c{n} = self.c{place}_{n}" for n, _ in numbered))
        yield "    while True:"
        yield "        at = known + 1"
        for name in waiting.values():
            yield f"        if {name} and {name}[0][0] < at:"
            yield f"            at = {name}[0][0]"
        yield "        if at > known:"
        yield "            break"
        for number, name in waiting.items():
            yield f"        if {name} and {name}[0][0] == at:"
            yield f"            c{number} = {name}.popleft()[1]"
        yield from indented(list(joined), 2)
        yield from indented((f"self.c{place}_{n} = c{n}" for n, _ in numbered))
        yield f"k{place} = self.k{place}"

    def _held(self, place: int, operand: int, kept: str) -> Iterator[str]:
        """Append what is new of an operand to what waits for the others."""
        if not (isinstance(self.plan.nodes[place], Junction) and place in self.alone):
            yield from self.given(operand, kept)
        elif self.is_leaf(operand):
            yield f"if m{operand}:"
            yield f"    self.hold({kept}, start, x{operand})"
        else:
            yield f"for entry, value in n{operand}:"
            yield f"    self.hold({kept}, entry, value)"

    def junction(self, place: int, node: Junction) -> Iterator[str]:
        """All of the operands, or one of them."""
        better = "<" if node.every else ">"
        lines = ["value = c0"]
        for number in range(1, len(node.operands)):
            lines += [f"if c{number} {better} value:", f"    value = c{number}"]
        report = [f"n{place}.append((at, value))"]
        if not self.sparse:
            self.state[f"reported{place}"] = "None"
            report.insert(0, f"self.reported{place} = value")
            report = [f"if value != self.reported{place}:", *indented(report)]
        yield from self._join(place, node, [*lines, *report])

    def _bounds(self, dual: bool) -> Sequence[str]:
        """Between which values an operator keeps that of its neighbour, from its two operands."""
        if dual:
            return ["low, high = (c0 if c0 < c1 else c1), c1"]
        return ["low, high = c1, (c0 if c0 > c1 else c1)"]

    def since(self, place: int, node: Sweep) -> Iterator[str]:
        """S(i) = max(meets(i), min(stays(i), S(i − 1))), or its dual."""
        self.state[f"s{place}"] = "INF" if node.dual else "-INF"
        joined = [
            *self._bounds(node.dual),
            f"value = self.s{place}",
            f"self.s{place} = value = low if value < low else high if value > high else value",
            f"n{place}.append((at, value))",
        ]
        yield from self._join(place, node, joined)

    def until(self, place: int, node: Sweep, *, end: bool) -> Iterator[str]:
        """U(i) = max(meets(i), min(stays(i), U(i + 1))), or its dual; see `Gauge.follow`."""
        thin = place in self.alone
        self.state[f"parts{place}"] = "deque()"
        starts = self.sparse and not thin
        joined = [*self._bounds(node.dual)]
        if starts:
            self.state[f"starts{place}"] = "deque()"
            joined.append(f"self.starts{place}.append(at)")
        joined += [f"self.follow(parts, at, low, high, {thin})"]
        report = [f"n{place}.append((entry, value))"]
        if starts:
            report = [
                f"starts = self.starts{place}",
                "while starts and starts[0] <= right:",
                f"    n{place}.append((starts.popleft(), value))",
            ]
        yield f"parts = self.parts{place}"
        yield from self._join(place, node, joined)
        yield "while parts and parts[0][3] == parts[0][4]:"
        yield "    entry, _, _, value, _ = parts.popleft()"
        yield f"    right = parts[0][0] - 1 if parts else self.k{place}"
        yield from indented(list(report))
        if end:
            yield f"rest = self.ended(parts, end.behind({node.kept}), end.last)"
            yield "parts.clear()"
            yield "for entry, value, right in rest:"
            yield from indented(list(report))
        yield f"k{place} = parts[0][0] - 1 if parts else self.k{place}"
