"""The native code under AFL++, with guarded memory blocks: monitors, models, and CSV.

The bytes of a plan or a snapshot get a matching hash, so that the fuzzer gets past that check.
Accepted bytes judge some samples. Each run is repeated after a reset, and with other monitors that
continue it from snapshots; both must give the same results. Then it is repeated with limited
memory, and must not be green. Models are searched with bounds of 32 and of 64 bits, and CSV is read
in three ways, which must agree. An input fails if the code crashes or hangs, or if a sanitizer
reports an error.
"""

from __future__ import annotations

import os
import random
import struct
import subprocess
from collections.abc import Iterator, Sequence
from pathlib import Path

from fuzz.sanitize import guarded_memory
from fuzz.targets import seeds
from tests.rvmon.core.twins import HEAD, tell
from tests.rvmon.models.search.plans import search_plans
from tests.tools.drive import told
from tests.tools.random_specs import truths_plan, with_random_coverage

from rvmon.core.pack import pack
from rvmon.coverage.monitor import Bins
from rvmon.errors import RvmonError
from rvmon.logic.plan import Plan
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.monitor.packed_plan import planned_core
from rvmon.monitor.requirement_plans import plan_alone
from rvmon.native import sources as core_sources
from rvmon.testing.generate.spec import Profile, random_spec
from rvmon.testing.generate.trace import TraceProfile, random_trace

CORE = Path(core_sources.FOLDER)
OTHERS = {
    "models": (Path(core_sources.ZONES_FOLDER), "zones.c"),
    "csv": (Path(core_sources.CSV_FOLDER), "csv.c"),
}
"""The targets of the other extensions: their sources, and the harness."""
COMPILER = "afl-clang-fast"
FLAGS = (
    *("-std=c99", "-g", "-O1", "-fno-omit-frame-pointer", "-ffp-contract=off"),
    *("-fsanitize=fuzzer,address,undefined", "-fno-sanitize-recover=all"),
)

TARGETS = {"plans": ("-DPLANS",), "samples": (), "snapshots": ("-DSNAPSHOTS",)}
TARGETS |= dict.fromkeys(OTHERS, ())
"""Each target, and the options with which the harness is compiled for it."""

SMALL = 6_000
"""The maximum size in bytes of plans that AFL++ starts with: it gets further with small ones."""

PLANS = 200
"""The number of plans for the targets `samples` and `snapshots`."""

TRACED_MOST = 64
"""The maximum number of locations of an automaton whose coverage is counted; see plan.h."""


def _plan(rng: random.Random, profile: Profile, which: int) -> Plan:
    """A random plan: of requirements, of observed formulas, or of coverage bins."""
    if which > 5:
        return Bins(with_random_coverage(rng, profile)).plan
    compiled = compile_spec(random_spec(rng, profile))
    if which > 3:
        return truths_plan(compiled)
    traced = [
        name
        for name, one in compiled.requirements.items()
        if one.automaton is not None and len(one.automaton.locations) <= TRACED_MOST
    ]
    measured = which in (1, 2)
    return plan_alone(compiled, traced=traced if which > 1 else (), measured=measured)


def plans(seed: object, *, most: int, limit: int | None = None) -> Iterator[bytes]:
    """Packed plans of random specifications: `most` of them, of at most `limit` bytes each."""
    rng = random.Random(str(seed))
    made = 0
    while made < most:
        is_bins = made % 8 > 5
        profile = Profile(
            requirements=1 if limit else 3,
            depth=rng.randint(1, 3),
            wide=10,
            captures=not is_bins,
            for_each=not is_bins,
        )
        try:
            plan = _plan(rng, profile, made % 8)
            data = pack(plan).data
        except RvmonError:
            continue
        if limit is None or len(data) <= limit:
            made += 1
            yield data


def snapshots(most: int) -> Iterator[tuple[bytes, bytes]]:
    """Plans of random specifications, each with the snapshot of a run without its head."""
    rng = random.Random("snapshots")
    made = 0
    while made < most:
        profile = Profile(requirements=1 + made % 3, depth=rng.randint(1, 3))
        try:
            compiled_spec = compile_spec(random_spec(rng, profile))
        except RvmonError:
            continue
        planned = planned_core(compiled_spec)
        case = random_trace(rng, compiled_spec.checked, TraceProfile(outages=100 * (made % 2)))
        run = planned.monitor(frozenset())
        for action in [*told(case)][: rng.randint(1, 12)]:
            tell(planned, run, action)
        made += 1
        yield planned.packed.data, run.save()[HEAD:]


def compiled(folder: Path, target: str) -> Path:
    """Compile the program of a target into a folder.

    Raises:
        CalledProcessError: the compiler failed.
    """
    made, memory = folder / target, folder / "memory.c"
    home, harness = OTHERS.get(target, (CORE, "harness.c"))
    if target in OTHERS:
        sources = [path for path in home.glob("*.c") if path.name != "module.c"]
    else:
        memory.write_text(guarded_memory(), encoding="utf-8")
        sources = [CORE / name for name in core_sources.core_files() if name != "memory.c"]
        sources.append(memory)
    sources.append(Path(__file__).with_name(harness))
    flags = [*FLAGS, f"-I{home}", *TARGETS[target]]
    words = [COMPILER, *flags, *map(str, sources), "-lm", "-o", str(made)]
    subprocess.run(words, check=True, capture_output=True)
    return made


def begun_with(folder: Path, target: str) -> None:
    """Write the initial inputs of AFL++, and the plans with which samples are judged."""
    held, rng = list[bytes](), random.Random("samples")
    match target:
        case "plans":
            inputs = [*plans("plans", most=60, limit=SMALL)]
        case "models":
            inputs = [searched.numbers for searched in search_plans(range(12))]
        case "csv":  # bytes that describe the columns, and a text
            inputs = [rng.randbytes(5) + data[1:] for data in seeds("recording")]
        case "snapshots":
            held, inputs = map(list, zip(*snapshots(PLANS), strict=True))
        case _:
            held = [*plans("samples", most=PLANS)]
            inputs = [rng.randbytes(120) for _ in held]
    (folder / "in").mkdir()
    for number, data in enumerate(inputs):
        (folder / "in" / str(number)).write_bytes((bytes([number]) if held else b"") + data)
    sized = b"".join(struct.pack("<q", len(plan)) + plan for plan in held)
    (folder / "held").write_bytes(sized)


def by_afl(target: str, folder: Path, seconds: int) -> tuple[str, Sequence[Path]]:
    """Fuzz a target; inputs found stay in its folder, and the next call continues from them."""
    made = compiled(folder, target)
    if not (folder / "in").exists():
        begun_with(folder, target)
    environment = os.environ | dict.fromkeys(_SET, "1")
    environment["RVMON_PLANS"] = str(folder / "held")
    environment["ASAN_OPTIONS"] = "abort_on_error=1:symbolize=0:detect_leaks=0"
    words = ["afl-fuzz", "-i", folder / "in", "-o", folder / "out", "-m", "none", "-t", "5000"]
    words += ["-V", str(seconds), "--", made]
    with (folder / "log.txt").open("w") as log:
        subprocess.run([*map(str, words)], env=environment, stdout=log, stderr=log, check=False)
    out = folder / "out" / "default"
    lines = (out / "fuzzer_stats").read_text().splitlines()
    pairs = (line.partition(":") for line in lines)
    counted = {name.strip(): value.strip() for name, _, value in pairs}
    told = ", ".join(f"{name} {counted.get(name)}" for name in _TOLD)
    return told, sorted([*out.glob("crashes/id*"), *out.glob("hangs/id*")])


_SET = (
    *("AFL_NO_UI", "AFL_SKIP_CPUFREQ", "AFL_NO_AFFINITY", "AFL_AUTORESUME"),
    "AFL_I_DONT_CARE_ABOUT_MISSING_CRASHES",
)
_TOLD = ("run_time", "execs_done", "execs_per_sec", "corpus_count", "bitmap_cvg", "stability")
