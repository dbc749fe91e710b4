"""What the tests of the language share."""

import random
import re
from dataclasses import fields, is_dataclass

import pytest

from rvmon.diagnostics import Span
from rvmon.errors import SpecError
from rvmon.spec import compile_text
from rvmon.spec.checked import Binary, BinaryOp, CheckedSpec
from rvmon.spec.printer import format_duration, format_formula, format_numeric
from rvmon.testing.generate_spec import Profile, random_spec

NAMES = """spec demo
signal a, b, c : bool
signal x, y : real
signal d : real [m]
signal speed : real [m/s]
signal n : int
signal state : {idle, moving, S}
event e, f
event pick(id: int, x: real [m], ok: bool, kind: {bolt, nut})
"""


@pytest.fixture
def checked():
    """Compile declarations of common use and further text; returns the checked specification."""
    return lambda text, **options: compile_text(NAMES + text, **options)[0]


@pytest.fixture
def requirement(checked):
    """The requirement with the given body."""
    return lambda body, **options: checked(f"requirement R {body}", **options).requirements["R"]


@pytest.fixture
def owed(requirement):
    """A formula, checked and printed again."""
    return lambda formula: format_formula(requirement(f"upon start then {formula}").consequent)


@pytest.fixture
def codes():
    """The codes of all findings of a text after the common declarations, but for unread names."""

    def found(text, **options):
        try:
            findings = compile_text(NAMES + text, **options)[1]
        except SpecError as error:
            findings = error.diagnostics
        return [finding.code for finding in findings if finding.code != "RV046"]

    return found


@pytest.fixture
def message(codes):
    """The message and help of the only finding."""

    def found(text):
        with pytest.raises(SpecError) as caught:
            compile_text(NAMES + text)
        (finding,) = caught.value.diagnostics
        return f"{finding.message} | {finding.help}"

    return found


SYNONYMS = {
    "not": ("not", "!"),
    "and": ("and", "&", "&&"),
    "or": ("or", "|", "||"),
    "->": ("->", "implies"),
    "<->": ("<->", "iff"),
    "eventually": ("eventually", "F"),
    "always": ("always", "G"),
    "next": ("next", "X"),
    "previous": ("previous", "Y"),
    "once": ("once", "O"),
    "historically": ("historically", "H"),
    "until": ("until", "U"),
    "unless": ("unless", "W", "weak until"),
    "since": ("since", "S"),
    "==": ("==", "="),
}
WORD = re.compile(
    r"for each|at end|stale after|\d[\d.]*(?: (?:[numk]?s|min|h)\b)?"
    r"|[\w.]+|<->|->|==|!=|<=|>=|[^\w\s]|\s+"
)


def _text_of(spec: CheckedSpec) -> str:
    """A checked specification as text."""
    lines = ["spec random", f"time {spec.time}" + _period(spec)]
    for signal in spec.signals.values():
        kind = signal.type.kind.value
        shown = "{" + ", ".join(signal.type.labels) + "}" if kind == "label" else kind
        stale = f" stale after {format_duration(signal.stale_after)}" if signal.stale_after else ""
        lines.append(f"signal {signal.name} : {shown}{stale}")
    for event in spec.events.values():
        fields = ", ".join(f"{name}: {type_.kind.value}" for name, type_ in event.fields.items())
        lines.append(f"event {event.name}" + (f"({fields})" if fields else ""))
    for requirement in spec.requirements.values():
        lines.append(f'requirement {requirement.id} "{requirement.text}"')
        lines.append(f"  {requirement.mode} {format_formula(requirement.trigger)}")
        lines.append(f"  then {format_formula(requirement.consequent)}")
        if requirement.for_each:
            each = requirement.for_each
            lines.append(f"  for each {each.name} in {format_numeric(each.value)}")
        lines += [
            f"  let {capture.name} = {format_numeric(capture.value)}"
            for capture in requirement.captures
        ]
        lines.append(f"  at end: {requirement.at_end}")
    return "\n".join(lines) + "\n"


def _period(spec):
    """The period of clocked time."""
    return f" {format_duration(spec.period)}" if spec.period else ""


def _random_text(seed: int) -> str:
    """A random specification."""
    return _text_of(random_spec(random.Random(seed), Profile()))


def _scribbled(text: str, dice: random.Random) -> str:
    """The same with synonyms, other spaces, and comments wherever they may stand."""
    lines = []
    for line in text.split("\n"):
        words = []
        for word in WORD.findall(line.strip()):
            if word.isspace():
                words.append(dice.choice((" ", "  ", " ", "\t")))
            else:
                words.append(dice.choice(SYNONYMS.get(word, (word,))))
            if dice.random() < 0.02 and word.isspace():
                words.append(dice.choice(("# note\n   ", "\n  # own line\n ", "\n ")))
        indent = "" if re.match(r"\s*\w+ ", line) and not line.startswith(" ") else "   "
        comment = dice.choice(("  # remark", "")) if dice.random() < 0.2 else ""
        lines.append(indent + "".join(words) + comment)
        if dice.random() < 0.1:
            lines.append(dice.choice(("", "# above", "  # below", "\n\n")))
    return "\n".join(lines)


CHAINED = (BinaryOp.AND, BinaryOp.OR, BinaryOp.XOR, BinaryOp.IFF)


def _bare(node):
    """A formula without places; chains of an associative connective as flat lists."""
    if isinstance(node, Binary) and node.op in CHAINED:
        return (node.op, *_chain(node, node.op))
    if isinstance(node, tuple):
        return tuple(map(_bare, node))
    if is_dataclass(node) and not isinstance(node, Span):
        return (
            type(node).__name__,
            *(_bare(getattr(node, f.name)) for f in fields(node) if f.name not in ("span", "unit")),
        )
    return node


def _chain(node, op):
    """The operands of a chain."""
    if isinstance(node, Binary) and node.op is op:
        return [*_chain(node.left, op), *_chain(node.right, op)]
    return [_bare(node)]


def _meaning(spec: CheckedSpec):
    """What a specification says, without places and units' spelling."""
    return (
        spec.time,
        spec.period,
        [(s.name, s.type, s.stale_after) for s in spec.signals.values()],
        [(e.name, tuple(e.fields.items())) for e in spec.events.values()],
        [
            (r.id, r.mode, _bare(r.trigger), _bare(r.consequent), r.at_end, r.pulse,
             _bare(r.captures), r.for_each and (r.for_each.name, r.for_each.value))
            for r in spec.requirements.values()
        ],
    )  # fmt: skip


@pytest.fixture
def text_of():
    """A checked specification as text."""
    return _text_of


@pytest.fixture
def random_text():
    """The random specification of a seed as text."""
    return _random_text


@pytest.fixture
def scribbled():
    """A specification in random writing."""
    return _scribbled


@pytest.fixture
def meaning():
    """What a checked specification says, without its places."""
    return _meaning
