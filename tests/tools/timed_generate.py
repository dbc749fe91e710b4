"""Random small networks of timed automata with queries, as `.ta` text."""

from __future__ import annotations

from random import Random

_COMPARISONS = ("<", "<=", "==", ">=", ">")


def random_model(seed: int) -> str:
    """A network of one to three automata with queries of every kind; the same for the same seed.

    All parts of the model occur: integer guards and updates, resets to a number, binary, broadcast
    and urgent channels, urgent and committed locations, strict and equal bounds.
    """
    return _RandomModel(Random(seed)).model()


class _RandomModel:
    """One throw of everything."""

    def __init__(self, random: Random) -> None:
        self._random = random
        self._clocks = ["x", "y", "z"][: random.choice((1, 2, 2, 2, 3))]
        self._largest = 2 if len(self._clocks) == 3 else random.choice((1, 2, 3))
        self._automata = random.choice((1, 2, 2, 3))
        self._locations = [random.randint(2, 3) for _ in range(self._automata)]
        self._channels = ["c", "d"] if self._automata > 1 else []
        self._kinds = {c: random.choice(("", "", "broadcast ", "urgent ")) for c in self._channels}

    def model(self) -> str:
        lines = ["network random", f"clock {', '.join(self._clocks)}", "int[0,2] v", "bool b"]
        lines += [f"{self._kinds[channel]}chan {channel}" for channel in self._channels]
        for index in range(self._automata):
            lines += self._automaton(index)
        lines += [f"query: {query}" for query in self._queries()]
        return "\n".join(lines) + "\n"

    def _automaton(self, index: int) -> list[str]:
        random, count = self._random, self._locations[index]
        lines = [f"automaton P{index} {{"]
        for place in range(count):
            kind = random.choice(("", "", "", "", "", "urgent ", "committed "))
            # The start is left free, so that few models are stuck before they begin.
            invariant = ""
            if place and random.random() < 0.5:
                sign = random.choice(("<", "<=", "<="))
                invariant = f" invariant {self._clock()} {sign} {random.randint(1, self._largest)}"
            lines.append(f"  {kind if place else ''}location l{place}{invariant}")
        lines.append("  start l0")
        lines += [self._edge(count) for _ in range(random.randint(2, 5))]
        return [*lines, "}"]

    def _edge(self, count: int) -> str:
        random = self._random
        text = f"  edge l{random.randrange(count)} -> l{random.randrange(count)}"
        sync, guards = "", []
        if self._channels and random.random() < 0.5:
            channel, end = random.choice(self._channels), random.choice("!?")
            sync = f" on {channel}{end}"
            bare = self._kinds[channel].startswith("urgent") or (
                self._kinds[channel] and end == "?"
            )
        else:
            bare = False
        if not bare and random.random() < 0.7:
            guards += [self._compare() for _ in range(random.choice((1, 1, 2)))]
        if random.random() < 0.2:
            guards.append(f"v {random.choice(_COMPARISONS)} {random.randint(0, 2)}")
        if random.random() < 0.1:
            guards.append(random.choice(("b", "not b")))
        updates = []
        if random.random() < 0.6:
            updates.append(f"{self._clock()} = {random.choice((0, 0, 0, 0, 1))}")
        if random.random() < 0.2:
            updates.append(random.choice(("v = (v + 1) % 3", "v = 0", "v = 2 - v")))
        if random.random() < 0.1:
            updates.append("b = not b")
        when = f" when {' and '.join(guards)}" if guards else ""
        return text + when + sync + (f" do {', '.join(updates)}" if updates else "")

    def _clock(self) -> str:
        return self._random.choice(self._clocks)

    def _compare(self) -> str:
        number = self._random.randint(0, self._largest)
        return f"{self._clock()} {self._random.choice(_COMPARISONS)} {number}"

    def _state(self, depth: int = 2) -> str:
        random = self._random
        match random.choice(("place", "place", "clock", "data", "not", "and", "or")):
            case "not" if depth:
                return f"not ({self._state(depth - 1)})"
            case "and" | "or" as word if depth:
                return f"({self._state(depth - 1)} {word} {self._state(depth - 1)})"
            case "clock":
                return self._compare()
            case "data":
                return random.choice(("b", "v == 1", "v > 0"))
            case _:
                index = random.randrange(self._automata)
                return f"P{index}.l{random.randrange(self._locations[index])}"

    def _queries(self) -> list[str]:
        bound = self._random.randint(1, 3)
        return [
            f"E<> {self._state()}",
            f"A[] {self._state()}",
            f"A<> {self._state()}",
            f"E[] {self._state()}",
            f"{self._state()} --> {self._state()}",
            f"{self._state(1)} -->[<={bound}] {self._state(1)}",
            f"E<>[<={bound}] {self._state()}",
            f"A<>[<={bound}] {self._state()}",
            "E<> deadlock",
            f"A[] (deadlock imply {self._state()})",
            f"A[] ({self._state(1)} imply EF {self._state(1)})",
            f"E<> ({self._state(1)} and AG {self._state(1)})",
            f"A[] ({self._state(1)} or AF {self._state(1)} or {self._state(1)})",
            f"E<>[<={bound}] deadlock",
        ]
