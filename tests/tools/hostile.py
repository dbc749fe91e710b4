"""Names that would be something else in some output, if that wrote them as they are."""

import random
import re
from collections.abc import Iterator

STEERING = re.compile(r"[\x00-\x09\x0b-\x1f\x7f-\x9f\u061c\u200e\u200f\u2028-\u202e\u2066-\u2069]")
"""What no output may bring to a terminal; ends of lines are its own."""

FORGERIES = (
    'A":{"verdict":"P","attempts":[],"counts":{"P":1}},"B',
    '"""; raise SystemExit("run"); """',
    "*\\ int forged; /*",
    "c\rraise SystemExit('run')#",
    "\x1b[31mred\x1b[8m",
    "\x1b]0;title\x07",
    "\x9b31m",
    "\u202eesrever\u202c",
    "\u2066apart\u2069",
    "back\\",
    '\\"',
    '=HYPERLINK("http://a")',
    "+1+1",
    "-2-3",
    "@SUM(1)",
    "\t=1",
    "\r=1",
    "@prefix@ @HEADER@",
    "</script><script>alert(1)</script>",
    '"><img src=x onerror=alert(1)>',
    "' onmouseover='alert(1)",
    "]]><!--",
    "&amp;&#60;",
    "\\end{table}\\input{x}%",
    "[1cm] ^^M $x_1$ #&~{}",
    "*{2}",
    "|a|b|",
    "[red]markup[/red][/]",
    ":smile:",
    '"]; x [label="',
    "--END--",
    "%s%n%d",
    "a,b;c",
    "d\u2028z\u2029\x85",
    "\x0cpage\x0b\x7f\x08",
    "nul\x00",
    "\ufffe\ufeff\u200b",
    "äöü 名前 🤖",
)
"""One for each way that is known."""

_LETTERS = (
    [chr(code) for code in range(0xA0) if chr(code) not in "`\n"]
    + list("\u061c\u200e\u200f\u2028\u2029\u202a\u202b\u202c\u202d\u202e\u2066\u2067\u2068\u2069")
    + list("äß名\u00a0\u3000\ufffd\ufffe🤖")
)


def hostile_names(count: int, seed: int = 0) -> Iterator[str]:
    """Different names that a specification accepts in backticks: the forgeries, then random ones.

    Args:
        count: how many.
        seed: of the random ones.

    >>> len(set(hostile_names(1000)))
    1000
    """
    rng = random.Random(seed)
    known: set[str] = set()
    waiting = list(reversed(FORGERIES))
    while len(known) < count:
        if waiting:
            name = waiting.pop()
        elif rng.random() < 0.5:
            name = "".join(rng.choices(_LETTERS, k=rng.randint(2, 12)))
        else:
            left, right = rng.choice(FORGERIES), rng.choice(FORGERIES)
            name = left[: rng.randint(1, 12)] + rng.choice(_LETTERS) + right[-12:]
        if name.strip() and name not in known:
            known.add(name)
            yield name
