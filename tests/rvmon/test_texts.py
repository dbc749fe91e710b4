"""Texts from files, made safe to show, and percentages."""

import json

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from tests.tools.hostile import STEERING, hostile_names

from rvmon.texts import escaped, escaped_json, escaped_line, percent, percent_text


@pytest.mark.slow
def test_no_control_character_is_left():
    for name in hostile_names(5000):
        assert not STEERING.search(escaped(f"{name}\n"))
        assert "\n" not in escaped_line(f"{name}\n")
        for text in (json.dumps(name), json.dumps(name, ensure_ascii=False)):
            assert not STEERING.search(escaped_json(text))
            assert json.loads(escaped_json(text)) == name


def test_printable_text_of_any_script_and_shown_text_stay_unchanged():
    text = "Größe 3\u00a0m: 名前\u3000🤖\n"
    assert escaped(text) == text
    for name in hostile_names(1000):
        assert escaped(escaped(name)) == escaped(name)


@pytest.mark.slow
@settings(deadline=None)
@given(st.integers(1, 10**9), st.data())
def test_only_none_is_0_percent_and_only_all_is_100_percent(whole, data):
    part = data.draw(st.integers(0, whole) | st.sampled_from([1, whole - 1]))
    assert (percent(part, whole) == 0) == (part == 0)
    assert (percent(part, whole) == 100) == (part == whole)
    assert (percent_text(part, whole) == "0 %") == (part == 0)
    assert (percent_text(part, whole) == "100 %") == (part == whole)

    # Off by no more than it takes to keep apart from 0 and 100.
    assert abs(percent(part, whole) - 100 * part / whole) <= 0.1


def test_a_share_of_nothing_is_100_percent():
    assert percent(0, 0) == 100
    assert percent_text(0, 0) == "100 %"
