"""What stands for many small tests."""

import inspect

import pytest

from tests.tools.each import each


def test_cases_that_fail_are_named_and_all_are_tried():
    tried = []

    @each("sign", ["", pytest.param("-", id="turned")])
    @each(("number", "half"), [(2, 1), (5, 2), (6, 3), (7, 3)])
    def test(number, half, sign, told):
        tried.append(f"{sign}{number}")
        assert sign or number == 2 * half, told
        if number == 6 and sign:
            pytest.fail("turned six")

    assert list(inspect.signature(test).parameters) == ["told"]
    with pytest.raises(BaseExceptionGroup, match="2 of 2 cases") as caught:
        test(told="odd")
    assert tried == ["2", "5", "6", "7", "-2", "-5", "-6", "-7"]
    plain, turned = caught.value.exceptions
    assert isinstance(plain, ExceptionGroup)
    assert [str(one).splitlines()[0] for one in plain.exceptions] == ["odd"] * 2
    assert [one.__notes__ for one in plain.exceptions] == [
        ["case 2 of 4: 5, 2"],
        ["case 4 of 4: 7, 3"],
    ]
    assert plain.__notes__ == ["case 1 of 2: ''"]
    assert turned.__notes__ == ["case 3 of 4: 6, 3", "case 2 of 2: turned"]
