"""What others wrote, for people to read."""

import json

from tests.tools.hostile import STEERING, hostile_names

from rvmon.texts import shown, shown_json, shown_line


def test_nothing_that_steers_is_left():
    """Neither in texts, where ends of lines stay, nor in lines, nor in JSON, which reads back."""
    for name in hostile_names(5000):
        assert not STEERING.search(shown(f"{name}\n"))
        assert "\n" not in shown_line(f"{name}\n")
        for text in (json.dumps(name), json.dumps(name, ensure_ascii=False)):
            assert not STEERING.search(shown_json(text))
            assert json.loads(shown_json(text)) == name


def test_what_prints_stays():
    """Letters of all scripts, and every kind of space."""
    text = "Größe 3\u00a0m: 名前\u3000🤖\n"
    assert shown(text) == text


def test_what_was_shown_stays():
    """To show twice is to show once."""
    for name in hostile_names(1000):
        assert shown(shown(name)) == shown(name)
