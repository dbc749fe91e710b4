"""Files stay short, and marks and asserts of `src` say why they stand there."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
TEXTS = {
    path.relative_to(ROOT / "src").as_posix(): path.read_text(encoding="utf-8")
    for path in ROOT.glob("src/**/*.py")
}
MOST_LINES = 400
MARK = re.compile(r"# (?:noqa: [A-Z\d]++|type: ignore\[[a-z,-]+\])(?! - |  # )")


def test_no_file_is_long():
    """No file has more lines than 400: it would have more than one job, and is split."""
    others = [path for found in ("tests/**/*.py", "src/**/*.[ch]") for path in ROOT.glob(found)]
    texts = {**TEXTS, **{str(path): path.read_text(encoding="utf-8") for path in others}}
    lines = {name: len(text.splitlines()) for name, text in texts.items()}
    assert lines
    assert not {name: n for name, n in lines.items() if n > MOST_LINES}


@pytest.mark.slow
def test_what_is_let_pass_has_a_reason():
    """What lint or types are not to look at says why; an assert says why it holds."""
    unsaid = [name for name, text in TEXTS.items() if MARK.search(text)]
    unsaid += [
        f"{name}:{node.lineno}"
        for name, text in TEXTS.items()
        if "assert " in text  # what takes longest is to read the rest
        for node in ast.walk(ast.parse(text))
        if isinstance(node, ast.Assert) and node.msg is None
    ]
    assert not unsaid
