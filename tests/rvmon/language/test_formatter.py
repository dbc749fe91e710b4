"""The formatter is canonical and idempotent, and keeps comments and meaning."""

import pytest

from rvmon.language.formatter import format_text

EXAMPLE = """# Head

spec   demo   "A title"
time sampled  every   20ms


signal gaze_ok,b:bool input
signal distance : real[m] input stale   after 200ms # how far
signal range : real[m] ignore
  NaN stale after 1 s
signal far : real ignore NaN
event sensed  input
event released output
define ready=gaze_ok&b
# About R1
requirement R1 "text" upon sensed&ready then F<=3 s released
  # why it is so
  source "ISO" at   end strict
requirement R2 G(distance<0.5m->!b)   scope  between(sensed)and(released)
property P1:A[ ](gaze_ok->AF[0,3s]b)
coverpoint c=gaze_ok{yes:true,ignore no:false}goal 3
# the end
"""
CANONICAL = """# Head

spec demo "A title"
time sampled every 20 ms

signal gaze_ok, b : bool      input
signal distance   : real [m]  input  stale after 200 ms  # how far
signal range      : real [m]  ignore NaN stale after 1 s
signal far        : real      ignore NaN
event  sensed  input
event  released  output
define ready = gaze_ok and b

# About R1
requirement R1 "text"
  upon sensed and ready
  then eventually <= 3 s released
  # why it is so
  source "ISO"
  at end: strict

requirement R2
  always (distance < 0.5 m -> not b)
  scope between (sensed) and (released)

property P1: A[] (gaze_ok -> AF[0, 3 s] b)

coverpoint c = gaze_ok {yes: true, ignore no: false}
  goal 3
# the end
"""


def test_canonical_form():
    """Words instead of signs, a clause per line, declarations in columns, comments in place."""
    assert format_text(EXAMPLE) == CANONICAL
    assert format_text(CANONICAL) == CANONICAL


@pytest.mark.parametrize("colon", [":", ""])
def test_a_comment_after_at_end_is_kept(colon):
    head = "spec s\nsignal b : bool\nrequirement R\n  upon b then b\n"
    text = format_text(f"{head}  at end{colon} # why\n  strong\n")
    assert text.endswith("  at end:  # why\n    strong\n")


def test_long_lines_are_broken_at_loose_operators():
    names = [f"signal_number_{number}" for number in range(12)]
    text = f"signal {', '.join(names)} : bool\nrequirement R always ({' and '.join(names)} -> a)"
    lines = format_text(text).splitlines()
    assert max(map(len, lines)) <= 100
    assert any(line.strip().startswith("-> a") for line in lines)
    assert format_text("\n".join(lines)) == "\n".join(lines) + "\n"


@pytest.mark.parametrize("text", ["", "# only a comment\n", "\n\n", "# a\n\n# b\n\n"])
def test_file_without_items(text):
    assert format_text(text).strip() == text.strip()


def test_many_bins_have_a_line_each():
    bins = ["touching: [0 m, 5 cm)", "in_reach: [5 cm, 75 cm)", "away: [75 cm, inf)"]
    text = f"coverpoint nearness = distance_of_the_hand {{{', '.join(bins)}}} goal 3\n"
    laid_out = (
        "coverpoint nearness = distance_of_the_hand {\n"
        + ",\n".join(f"  {one}" for one in bins)
        + "\n}\n  goal 3\n"
    )
    assert format_text(text) == laid_out
    assert format_text(laid_out) == laid_out
    remarked = laid_out.replace("  in_reach", "  # from the shoulder\n  in_reach")
    assert format_text(format_text(remarked)) == format_text(remarked)
    assert "# from the shoulder" in format_text(remarked)
