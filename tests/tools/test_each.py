"""What stands for many small tests."""

import inspect

import pytest

from tests.tools.each import each


def test_a_case_that_fails_is_named_and_those_behind_it_are_not_tried():
    tried = []

    @each("sign", ["", pytest.param("-", id="turned")])
    @each(("number", "half"), [(2, 1), (4, 2), (5, 2), (6, 3)])
    def test(number, half, sign, told):
        tried.append(f"{sign}{number}")
        assert number == 2 * half, told

    assert list(inspect.signature(test).parameters) == ["told"]
    with pytest.raises(AssertionError, match="odd") as caught:
        test(told="odd")
    assert tried == ["2", "4", "5"]
    assert caught.value.__notes__ == ["case 3 of 4: 5, 2", "case 1 of 2: ''"]
