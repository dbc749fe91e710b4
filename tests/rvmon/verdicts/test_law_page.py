"""The page on changes of the semantics gives the present verdicts."""

import re
from pathlib import Path

import pytest

import rvmon
from rvmon.cli import main
from rvmon.errors import MissingNameError

ROOT = Path(__file__).parents[3]
PAGE = (ROOT / "docs" / "reference" / "what-changed-in-the-law.md").read_text(encoding="utf-8")
EXAMPLES = re.findall(
    r"```rv\n(.*?)```\n\n```(csv|jsonl)\n(.*?)```\n\n\| \| before \| now \|\n\|---\|---\|---\|\n"
    r"((?:\|[^\n]*\n)+)",
    PAGE,
    re.DOTALL,
)


def test_every_specification_of_the_page_is_an_example():
    assert len(EXAMPLES) == PAGE.count("```rv\n") > 0


@pytest.mark.parametrize(("text", "form", "data", "table"), EXAMPLES)
def test_what_is_judged_now(text, form, data, table, tmp_path):
    spec, trace = tmp_path / "base.rv", tmp_path / f"base.{form}"
    spec.write_text(text, encoding="utf-8")
    trace.write_text(data, encoding="utf-8")
    cells = [[cell.strip() for cell in row.split("|")[1:-1]] for row in table.splitlines()]
    now = {what: said for what, _, said in cells}
    if "exit code" in now:
        words = ["run", str(spec), str(trace)]
        assert main(words) == int(now["exit code"])
    if now["verdicts"] == "refused":
        with pytest.raises(MissingNameError):
            rvmon.load(spec).evaluate(trace)
        return
    report = rvmon.load(spec).evaluate(trace)
    verdicts = [f"{name} {verdict}" for name, verdict in report.verdicts.items()]
    assert listed(verdicts) == now["verdicts"]
    assert listed(f"{one.name} {one.verdict}" for one in report.attempts) == now["attempts"]


def listed(names):
    """As in the tables."""
    return ", ".join(names) or "none"


def test_the_programs_of_the_page_print_what_their_comments_say(capsys):
    names: dict[str, object] = {}
    program = "".join(re.findall(r"```python\n(.*?)```", PAGE, re.DOTALL))
    exec(program, names)  # noqa: S102 - our own page
    assert capsys.readouterr().out.split() == re.findall(r"print\(.*\)  # (\w+), before", program)


def test_the_page_names_the_present_semantics(capsys):
    """New semantics need a new page."""
    main(["--version"])
    version = capsys.readouterr().out
    assert PAGE.startswith("# What changed in the law\n")
    assert re.findall(r'`"law": (\d+)`', PAGE) == re.findall(r"law (\d+)", version)
