"""Helpers of the tests of the language."""

import pytest
from tests.tools.findings import findings_of

from rvmon.errors import SpecError
from rvmon.language.compile import compile_text
from rvmon.language.print import format_formula

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
    return lambda body, **options: checked(f"requirement R {body}", **options).requirements["R"]


@pytest.fixture
def required(requirement):
    return lambda formula: format_formula(requirement(f"upon start then {formula}").consequent)


@pytest.fixture
def codes():
    """The codes of all findings of a text after the common declarations, except unread names."""

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
        (finding,) = findings_of(compile_text, NAMES + text)
        return f"{finding.message} | {finding.help}"

    return found
