"""The specification language under load: random texts, random layouts, large files.

    python -m benchmarks.language [--texts N] [--layouts N] [--requirements N] [--seed S]

Prints how many texts were read, how many were refused, and every accident; how many random
specifications kept their meaning and form when printed and laid out; and CPU times. Exits 1 if
anything went wrong.
"""

from __future__ import annotations

import argparse
import random
import re
import sys
import time
from collections import Counter
from pathlib import Path

from rvmon.diagnostics.render import render_concise, render_full, render_json
from rvmon.errors import SpecError
from rvmon.spec import compile_text
from rvmon.spec.formatter import format_text
from rvmon.spec.rules.registry import all_rules
from rvmon.testing.generate_spec import Profile, random_spec
from rvmon.testing.spec_text import meaning, scribbled, spec_text

ROOT = Path(__file__).parents[1]
WORD = re.compile(r"\w+|[^\w\s]+|\s+")
STRANGE = ("->", "E<>", "A[]", "[0, 3 s)", "inf", "`x y`", "age(", "1e999", "\x00", "é", "(" * 50)


def main(argv: list[str] | None = None) -> int:
    """Run the campaigns."""
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawTextHelpFormatter
    )
    parser.add_argument("--texts", type=int, default=100_000)
    parser.add_argument("--layouts", type=int, default=10_000)
    parser.add_argument("--requirements", type=int, default=1_000)
    parser.add_argument("--seed", type=int, default=1)
    options = parser.parse_args(argv)
    compile_text("event a")  # the parser is built once, which is no part of what is measured
    accidents = texts(options.texts, random.Random(options.seed))
    accidents += layouts(options.layouts, options.seed)
    large_file(options.requirements, random.Random(options.seed))
    return int(accidents > 0)


def texts(count: int, dice: random.Random) -> int:
    """Mutate specifications, by words and by characters; every answer has to be orderly."""
    paths = [*ROOT.glob("specs/*.rv"), *ROOT.glob("src/rvmon/spec/patterns/*.rv")]
    seeds = [path.read_text(encoding="utf-8") for path in paths]
    seeds += [text for rule in all_rules().values() for text in (rule.example, rule.instead)]
    words = [*sorted({word for seed in seeds for word in WORD.findall(seed)}), *STRANGE]
    codes: Counter[str] = Counter()
    accidents = read = 0
    slowest = 0.0
    for number in range(count):
        text = mutated(dice.choice(seeds), words, dice)
        started = time.process_time()
        try:
            _, findings = compile_text(text)
            read += 1
        except SpecError as error:
            findings = error.diagnostics
        except Exception as error:  # noqa: BLE001 - that none occurs is what is measured
            accidents += 1
            print(f"text {number}: {type(error).__name__}: {error}\n{text}\n")
            continue
        slowest = max(slowest, (time.process_time() - started) / max(len(text), 1_000))
        codes.update(finding.code for finding in findings)
        render_full(findings)
        render_concise(findings)
        render_json(findings)
    print(f"texts: {count:,}, read {read:,}, refused {count - read - accidents:,}")
    print(f"accidents: {accidents}")
    print(f"codes seen: {len(codes)} of {len(all_rules())}")
    print(f"slowest: {slowest * 10_000:.2f} s of CPU per 10 kB")
    return accidents


def mutated(text: str, words: list[str], dice: random.Random) -> str:
    """Change a few words or characters."""
    by_words = dice.random() < 0.6
    parts = WORD.findall(text) if by_words else list(text)
    for _ in range(dice.randint(1, 6)):
        place = dice.randrange(len(parts))
        strange = (
            dice.choice(words)
            if by_words
            else chr(dice.choice((dice.randrange(32, 127), dice.randrange(0x3000))))
        )
        parts[place] = dice.choice(("", strange, parts[place] * 2, dice.choice(parts)))
    return "".join(parts)


def layouts(count: int, seed: int) -> int:
    """Print, scribble and lay out random specifications; meaning and form have to stay."""
    wrong = refused = 0
    for number in range(seed * 1_000_000, seed * 1_000_000 + count):
        dice = random.Random(number)
        try:
            first, _ = compile_text(spec_text(random_spec(dice, Profile(mixed=False))))
        except SpecError:  # a division by the constant 0, which the generator knows and we refuse
            refused += 1
            continue
        text = scribbled(spec_text(first), dice)
        once = format_text(text)
        same = meaning(compile_text(once)[0]) == meaning(first)
        stable = format_text(once) == once
        comments = [sorted(re.findall(r"#.*", version)) for version in (text, once)]
        if not (same and stable and comments[0] == comments[1]):
            wrong += 1
            print(f"specification {number}: meaning kept {same}, form kept {stable}\n{text}\n")
    print(f"layouts: {count:,}, refused {refused}, wrong {wrong}")
    return wrong


def large_file(count: int, dice: random.Random) -> None:
    """CPU time of checking one file with many requirements, and specs/handover.rv."""
    handover = (ROOT / "specs" / "handover.rv").read_text(encoding="utf-8")
    files = {"specs/handover.rv": handover, f"{count:,} requirements": many(count, dice)}
    for name, text in files.items():
        started = time.process_time()
        compile_text(text)
        seconds = time.process_time() - started
        print(f"check of {name}: {seconds:.2f} s of CPU, {len(text):,} characters")


def many(count: int, dice: random.Random) -> str:
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
        body = kinds[number % 4].format(*(dice.randrange(100) for _ in range(4)))
        lines.append(f'requirement R{number} "Requirement {number}"\n  {body}')
    return "\n".join(lines) + "\n"


if __name__ == "__main__":
    sys.exit(main())
