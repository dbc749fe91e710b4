"""Notations of other languages are recognised, and the message gives the rvmon syntax."""

from tests.tools.each import each
from tests.tools.findings import codes_of, findings_of

from rvmon.language.compile import compile_text
from rvmon.language.syntax.parse import grammar
from rvmon.language.syntax.syntax_errors import _word

HEAD = """spec demo
event asked, released
signal speed : real [m/s]
const T = 3 s
"""


def first_finding(text):
    return findings_of(compile_text, HEAD + text)[0]


@each(
    ("required", "fix"),
    [
        ("within -1 s released", "write it without `-`"),
        ("within 1,5 s released", "write `1.5`"),
        ("within .5 s released", "write `0.5`"),
        ("within (3) released", "did you mean `3 s`?"),
        ("within 1.5 released", "`1.5 s released`"),
        ("within 3 s, released", "there is no comma after a duration"),
        ("speed <= 40 A", "`A` is an operator here: write `40 ampere`"),
        ("speed in [-1 m/s, 2 m/s]", "write `(speed >= -1 m/s and speed <= 2 m/s)`"),
        ("delta(speed, 1 s) in [0, 2 m/s]", "write `(delta(speed, 1 s) >= 0 and delta(speed, 1 s)"),
        ("not gaze_ok for 1 s", "write `held(not gaze_ok, 1 s)` for the past"),
        ("within T + 1 s released", "a computed duration needs brackets"),
        ("within 3 sec released", "did you mean `s`?"),
        ("eventually[3 s, 1 s] released", "did you mean `[1 s, 3 s]`?"),
        ("eventually(3 s, 3 s] released", "an open bound leaves its own instant out"),
        ("released within 3 s", "`within 3 s (…)`"),
        ("within 3 s relesed", "did you mean `released`?"),
        ("within 3 s xyzzy", ": bool`, `signal xyzzy : real [m]` or `event xyzzy`"),
        ("within 3 s released asked", "an operator is missing before `asked`"),
        ("after 2 s released", "write `eventually[2 s, 2 s] (…)`"),
    ],
)
def test_faults_in_consequents(required, fix):
    assert fix in first_finding(f"requirement R\n  upon asked\n  then {required}\n").help


@each("word", ["always", "asked and", "(", "not"])
def test_an_error_after_thousands_of_words_is_found(word):
    """The search takes one pass; trying each word anew would take hours."""
    text = f"requirement R\n  upon asked\n  then {f'{word} ' * 2000}$\n"
    finding = first_finding(text)
    assert (finding.code, finding.spans[0].span.text) == ("RV001", "$")


@each(
    ("item", "fix"),
    [
        ("signal w : real [N m]", "parts of a unit are joined by `*` and `/`"),
        ("requirement R if asked then within 3 s released", "for `if` write `upon`"),
        ("requirement R when asked then within 3 s released", "for `when` write `upon`"),
        ("requirement R upon asked, then released", "the consequent comes after `then`"),
        ('requirement "R" upon asked then released', "its name comes first"),
        ("signal x", "a signal has a type"),
        ("signal x : string", "write `{one, another}`"),
        ("requirement R-16 always released", "`R-16` is not a name: write `R_16`"),
        ("requirement always released", "its name comes first, and `always` is not one: "),
        ("requirement G always released", "and `G` is not one: `requirement R1 G …`"),
        ("requirement\n  released", "`released` is read as its name"),
        ("requirement R let z = speed upon asked then released", "comes after the trigger or"),
        ("event e(x)", "a field has a type"),
        ("event e {x: int}", "fields stand in round brackets"),
        ('requirement R "t"\n severity high\n always released', "clause, as `severity …`, comes"),
        ('requirement R "t" source "a b" released', "a clause, as `source …`, comes after"),
        ("requirement R scope after (asked) released", "a clause, as `scope …`, comes after"),
        ("requirement R at end inconclusive released", "a clause, as `at end …`, comes after"),
        ("requirement R for each k in ks released", "a clause, as `for each …`, comes after"),
        ("requirement R in at least 9 % of runs released", "a clause, as `in at …`, comes after"),
        ("requirement R property released", "a clause, as `property …`, comes after"),
        ("requirement R then within 3 s released", "a trigger comes before `then`"),
        ("signal x : real m", "a unit is written in brackets: `[m]`"),
        ("// signals\nsignal x : bool", "a comment begins with `#`"),
        ("signal x : bool // a signal", "a comment begins with `#`"),
        ("/* signals */", "a comment begins with `#`"),
        *(
            (f"requirement R\n  never{operand}\n", "for `never` write `always not (…)`")
            for operand in (" (asked)", "(asked)", " asked")
        ),
        ("event e(id: int)\nrequirement R\n  upon e then e.place > 3", "of `e` are `id`"),
        ("requirement R upon asked within 3 s released", "the consequent comes after `then`"),
        ("requirement R rise (asked)", "a call has no space before its bracket: `rise(`"),
        ("requirement R always speed ≤ 3 m/s", "write `<=`"),
        ("requirement R always asked and A[] released", "put brackets around"),
        ('requirement R always asked\n  sorce "x"', "did you mean `source`?"),
        ("requirement R always asked;", "items and clauses need no `;`"),
    ],
)
def test_items(item, fix):
    assert fix in first_finding(item + "\n").help


def test_trigger_and_consequent_are_both_examined():
    text = "requirement R\n  upon eventually asked\n  then within 1 s no\n  at end: x\n"
    assert codes_of(compile_text, HEAD + text) == ["RV040", "RV012", "RV045"]


STATE = "signal state : {idle, on}\nrequirement R\n  always "


@each(
    ("text", "told", "fix"),
    [
        (
            "requirement R\n  upon asked\n  then within ! released",
            *("found `!`, expected a duration such as `3 s`", ""),
        ),
        ("requirement R always (asked or", "the end of the item, expected a formula or", ""),
        ("requirement R always asked released", "found `released`, expected an operator", ""),
        ("signal z", "expected `,` or `:`", ""),
        ("requirement", "expected a name", ""),
        # A word that starts with a keyword is not split.
        *(
            (f"signal x : {word}", f"found `{word}`, ", f"`{fix}`")
            for word, fix in (("boool", "bool"), ("integer", "int"), ("reals", "real"))
        ),
        # Signs of other languages.
        (f'{STATE}state = "idle"', "expected a number or a name", "have no quotes: `idle`"),
        (f"{STATE}(asked) => (released)", "the end of the item", "write `->`"),
        (f"{STATE}(asked) ==> (released)", "expected a number or a name", "write `->`"),
        (f"{STATE}state becomes idle", "the end of the item", "write `rise(…)`"),
        (f"{STATE}at 3 s released", "the end of the item", "`eventually[3 s, 3 s] (…)`"),
    ],
)
def test_found_and_expected_symbols_are_named(text, told, fix):
    found = first_finding(f"{text}\n")
    assert told in found.message
    assert fix in found.help


def test_every_terminal_has_words():
    for terminal in grammar().terminals:
        if not terminal.name.startswith("__IGNORE"):
            assert not set(_word(terminal.name, grammar())) & set("\\?|^"), terminal.name
