"""The specification language under load: random texts, random layouts, large files.

    python -m benchmarks.language [--texts N] [--layouts N] [--requirements N] [--seed S]

Prints how many texts were read, how many were refused, and every accident; how many random
specifications kept their meaning and form when printed and laid out; and CPU times. Exits 1 if
anything went wrong.
"""

from __future__ import annotations

import argparse
import math
import random
import re
import sys
import time
from collections import Counter
from collections.abc import Hashable, Sequence
from pathlib import Path

from tests.tools.generate_text import random_text, syntax_of
from tests.tools.spec_text import meaning, scribbled, spec_text

from rvmon.diagnostics.diagnostic import Diagnostic, Severity
from rvmon.diagnostics.render import render_concise, render_full, render_json
from rvmon.errors import SpecError
from rvmon.explain.analysed import analyse
from rvmon.explain.codes import every_rule
from rvmon.monitor import compile_spec
from rvmon.spec.compile import compile_text
from rvmon.spec.print.formatter import format_text
from rvmon.spec.rules.pages import all_rules
from rvmon.testing.generate.spec import Profile, random_spec

ROOT = Path(__file__).parents[1]
TIMELINE = re.compile(r"\b(?:P|F|NT|I) (everywhere|before r|after q until r|after q|between q r):")
WORD = re.compile(r"\w+|[^\w\s]+|\s+")
GRAMMATICAL = 0.3
"""Of the texts so many are made by the grammar; the others are mutants."""

STRANGE = ("->", "E<>", "A[]", "[0, 3 s)", "inf", "`x y`", "age(", "1e999", "\x00", "é", "(" * 50)


def main(argv: list[str] | None = None) -> int:
    """Run the campaigns."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--texts", type=int, default=100_000)
    parser.add_argument("--layouts", type=int, default=10_000)
    parser.add_argument("--requirements", type=int, default=1_000)
    parser.add_argument("--analysed", type=int, default=100)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(argv)
    catalogue()
    compile_text("event a")  # the parser is built once, which is no part of what is measured
    accidents = texts(options.texts, random.Random(options.seed))
    accidents += layouts(options.layouts, options.seed)
    large_file(options.requirements, random.Random(options.seed))
    analysis(options.analysed, random.Random(options.seed))
    return int(accidents > 0)


def catalogue() -> None:
    """What there is: codes with pages and kept messages, patterns by scopes, FRET's translation."""
    rules = every_rule()
    pages = sum((ROOT / "docs" / "codes" / f"{code}.md").exists() for code in rules)
    kept = ROOT / "tests" / "rvmon" / "explain" / "golden"
    messages = sum((kept / f"{code}.txt").exists() for code in rules)
    print(f"diagnostic codes: {len(rules)}, with a page {pages}, with a kept message {messages}")
    patterns = timelines = 0
    scopes: set[str] = set()
    for path in ROOT.glob("src/rvmon/spec/patterns/*.rv"):
        text = path.read_text(encoding="utf-8")
        patterns += len(re.findall(r"^define ", text, re.MULTILINE))
        found = TIMELINE.findall(text)
        timelines += len(found)
        scopes |= set(found)
    print(f"patterns: {patterns}, scopes: {len(scopes)}, timelines that are tests: {timelines}")
    page = (ROOT / "docs" / "reference" / "fret.md").read_text(encoding="utf-8")
    tables = [re.findall(r"^\| [`(].*$", part, re.MULTILINE) for part in page.split("## ")]
    rows = [len(table) for table in tables if table]
    sizes = " x ".join(map(str, rows))
    print(f"FRET: {sizes} = {math.prod(rows)} combinations of scope, condition and timing")


def texts(count: int, rng: random.Random) -> int:
    """Specifications mutated by words and by characters, and texts by the grammar.

    Every answer has to be orderly, and what can be read has to say the same when it is laid out.
    """
    paths = [*ROOT.glob("specs/*.rv"), *ROOT.glob("src/rvmon/spec/patterns/*.rv")]
    seeds = [path.read_text(encoding="utf-8") for path in paths]
    seeds += [text for rule in all_rules().values() for text in (rule.example, rule.instead)]
    words = [*sorted({word for seed in seeds for word in WORD.findall(seed)}), *STRANGE]
    codes: Counter[str] = Counter()
    counts: Counter[str] = Counter()
    slowest = 0.0
    for number in range(count):
        by_grammar = rng.random() < GRAMMATICAL
        text = random_text(rng) if by_grammar else mutated(rng.choice(seeds), words, rng)
        try:
            started = time.process_time()
            findings = answer(text)
            slowest = max(slowest, (time.process_time() - started) / max(len(text), 1_000))
            syntax = syntax_of(text)
            counts["parsed"] += syntax is not None
            if syntax is not None and not kept_by_layout(text, syntax):
                counts["changed"] += 1
                print(f"text {number} says something else when it is laid out:\n{text}\n")
        except Exception as error:  # noqa: BLE001 - that none occurs is what is measured
            counts["accidents"] += 1
            print(f"text {number}: {type(error).__name__}: {error}\n{text}\n")
            continue
        counts["read"] += not any(found.severity is Severity.ERROR for found in findings)
        codes.update(finding.code for finding in findings)
    print(f"texts: {count:,}, parsed {counts['parsed']:,}, without errors {counts['read']:,}")
    print(f"accidents: {counts['accidents']}, changed by their layout: {counts['changed']}")
    print(f"codes seen: {len(codes)} of {len(all_rules())}")
    print(f"slowest: {slowest * 10_000:.2f} s of CPU per 10 kB")
    return counts["accidents"] + counts["changed"]


def answer(text: str) -> Sequence[Diagnostic]:
    """What is found in a text, rendered in all forms."""
    try:
        _, findings = compile_text(text)
    except SpecError as error:
        findings = tuple(error.diagnostics)
    render_full(findings)
    render_concise(findings)
    render_json(findings)
    return findings


def kept_by_layout(text: str, syntax: Hashable) -> bool:
    """Whether a text says the same when it is laid out, and then keeps its form."""
    once = format_text(text)
    return syntax_of(once) == syntax and format_text(once) == once


def mutated(text: str, words: list[str], rng: random.Random) -> str:
    """Change a few words or characters."""
    by_words = rng.random() < 0.6
    parts = WORD.findall(text) if by_words else list(text)
    for _ in range(rng.randint(1, 6)):
        place = rng.randrange(len(parts))
        strange = (
            rng.choice(words)
            if by_words
            else chr(rng.choice((rng.randrange(32, 127), rng.randrange(0x3000))))
        )
        parts[place] = rng.choice(("", strange, parts[place] * 2, rng.choice(parts)))
    return "".join(parts)


def layouts(count: int, seed: int) -> int:
    """Print, scribble and lay out random specifications; meaning and form have to stay."""
    wrong = refused = 0
    for number in range(seed * 1_000_000, seed * 1_000_000 + count):
        rng = random.Random(number)
        try:
            first, _ = compile_text(spec_text(random_spec(rng, Profile())))
        except SpecError:  # a division by the constant 0, which the generator knows and we refuse
            refused += 1
            continue
        text = scribbled(spec_text(first), rng)
        once = format_text(text)
        same = meaning(compile_text(once)[0]) == meaning(first)
        stable = format_text(once) == once
        comments = [sorted(re.findall(r"#.*", version)) for version in (text, once)]
        if not (same and stable and comments[0] == comments[1]):
            wrong += 1
            print(f"specification {number}: meaning kept {same}, form kept {stable}\n{text}\n")
    print(f"layouts: {count:,}, refused {refused}, wrong {wrong}")
    return wrong


def large_file(count: int, rng: random.Random) -> None:
    """CPU time of checking one file with many requirements, and specs/handover.rv."""
    handover = (ROOT / "specs" / "handover.rv").read_text(encoding="utf-8")
    files = {"specs/handover.rv": handover, f"{count:,} requirements": many(count, rng)}
    for name, text in files.items():
        started = time.process_time()
        compile_text(text)
        seconds = time.process_time() - started
        print(f"check of {name}: {seconds:.2f} s of CPU, {len(text):,} characters")


def analysis(count: int, rng: random.Random) -> None:
    """CPU time of analysing a file, without a limit, and what remains undecided."""
    compiled = compile_spec(compile_text(many(count, rng))[0])
    started = time.process_time()
    found = analyse(compiled, seconds=3600).examination
    seconds = time.process_time() - started
    print(
        f"analysis of {count:,} requirements: {seconds:.1f} s of CPU; {found.pairs} pairs, "
        f"undecided {found.pairs_undecided}; sets of up to {found.whole_sets}, "
        f"undecided {found.sets_undecided}; {len(found.conflicts)} conflicts, "
        f"{len(found.implications)} implied"
    )


def many(count: int, rng: random.Random) -> str:
    """A file with requirements of the usual kinds."""
    names = [", ".join(f"{letter}{number}" for number in range(100)) for letter in "bxe"]
    lines = [f"signal {names[0]} : bool", f"signal {names[1]} : real [m]", f"event {names[2]}"]
    kinds = (
        'upon e{} and not b{}\n  then within 3 s (e{} or x{} < 5 cm)\n  source "ISO"',
        "always (b{} and b{} -> within 2 s (e{} and x{} >= 0.5 m))",
        "upon age(x{}) > 200 ms\n  then within 0.3 s held(x{} <= 1 mm, 100 ms)\n  tags t{}, u{}",
        "whenever b{} and x{} > 1 m\n  then b{} until (e{} or not rise(b1))",
    )
    for number in range(count):
        body = kinds[number % 4].format(*(rng.randrange(100) for _ in range(4)))
        lines.append(f'requirement R{number} "Requirement {number}"\n  {body}')
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main())
