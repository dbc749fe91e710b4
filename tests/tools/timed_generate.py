"""Random small networks of timed automata with queries, as `.ta` text."""

from random import Random

_COMPARISONS = ("<", "<=", "==", ">=", ">")


def random_model(seed: int) -> str:
    """A network of one to three automata with queries of every kind; the same for the same seed.

    All parts of the model occur: integer guards and updates, resets to a number, binary, broadcast
    and urgent channels, clock guards on receivers of broadcasts, urgent and committed locations,
    strict and equal bounds, edges that branch; in every second model a record, an array, and
    functions with local variables, branches, loops, parameters by value and by reference, which
    also set clocks; in every third one priorities of channels, automata or both.
    """
    return _RandomModel(Random(seed), functions=seed % 2 == 1, ranked=seed % 3 == 0).model()


class _RandomModel:
    """One throw of everything."""

    def __init__(self, random: Random, functions: bool, ranked: bool) -> None:
        self._random = random
        self._functions = functions
        self._ranked = ranked
        self._clocks = ["x", "y", "z"][: random.choice((1, 2, 2, 2, 3))]
        self._largest = 2 if len(self._clocks) == 3 else random.choice((1, 2, 3))
        self._automata = random.choice((1, 2, 2, 3))
        self._locations = [random.randint(2, 3) for _ in range(self._automata)]
        self._channels = ["c", "d"] if self._automata > 1 else []
        self._kinds = {c: random.choice(("", "", "broadcast ", "urgent ")) for c in self._channels}

    def model(self) -> str:
        lines = ["network random", f"clock {', '.join(self._clocks)}", "int[0,2] v", "bool b"]
        lines += [f"{self._kinds[channel]}chan {channel}" for channel in self._channels]
        if self._functions:
            lines += self._computing()
        for index in range(self._automata):
            lines += self._automaton(index)
        if self._ranked:
            lines += self._priorities()
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
        for _ in range(random.randint(2, 5)):
            lines += self._edge(count)
        return [*lines, "}"]

    def _priorities(self) -> list[str]:
        """Lists of priorities in which each separator is drawn."""
        random = self._random
        lines = []
        for begin, names in (
            ("chan priority ", [*self._channels, "default"]),
            ("system ", [f"P{index}" for index in range(self._automata)]),
        ):
            if begin == "system " or random.random() < 0.7:
                random.shuffle(names)
                signs = [random.choice((" < ", " < ", ", ")) for _ in names[1:]]
                pairs = zip(names, [*signs, ""], strict=True)
                lines.append(begin + "".join(name + sign for name, sign in pairs))
        return lines

    def _edge(self, count: int) -> list[str]:
        """An edge, or the branches of one."""
        random = self._random
        text = f"  edge l{random.randrange(count)} -> "
        sync, guards = "", []
        if self._channels and random.random() < 0.5:
            channel, end = random.choice(self._channels), random.choice("!?")
            sync = f" on {channel}{end}"
            bare = self._kinds[channel].startswith("urgent")
        else:
            bare = False
        if not bare and random.random() < 0.7:
            guards += [self._compare() for _ in range(random.choice((1, 1, 2)))]
        if random.random() < 0.2:
            guards.append(f"v {random.choice(_COMPARISONS)} {random.randint(0, 2)}")
        if random.random() < 0.1:
            guards.append(random.choice(("b", "not b")))
        if self._functions and random.random() < 0.3:
            guards.append(
                random.choice(
                    (
                        "some(w, 1)",
                        "next(v) == 1",
                        "r.n > 0",
                        "not r.b",
                        "w[v % 2] < 2",
                        "(v & 1) == 0",
                    )
                )
            )
        when = f" when {' and '.join(guards)}" if guards else ""
        branches = 2 if random.random() < 0.15 else 1
        return [
            f"{text}l{random.randrange(count)}{when}{sync}{self._updates()} weight {1 / branches}"
            for _ in range(branches)
        ]

    def _updates(self) -> str:
        random = self._random
        updates = []
        if random.random() < 0.6:
            updates.append(f"{self._clock()} = {random.choice((0, 0, 0, 0, 1))}")
        if random.random() < 0.2:
            updates.append(random.choice(("v = (v + 1) % 3", "v = 0", "v = 2 - v")))
        if random.random() < 0.1:
            updates.append("b = not b")
        if self._functions and random.random() < 0.6:
            updates.append(
                random.choice(
                    ("act()", "put(v, 2)", "put(w[v % 2], next(v))", "put(r.n, 1)", "v = next(r.n)",
                     "w[r.n % 2] = v <? 1", "r.b = some(w, 0)", "w[0] = w[1] = next(v)")
                )
            )  # fmt: skip
        return f" do {', '.join(updates)}" if updates else ""

    def _computing(self) -> list[str]:
        """A record, an array and functions over them."""
        return [
            "typedef struct { int[0,2] n; bool b; } pair",
            "pair r = {1, false}",
            "int[0,2] w[2] = {0, 2}",
            f"int[0,2] next(int[0,2] n) {{ int[0,2] k = n; {self._statements('k')}",
            "  return (k + 1) % 3; }",
            "bool some(int[0,2] z[2], int[0,2] n) {",
            "  for (i : int[0,1]) { if (z[i] > n) return true; z[i] = n; } return false; }",
            "void put(int[0,2] &to, int[0,2] by) {",
            "  while (by > 0) { to = (to + 1) % 3; by--; if (to == 2 && b) return; } }",
            f"void act() {{ pair old = r; int[0,2] k; {self._statements('k')}",
            f"  if (old == r) {{ {self._clock()} = 0; r.b = not r.b; }} else put(w[old.n % 2], k);",
            "  r.n = next(k); }",
        ]

    def _statements(self, local: str) -> str:
        """Some statements that change a local variable."""
        random = self._random
        ways = (
            lambda: f"{local} = ({local} + {random.randint(1, 2)}) % 3;",
            lambda: f"if ({local} {random.choice(_COMPARISONS)} v) {local} = 2 - {local};",
            lambda: f"for (i : int[0,{random.randint(0, 2)}]) {local} = ({local} + w[i % 2]) % 3;",
            lambda: f"do {{ {local} = {local} >? 1; }} while ({local} == 0);",
            lambda: f"{local} = b ? {local} : {random.randint(0, 2)};",
            lambda: (
                f"if (r.b) {{ int[0,2] j = {local}; {local} = (j * 2) % 3; }} else {local} = 0;"
            ),
        )
        return " ".join(random.choice(ways)() for _ in range(random.randint(1, 3)))

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
