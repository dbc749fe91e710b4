"""Every operation has an entry that all readers can use."""

import re

import pytest

import rvmon
from rvmon.spec.checked.arithmetic import NumericOp

HEAD = "spec s\nsignal x, y : real\n"
FUNCTIONS = [op for op in NumericOp if op.is_function]


@pytest.mark.parametrize("op", FUNCTIONS)
@pytest.mark.parametrize("count", range(1, 6))
def test_a_wrong_number_of_arguments_is_refused(op, count):
    """As many as the entry says, and no others."""
    text = f"{HEAD}requirement R1\n  always {op}({', '.join('x' * count)}) < 1\n"
    if op.entry.least <= count <= (op.entry.most or count):
        assert rvmon.loads(text)
    else:
        with pytest.raises(rvmon.SpecError, match=re.escape(f"`{op}` takes")):
            rvmon.loads(text)


@pytest.mark.parametrize("op", NumericOp)
def test_constants_are_worked_out_as_values_are(op):
    """The same number, whether the checker or a monitor works it out."""
    numbers = [4.0, 3.0][: op.entry.least]
    called = f"{op}({{}}, {{}})" if len(numbers) > 1 else f"{op}({{}})"
    form = "-{}" if op is NumericOp.NEG else called if op.is_function else f"{{}} {op} {{}}"
    constant, varying = form.format(*numbers), form.format(*"xy")
    wanted = op.entry.apply(*numbers)
    bodies = [f"always abs({one} - {wanted!r}) < 0.000001" for one in (constant, varying)]
    text = "".join(f"requirement R{n}\n  {body}\n" for n, body in enumerate(bodies))
    verdicts = rvmon.loads(HEAD + text).evaluate([(0, {"x": 4.0, "y": 3.0})]).verdicts
    assert [one.value for one in verdicts.values()] == ["P", "P"]
