r"""The core against the oracle on random specs and traces: verdicts and decision instants.

    python -m benchmarks.differential --pairs 100000 --traces 8 --seed 1 --workers 2 --interrupt
    python -m benchmarks.differential --pairs 100000 --from 100000 --traces 4 --form c "c rows"

Prints what the pairs were, how the attempts were decided and every disagreement, shrunk; exits 1 if
there is one. Ranges of seeds of one `--seed` hold different pairs: runs add up.
"""

from __future__ import annotations

import argparse
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator
from dataclasses import replace
from functools import partial
from typing import Any

from tests.tools.differential import Campaign, Mix, campaign_of
from tests.tools.features import Feature, possible
from tests.tools.forms import FORMS, Compiler
from tests.tools.kinds import KINDS
from tests.tools.ways import INTERRUPT, NEXT, Maker

from rvmon.errors import RvmonError
from rvmon.execute.parallel import execute
from rvmon.spec.checked.specification import TimeModel
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import TraceProfile
from rvmon.verdict.attempt import Decision

MODELS = {"held": TimeModel.HELD, "sampled": TimeModel.SAMPLED, "clocked": TimeModel.CLOCKED}
_FORMS = f"""some of {", ".join(FORMS)}; `c` may be followed by
+{NEXT} (samples come in portions, settled by the next stamp), +{INTERRUPT} (put away and taken up
again at random points), or both"""
FEATURES = ("numbers", "past", "mixed", "captures", "for_each", "policies", "stale", "ignoring")


def judging(
    options: argparse.Namespace, profile: Profile, traces: TraceProfile
) -> Callable[[list[str]], Campaign]:
    """What judges the cases of some seeds; runs in a worker."""
    compiler = Compiler()
    makers = {name: Maker(name, compiler) for name in options.form}
    return lambda seeds: campaign_of(
        makers,
        seeds,
        profile,
        traces,
        each=options.traces,
        online_every=options.online_every,
        shrunk=0 if options.fail_fast else options.show,
        windows=options.windows,
        letters=options.letters,
    )


def parse(argv: list[str]) -> argparse.Namespace:
    """The command line."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0] if __doc__ else None)
    parser.add_argument("--pairs", type=int, default=1_000)
    parser.add_argument("--traces", type=int, default=1, help="of the pairs with one spec")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--from", type=int, default=0, dest="first", metavar="N", help="pass over so many pairs"
    )
    parser.add_argument(
        "--windows", type=int, default=0, help="per cent of the specs that are windows in windows"
    )
    parser.add_argument(
        "--letters", type=int, default=0, help="per cent that speak of 17 propositions at once"
    )
    parser.add_argument("--time", choices=MODELS, help="default: all time models, in turn")
    parser.add_argument("--form", nargs="+", default=["c"], metavar="FORM", help=_FORMS)
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--depth", type=int, default=4)
    parser.add_argument(
        "--many", type=int, default=8, metavar="PERCENT", help="specs with 8 to 14 requirements"
    )
    parser.add_argument(
        "--long", type=int, default=8, metavar="PERCENT", help="traces three times as long"
    )
    parser.add_argument(
        "--crowded", type=int, default=0, metavar="PERCENT", help="specs with 20 to 26 requirements"
    )
    parser.add_argument(
        "--wide", type=int, default=0, metavar="PERCENT", help="specs of whole numbers of 64 bits"
    )
    parser.add_argument(
        "--sparse", type=int, default=0, metavar="PERCENT", help="traces of some dozens of samples"
    )
    parser.add_argument(
        "--outages",
        type=int,
        default=0,
        metavar="PERCENT",
        help="traces in which names are lost",
    )
    parser.add_argument(
        "--amounts",
        type=int,
        default=12,
        metavar="N",
        help="how often counts, sums and deadlines come, beside about 120 of all other operators",
    )
    parser.add_argument("--online-every", type=int, default=10, metavar="N")
    parser.add_argument("--show", type=int, default=5, help="disagreements printed at most")
    parser.add_argument("--without", nargs="*", choices=FEATURES, default=[], metavar="FEATURE")
    parser.add_argument("--known", action="store_true", help="no unknown values in the traces")
    parser.add_argument("--features", action="store_true", help="count what was generated")
    parser.add_argument("--interrupt", action="store_true", help="`c+interrupt` as well")
    parser.add_argument("--next", action="store_true", help="`c+next` as well")
    parser.add_argument("--fail-fast", action="store_true", help="stop soon, shrink nothing")
    options = parser.parse_args(argv)
    options.form += [f"c+{way}" for way in (NEXT, INTERRUPT) if getattr(options, way)]
    try:
        for name in options.form:
            Maker(name)
    except RvmonError as error:
        parser.error(str(error))
    return options


def profile_of(options: argparse.Namespace) -> Profile:
    """What the specs may hold."""
    without: dict[str, Any] = dict.fromkeys(options.without, False)
    whole = Profile(
        time=MODELS.get(options.time or ""),
        depth=options.depth,
        many=options.many,
        crowded=options.crowded,
        wide=options.wide,
        amounts=options.amounts,
    )
    return replace(whole, **without)


def main(argv: list[str]) -> int:
    """Run the campaign and print its figures."""
    options = parse(argv)
    profile = profile_of(options)
    traces = TraceProfile(
        unknowns=not options.known,
        long=options.long,
        sparse=options.sparse,
        outages=options.outages,
    )
    numbers = range(
        options.first // options.traces, (options.first + options.pairs) // options.traces
    )
    seeds = [f"{options.seed}/{number}" for number in numbers]
    size = 5 if options.fail_fast else 250
    parts = [seeds[start : start + size] for start in range(0, len(seeds), size)]
    begin = partial(judging, options, profile, traces)
    began = time.perf_counter()
    total = Campaign(Mix(), {})
    for part in execute(parts, begin, jobs=options.workers, what="part"):
        total.add(part)
        if options.fail_fast and total.disagreements:
            break
    show(total, options, time.perf_counter() - began)
    return 1 if total.disagreements else 0


def show(total: Campaign, options: argparse.Namespace, seconds: float) -> None:
    """Print the figures, then the disagreements."""
    mix = total.mix
    attempts = sum(mix.attempts.values())
    share = {name: f"{100 * n / max(attempts, 1):.1f} %" for name, n in mix.attempts.items()}
    decided = sum(n for name, n in mix.attempts.items() if name != "I")
    print(f"time {options.time or 'all'}, seed {options.seed}, from {options.first} on")
    print(f"pairs {mix.pairs}, attempts {attempts}, in {seconds:.0f} s")
    print("verdicts  ", ", ".join(f"{name} {share[name]}" for name in sorted(share)))
    print("settled by", ", ".join(f"{name} {n}" for name, n in mix.decisions.most_common()))
    on_bound = 100 * mix.on_bound / max(decided, 1)
    print(f"on a bound {mix.on_bound} of {decided} decided ({on_bound:.1f} %)")
    by_prefix = mix.decisions[Decision.PREFIX.value]
    late = 100 * mix.late / max(by_prefix, 1)
    print(f"after the third sample {mix.late} of {by_prefix} decided by a prefix ({late:.1f} %)")
    of_kinds = (f"{kind} {100 * mix.kinds[kind] / max(mix.pairs, 1):.1f} %" for kind in KINDS)
    print("pairs with", ", ".join(of_kinds))
    if options.features:
        print("\n".join(feature_table(mix.features)))
    width = max(map(len, total.tallies))
    for name, tally in total.tallies.items():
        wrong = len(tally.disagreements)
        print(
            f"{name:{width}}  judged {tally.pairs}, refused {tally.refused}, disagreements {wrong}"
        )
    for tally in total.tallies.values():
        for text in tally.disagreements[: options.show]:
            print("\n" + "=" * 72 + "\n" + text)


def feature_table(found: Counter[Feature]) -> Iterator[str]:
    """How often each operator met each window; with that, each time model, trigger, end, extra."""
    everything = [*possible()]
    columns = [
        (field, value)
        for field in ("time", "trigger", "policy", "extra")
        for value in dict.fromkeys(getattr(one, field) for one in everything)
    ]
    legal = {(one.operator, value) for one in everything for _, value in _values(one, columns)}
    heads = (str(value).replace(" ", "-") for _, value in columns)
    yield " ".join(["operator window  all", *heads])
    never = 0
    for operator, window in dict.fromkeys((one.operator, one.window) for one in everything):
        met: Counter[object] = Counter()
        for one, n in found.items():
            if (one.operator, one.window) == (operator, window):
                met.update({value: n for _, value in _values(one, columns)} | {"all": n})
        line = f"{operator:8} {window:6} {met['all']:5}"
        for _, value in columns:
            none = "0" if (operator, value) in legal else "-"
            never += none == "0" and not met[value]
            line += f" {met[value] or none:>{len(str(value))}}"
        yield line
    whole = sum(one in found for one in everything)
    yield f"never met {never}; of all {len(everything)} combinations {whole}"


def _values(one: Feature, columns: Iterable[tuple[str, object]]) -> Iterator[tuple[str, object]]:
    return (entry for entry in columns if getattr(one, entry[0]) == entry[1])


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
