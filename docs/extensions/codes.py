"""One page of all diagnostic codes, with a table at its start."""

from __future__ import annotations

import re

from rvmon.analysis.diagnostic_codes import every_rule, page_of

_SAYS = re.compile(r"\*\w+\* · ([^\n]+(?:\n[^\n]+)*)")


def codes() -> str:
    """A table, then a section for each code, in the order of codes."""
    rows, sections = ["| code | name | kind | what |", "|---|---|---|---|"], []
    for code, rule in every_rule().items():
        page = page_of(code)
        found = _SAYS.search(page)
        if found is None:
            raise ValueError(f"the page of {code} does not say what is found")
        what = " ".join(found[1].split())
        rows.append(
            f"| [{code}](#{code.lower()}-{rule.name}) | {rule.name} | {rule.severity} | {what} |"
        )
        sections.append(re.sub("^#", "##", page, flags=re.MULTILINE))
    return "\n".join([*rows, "", *sections])
