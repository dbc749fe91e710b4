r"""The engine `auto` with and without what was compiled ahead, compared in everything they say.

    python -m benchmarks.prepared_differential --pairs 3000 --traces 10 --seed 1

Returned records with their reasons, open attempts, next instants, verdicts, errors, snapshots taken
up by the other, health, reports. Prints every difference; exits 1 if there is one.
"""

from __future__ import annotations

import argparse
import random
import sys
import time

from tests.tools.chains import random_chain
from tests.tools.prepared import compiled_beside, differences

from rvmon.monitor.compiled.refusal import of_prepared
from rvmon.monitor.compiled.specification import compile_spec
from rvmon.spec.checked.specification import CheckedSpec, TimeModel
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import TraceProfile, random_trace

MODELS = tuple(TimeModel)


def windowed(rng: random.Random) -> CheckedSpec:
    """A specification of windows, or `until`, within windows that a network judges, and C can."""
    while True:
        spec = random_chain(rng, untils=rng.random() < 0.5)
        (one,) = compile_spec(spec).chosen(None)
        if one.engine("auto") == "network" and of_prepared(one) is None:
            return spec


def main(argv: list[str]) -> int:
    """Compare so many pairs of a specification and a trace."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").splitlines()[0])
    parser.add_argument("--pairs", type=int, default=1_000)
    parser.add_argument("--traces", type=int, default=10, help="of the pairs with one spec")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument(
        "--windows", type=int, default=30, help="per cent that are windows within windows"
    )
    parser.add_argument(
        "--mixed", type=int, default=50, help="per cent of the others that C may take in part only"
    )
    parser.add_argument("--show", type=int, default=3, help="differences printed at most")
    options = parser.parse_args(argv)
    began = time.perf_counter()
    judged = refused = in_part = by_network = samples = by_c = found = number = 0
    while judged < options.pairs:
        number += 1
        seed = f"{options.seed}/{number}"
        rng = random.Random(seed)
        mixed = rng.random() * 100 < options.mixed
        several = {"requirements": 5 if mixed else 2, "captures": mixed, "for_each": mixed}
        profile = Profile(time=MODELS[number % len(MODELS)], **several)
        unknowns = rng.random() < 0.25
        size = 300 if rng.random() < 0.2 else 60
        traces = TraceProfile(size, span=4 * size, unknowns=unknowns, long=20)
        chained = rng.random() * 100 < options.windows
        spec = windowed(rng) if chained else random_spec(rng, profile)
        cases = [random_trace(rng, spec, traces) for _ in range(options.traces)]
        pair = compiled_beside(spec)
        if pair is None:
            refused += 1
            continue
        in_part += not pair.shared.are_all
        by_network += any(rule.automaton is None for rule in pair.forms.plan.rules)
        for index, case in enumerate(cases):
            told, taken = differences(pair, case, f"{seed}/{index}")
            judged += 1
            samples += len(case.samples)
            by_c += taken
            if told:
                found += 1
                if found <= options.show:
                    print(f"\n{'=' * 72}\nseed {seed}, trace {index}\n" + "\n".join(told[:8]))
    seconds = time.perf_counter() - began
    print(f"pairs {judged}, specifications refused {refused}, in {seconds:.0f} s")
    print(f"specifications that C takes in part {in_part}")
    print(f"specifications with what no automaton judges {by_network}")
    print(f"samples {samples}, of them by C {by_c}; pairs that differ {found}")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
