"""The grammar is unambiguous and agrees with the language page."""

import io
import logging

import lark
import pytest
from lark import logger
from tests.tools.each import each
from tests.tools.findings import findings_of

import rvmon
from rvmon.errors import SpecError
from rvmon.language.checked.names_read import names_of_spec
from rvmon.language.compile import compile_text
from rvmon.language.formatter import format_text
from rvmon.language.print import format_formula
from rvmon.language.syntax.keywords import CLAUSE_WORDS, INFIX_WORDS, RESERVED
from rvmon.language.syntax.parse import GRAMMAR_OPTIONS, grammar_text


@pytest.mark.slow
def test_grammar_has_no_conflicts():
    """Building the parser in debug mode logs no conflict."""
    log = io.StringIO()
    handler = logging.StreamHandler(log)
    level = logger.level
    logger.addHandler(handler)
    logger.setLevel(logging.DEBUG)
    try:
        lark.Lark(grammar_text(), debug=True, **GRAMMAR_OPTIONS)
        ambiguous = 'start: a? a?\na: "x"'
        lark.Lark(ambiguous, debug=True, parser="lalr")
    finally:
        logger.removeHandler(handler)
        logger.setLevel(level)
    lines = log.getvalue().splitlines()
    assert [line for line in lines if "onflict" in line] == [
        line for line in lines if "<start : a" in line or "_a" in line
    ]


@each(
    ("text", "printed"),
    [
        ("not a and b", "not a and b"),
        ("! a & b", "not a and b"),
        ("a && b || c", "a and b or c"),
        ("a or b xor c and a", "a or b xor c and a"),
        ("a -> b -> c", "a -> b -> c"),
        ("(a -> b) -> c", "(a -> b) -> c"),
        ("a implies b iff c", "a -> b <-> c"),
        ("G[0, 3 s] a", "for 3 s a"),
        ("eventually <= 3 s a", "within 3 s a"),
        ("F(1 s, 2 s] a", "eventually[1000000001 ns, 2 s] a"),
        ("F[1 s, 2 s) a", "eventually[1 s, 1999999999 ns] a"),
        ("F[1 s, inf) a", "eventually[1 s, inf) a"),
        ("F(3 ns, inf) a", "eventually[4 ns, inf) a"),
        ("F[0, 3 us] a", "within 3 us a"),
        ("F[0, 0] a", "within 0 s a"),
        ("within 1e-3 s a", "within 1 ms a"),
        ("within 1200000 h a", "within 1200000 h a"),
        ("F(a)", "eventually a"),
        ("within (2 * 3 s) (a or b)", "within 6 s (a or b)"),
        ("a U[1 s, 2 s] b", "a until[1 s, 2 s] b"),
        ("a until <= 1 s b", "a until[0, 1 s] b"),
        ("a weak until b", "a unless b"),
        ("a M b", "a M b"),
        ("a S b", "a since b"),
        ("a U b U c", "a until b until c"),
        ("(a U b) U c", "(a until b) until c"),
        ("H[0, 1 s] a", "historically[0, 1 s] a"),
        ("rise(a) and fall(b and c)", "rise(a) and fall(b and c)"),
        ("changed(x) or updated(e) or known(x)", "changed(x) or updated(e) or known(x)"),
        ("x = 3 or x == 4 or x != 5", "x == 3 or x == 4 or x != 5"),
        ("x + y * 2 < -x", "x + y * 2 < -x"),
        ("(x + y) * 2 < 1", "(x + y) * 2 < 1"),
        ("x - (y - 1) < 1", "x - (y - 1) < 1"),
        ("x / y / 2 < 1", "x / y / 2 < 1"),
        ("abs(x) < max(y, 1, 2)", "abs(x) < max(y, 1, 2)"),
        ("rate(d) < 5 m/s", "rate(d) < 5 m/s"),
        ("moving != state", "moving != state"),
        ("pick.ok and pick.id = 3", "pick.ok and pick.id == 3"),
        ("prev(state) == idle", "prev(state) == idle"),
        ("immediately a and b", "a and b"),
        ("x < 1e3", "x < 1000"),
        ("a and always b", "a and always b"),
        ("always (a) and b", "(always a) and b"),
        # Windows after `within`, the same operator on both sides, bounds as in models.
        ("(a unless b) and c", "(a unless b) and c"),
        ("a -> b until c", "a -> b until c"),
        ("within 1 s a or within 2 s b", "(within 1 s a) or within 2 s b"),
        ("within [1 s, 2 s] a", "eventually[1 s, 2 s] a"),
        ("for (1 s, 2 s] a", "always[1000000001 ns, 2 s] a"),
        ("a until[<= 2 s] b", "a until[0, 2 s] b"),
        # A name after a number is its unit; a compound unit has known parts and no spaces.
        ("speed < 5 mm/s", "speed < 0.005 m/s"),
        ("speed < 18 km/h", "speed < 5 m/s"),
        ("d / 2 m < x", "d / 2 m < x"),
        ("5 m/s > speed", "5 m/s > speed"),
        ("d < 5 m and a", "d < 5 m and a"),
        ("d < 5 m until b", "d < 5 m until b"),
        ("x < 5 U b", "x < 5 until b"),
        ("x < 50 %", "x < 0.5"),
        ("state == S S state != S", "state == S since state != S"),
        # Redundant brackets do not count as nesting.
        *(("(" * many + "a" + ")" * many, "a") for many in (90, 99, 150)),
    ],
)
def test_operators(required, text, printed):
    """Words and signs are equivalent, precedence is as documented, printing uses few brackets."""
    assert required(text) == printed


@pytest.mark.parametrize(
    ("text", "help_"),
    [
        ("a unless b and c", "write `… unless (b and …)` or `(a unless b) and …`"),
        ("a and b xor b S c", "write `(… xor b) S …` or `… xor (b S c)`"),
    ],
)
def test_a_connective_beside_until_needs_brackets(text, help_):
    """People read `a unless b and c` as `a unless (b and c)`; by precedence it is the other."""
    text = f"spec s\nsignal a, b, c : bool\nrequirement R upon start then {text}\n"
    assert [one.help for one in findings_of(rvmon.loads, text) if one.code == "RV002"] == [help_]


@each(
    ("text", "same"),
    [
        ("mode in {red, blue}", "mode == red or mode == blue"),
        ("mode not in {red, blue}", "not (mode == red or mode == blue)"),
        ("x in {1, 2}", "x == 1 or x == 2"),
        ("x <= (if a then 1 else 2)", "a and x <= 1 or not a and x <= 2 or x <= 1 and x <= 2"),
        ("if a then b else c", "a and b or not a and c or b and c"),
        (
            "2 * (if a then x else 1) <= 3",
            "a and 2 * x <= 3 or not a and 2 * 1 <= 3 or 2 * x <= 3 and 2 * 1 <= 3",
        ),
        ("define_d(x) <= 1", "a and x <= 1 or not a and 2 <= 1 or x <= 1 and 2 <= 1"),
    ],
)
def test_sets_and_choices(text, same):
    head = (
        "spec s\nsignal a, b, c : bool\nsignal x : real\nsignal mode : {red, blue, green}\n"
        "define define_d(y) = if a then y else 2\n"
    )
    required = [
        rvmon.loads(f"{head}requirement R upon start then {one}\n").checked.requirements["R"]
        for one in (text, same)
    ]
    assert len({format_formula(one.consequent) for one in required}) == 1


def test_clauses_between_trigger_and_consequent():
    head = "spec s\nsignal x : real\nevent e(k: int), f\n"
    texts = (
        "upon e for each n in e.k let v = x then within 1 s x > v + n",
        "upon e then within 1 s x > v + n for each n in e.k let v = x",
    )
    made = [
        rvmon.loads(f"{head}requirement R {text}\n").checked.requirements["R"] for text in texts
    ]
    assert made[0].captures == made[1].captures
    assert made[0].for_each == made[1].for_each
    assert format_text(f"{head}requirement R {texts[0]}\n").splitlines()[-4:] == [
        "  upon e",
        "  for each n in e.k",
        "  let v = x",
        "  then within 1 s x > v + n",
    ]


def test_a_choice_is_laid_out_on_one_line():
    """The `then` of a choice is not the `then` of a trigger."""
    text = "requirement R\n  upon x > if a then 1 else 2\n  then if a then b else c\n"
    assert format_text(text) == text


@each(
    ("text", "code"),
    [
        *((text, "RV003") for text in ("a U b W c", "a until b since c", "a R b U c")),
        ("always not a and b", "RV002"),
        ("always a -> b", "RV002"),
        ("b or F a and c", "RV002"),
        ("within 3 s a or b", "RV002"),
        ("not once a and b", "RV002"),
        ("F a U b", "RV002"),
        ("c and (always a or b)", "RV002"),
    ],
)
def test_ambiguous_formulas_need_brackets(codes, text, code):
    assert codes(f"requirement R upon start then {text}") == [code]


@pytest.mark.slow
def test_reserved_words_are_not_names(codes):
    """Words of the language can be declared only in quotes; with a dot they are other names.

    A reserved word before a text or comment is still taken for the name of a requirement.
    """
    for name in sorted(RESERVED):
        assert codes(f"signal z, {name} : bool")[:1] == ["RV010"], name
        text = f"signal `{name}`, {name}.z : bool\nrequirement `{name}`\n  always `{name}`"
        assert codes(text) == [], name
        for behind in ('"text"', "# so"):
            assert codes(f"requirement {name} {behind}\n  always a") == ["RV010"], name


@pytest.mark.slow
def test_infix_and_clause_words_may_be_names(codes):
    """In the place of an operand, infix words and clause words are names."""
    for name in sorted(INFIX_WORDS | CLAUSE_WORDS):
        assert codes(f"signal {name} : bool\nrequirement R always ({name} and {name})") == [], name


def test_division_by_a_signal_called_like_a_unit(checked):
    """With spaces, `5 m / s` divides by the signal s."""
    spec = checked("signal s : real\nrequirement R always 5 m / s < d")
    assert "s" in names_of_spec(spec)
    with pytest.raises(SpecError, match="RV022"):
        checked("signal s : real\nrequirement R always 5 m/s < d")


@pytest.mark.parametrize("words", [RESERVED, INFIX_WORDS | CLAUSE_WORDS])
def test_tables_of_words_and_grammar_agree(words):
    single = {word for word in words if len(word) == 1} | {"AG", "AF", "AX", "EG", "EF", "EX"}
    assert {word for word in words - single if word not in grammar_text()} == set()


def test_all_errors_of_a_file_appear_at_once(codes):
    text = (
        "requirement R1 always (\n"
        "requirement R2 always aa\n"
        "requirement R3 always d < 5\n"
        "requirment R4 always a\n"
        "signal z boool\n"
        "requirement R5 always z"
    )
    assert codes(text) == ["RV001", "RV012", "RV023", "RV001", "RV001"]


def test_byte_order_mark_is_ignored():
    spec, _ = compile_text("\ufeffspec demo\nsignal a : bool\nrequirement R always a")
    assert spec.name == "demo"
    assert compile_text("\ufeff# comment\r\nspec demo\r\n")[0].name == "demo"


@pytest.mark.slow
@pytest.mark.parametrize("sign", ["and", "or", "&&", "+"])
def test_a_chain_beyond_all_limits_is_refused_before_it_is_read(sign):
    chain = f" {sign} ".join(["p"] * 100_000)
    with pytest.raises(SpecError, match="more than 5,000 operators") as caught:
        compile_text(f"signal p : bool\nrequirement R\n  always ({chain})\n")
    assert [finding.code for finding in caught.value.diagnostics] == ["RV005"]


def test_words_in_texts_and_comments_are_not_operators():
    text = 'signal p : bool\nrequirement R "' + "and " * 3000 + '"\n  always p  # ' + "or " * 3000
    compile_text(text)
