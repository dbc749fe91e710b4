"""The exported C judges like the extension, and never passes anything when memory runs out."""

import re
import shlex
import shutil
import subprocess
import zlib
from functools import partial
from itertools import islice

import pytest
from tests.rvmon.core.exported import HEAP, Exported, core_in
from tests.tools.differential import cases_of
from tests.tools.hostile import FORGERIES, hostile_names

import rvmon
from rvmon.core.c_files import FEWEST, c_files, identifiers
from rvmon.core.pack import pack
from rvmon.language.checked.specification import TimeModel
from rvmon.monitor.compiled_spec import compile_spec
from rvmon.monitor.requirement_plans import plan_alone
from rvmon.native import memory_of
from rvmon.testing.generate.spec import Profile
from rvmon.testing.generate.trace import Case, TraceProfile
from rvmon.trace.sample import Sample

pytestmark = pytest.mark.compiler

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic")
SANITIZED = ("-O0", "-fsanitize=address,undefined", "-fsanitize-undefined-trap-on-error")
"""Undefined behaviour traps; the runtime that would print a report takes long to compile."""
WATCHED = ("gcc", *STRICT, *SANITIZED)
NARROW = ("gcc", *STRICT, "-m32", "-msse2", "-mfpmath=sse")
STRICTEST = (*STRICT, "-Wconversion", "-Wshadow")
PLAIN = ("gcc", *STRICTEST)
GREEN = {"1", "3"}
"""Verdicts PASS and NOT_TRIGGERED, as `judge.c` prints them."""
LARGE = 1 << 20


def judged(seed, many, **profile):
    """Random cases that go through the time models in turn."""
    number = 0
    times = list(TimeModel)
    while many > 0:
        how = Profile(time=times[number % len(times)], **profile)
        for case in islice(cases_of(f"{seed}/{number}", how, TraceProfile(), 2, windows=20), many):
            many -= 1
            yield case
        number += 1


@pytest.fixture(scope="module")
def core_object(shared):
    """Compiles the core once per compiler command; it is what takes longest to compile."""

    def made(*command):
        name = f"core {zlib.crc32(shlex.join(command).encode()):x}"
        return shared(name, partial(core_in, command)) / "rvmon_core.o"

    return made


@pytest.fixture
def exported(tmp_path, core_object):
    """Builds a program of some cases."""
    return lambda cases: Exported(tmp_path, cases, WATCHED, core_object(*WATCHED))


def test_exported_c_judges_as_the_extension(exported, core_object):
    exported = exported(list(judged("export", 60)))
    wanted = [2 * exported.records_of_extension(number) for number in range(60)]
    found = [records(run) for run in exported.judge([(number, HEAP) for number in range(60)])]
    assert found == wanted
    exported.compile(NARROW, core_object(*NARROW))
    found = [records(run) for run in exported.judge([(number, HEAP) for number in range(60)])]
    assert found == wanted, "32 bits"
    assert sum(map(len, found)) > 150
    assert sum(":" in line for lines in found for line in lines) > 8, "captured values"


def records(run):
    """Lines of records and of errors."""
    return [line for line in run if line.startswith(("r ", "x "))]


def without_memory(run):
    """The printed lines without the number of bytes used."""
    return [line.rpartition(" ")[0] if line.startswith("e ") else line for line in run]


def test_keeping_notes_changes_no_record_and_no_verdict(exported):
    cases = list(judged("notes", 60))
    of_cases = exported(cases)
    runs = [(number, HEAP) for number in range(len(cases))]
    bare, noted = of_cases.judge(runs), of_cases.judge(runs, notes=True)
    assert list(map(without_memory, bare)) == list(map(without_memory, noted))


def test_memory_does_not_grow_with_the_length_of_a_run(exported):
    """The core drops the past of nested windows, and keeps at most 400 bytes of notes a record."""
    cases = []
    for time in ("held", "sampled", "sampled every 2 ns"):
        for required in (
            "always F[0 ns, 9 ns] G[0 ns, 3 ns] p",
            "always F[0 ns, 9 ns] G[0 ns, 3 ns] (p or not p)",
            "upon p then F[0 ns, 40 ns] q",
        ):
            text = f"time {time}\nsignal p, q : bool\nrequirement R\n  {required}\n"
            spec = rvmon.loads(text).checked
            turns = [Sample(t, {"p": t % 17 > 2, "q": t % 5 == 0}) for t in range(4000)]
            cases += [Case(spec, tuple(turns[:many])) for many in (1000, 4000)]
    numbers, of_cases = range(len(cases)), exported(cases)
    for notes in (False, True):
        runs = of_cases.judge([(number, HEAP) for number in numbers], notes=notes)
        used = [int(run[-1].split()[-1]) for run in runs]
        recorded = [len(records(run)) for run in runs]
        grown = [b - a for a, b in zip(used[::2], used[1::2], strict=True)]
        more = [b - a for a, b in zip(recorded[::2], recorded[1::2], strict=True)]
        each = 400 if notes else 0
        limits = zip(grown, more, strict=True)
        assert all(size <= each * count for size, count in limits), (grown, more)


def test_a_block_that_is_too_small_passes_nothing(exported):
    """Any block judges like a heap, is refused, or reports that memory ran out."""
    exported = exported(list(judged("memory", 40)))
    spoilt = 0
    on_heap = exported.judge([(number, HEAP) for number in range(40)])
    for number, whole in enumerate(exported.judge([(number, LARGE) for number in range(40)])):
        assert without_memory(whole) == without_memory(on_heap[number])
        enough = int(whole[-1].split()[-1])
        steps = {*range(0, enough, -(-enough // 40)), *range(enough - 400, enough, 16)}
        sizes = [*sorted(steps), enough, 2 * enough]
        runs = exported.judge([(number, size) for size in sizes])
        assert runs[0] == ["none"]
        assert runs[-2:] == [whole, whole]
        runs += exported.judge([(number, size) for size in sizes[::4]], notes=True)
        for run in runs:
            if run != ["none"]:
                spoilt += sum(map(is_spoilt, halves(run), halves(whole)))
    assert spoilt > 500


STALE = """
signal p : bool stale after 9 ns
signal q : bool
requirement R
  whenever historically[0 ns, 3 ns] p
  then within 99 ns q
"""
"""An attempt starts and its trigger becomes unknown within one call, which dissolves the queue."""


FORKED = """
signal x : real
signal p : bool
event e
requirement R
  upon e
  then F[0 ns, 9 ns] (p and x > v)
  let v = x
"""
"""Each attempt has a run of its own, with notes, and is given samples by the value of `x`."""


def test_a_failed_allocation_passes_nothing(core_object, tmp_path):
    """Whichever it is; open attempts are in queues, and chunks are as small as possible.

    With enough memory again, the run after a reset has its usual result.
    """
    command = (*WATCHED, "-DCHUNK_SIZE=((size_t)16)")
    stale = Sample(0, {"p": False, "q": False}), Sample(1, {"p": True}), Sample(50, {})
    forked = tuple(Sample(t, {"x": t % 3, "p": t % 4 == 1, "e": t % 2 == 1}) for t in range(9))
    cases = [
        *judged("heap", 12),
        Case(rvmon.loads(STALE).checked, stale),
        Case(rvmon.loads(FORKED).checked, forked),
    ]
    exported = Exported(tmp_path, cases, command, core_object(*command))
    spoilt = 0
    for number, whole in enumerate(exported.judge([(number, HEAP) for number in range(14)])):
        limits = [(number, HEAP - 1 - granted) for granted in range(150)]
        runs = [*exported.judge(limits), *exported.judge(limits, notes=True)]
        assert runs[0] == ["none"]
        for first, again in (halves(run) for run in runs if run != ["none"]):
            spoilt += is_spoilt(first, halves(whole)[0])
            assert without_memory(again) == without_memory(halves(whole)[1])
    assert spoilt > 250


def halves(run):
    """The lines of the first run and those of the second."""
    ends = [place for place, line in enumerate(run) if line.startswith("e ")]
    assert len(ends) == 2
    return run[1 : ends[0] + 1], run[ends[0] + 1 :]


def is_spoilt(found, whole):
    """Whether memory ran out in a run; checks that it equals a whole run up to that point."""
    _, spoilt, *verdicts, _ = found[-1].split()
    if spoilt == "0":
        assert (found[:-1], verdicts) == (whole[:-1], whole[-1].split()[2:-1])
        return False
    short = found.index("x 1")
    assert found[:short] == whole[:short]
    passed = [line for line in records(found[short:]) if line.split()[5:6] == ["1"]]
    assert set(passed) <= set(whole), "an attempt passed after memory had run out"
    assert not GREEN & set(verdicts)
    return True


def text_of(spec, *requirements):
    return f"spec {spec}\nsignal b : bool\n" + "".join(
        f"requirement `{one}`\n  always b\n" for one in requirements
    )


def written(folder, text):
    """Write the C files of a specification to a folder; returns the names of the plan files."""
    texts = c_files(plan_alone(compile_spec(rvmon.loads(text).checked)))
    for name, file in texts.items():
        (folder / name).write_text(file, encoding="utf-8")
    return [name for name in texts if name.endswith("_plan.c")]


def run(folder, *line):
    """Run a command in a folder; returns its output."""
    done = subprocess.run(line, cwd=folder, check=True, stdout=subprocess.PIPE, text=True)  # noqa: S603
    return done.stdout


def test_strict_compilers_accept_the_files_and_only_the_interface_is_exported(
    tmp_path, core_object
):
    (plan,) = written(tmp_path, text_of("door", "A"))
    for compiler in ("arm-none-eabi-gcc -mthumb -mcpu=cortex-m3", "clang"):
        line = [*compiler.split(), *STRICTEST, "-fsyntax-only", plan, "rvmon_core.c"]
        if shutil.which(line[0]):
            run(tmp_path, *line)
    run(tmp_path, *PLAIN, "-c", plan, "-o", "plan.o")
    for name, prefix in ((core_object(*PLAIN), "rv_"), ("plan.o", "door_")):
        symbols = run(tmp_path, "nm", "-g", "--defined-only", name)
        found = [line.split()[-1] for line in symbols.splitlines()]
        assert found
        assert all(one.startswith(prefix) for one in found)


HOSTILE = [name for name in (*FORGERIES, "??/", "a_n1", "A_N1", "a n1") if name.strip() == name]


def test_hostile_names_become_distinct_identifiers_and_strings(tmp_path):
    names = [*HOSTILE, *islice((one for one in hostile_names(1) if one.strip() == one), 300)]
    names = list(dict.fromkeys(name for name in names if not set(name) & set("\0\r\n`")))
    (plan,) = written(tmp_path, text_of("`*/ int x; /*`", *names))
    prefix = plan.removesuffix("_plan.c")
    (tmp_path / "main.c").write_text(
        f'#include "{plan}"\n#include <stdio.h>\nint main(void) {{ int i; '
        f"for (i = 0; i < {prefix.upper()}_REQUIREMENTS; i++) puts({prefix}_requirements[i]); "
        "return 0; }\n"
    )
    run(tmp_path, "gcc", *STRICT, "main.c", "-o", "main")
    done = subprocess.run([tmp_path / "main"], check=True, stdout=subprocess.PIPE)  # noqa: S603
    assert done.stdout.decode("utf-8", "surrogatepass").split("\n") == [*names, ""]
    made = identifiers([*names, "speed", "e-stop"])
    assert len({*made}) == len(names) + 2
    assert all(re.fullmatch(r"[A-Za-z0-9]+(_[A-Za-z0-9]+)*", one) for one in made)
    assert made[-2:] == ["SPEED", "E_STOP"]


SIZES = """
#include "door_plan.h"
#include <stdint.h>
#include <stdio.h>

static uint64_t block[DOOR_MEMORY(64) / 8 + 2];

int main(void)
{
    size_t size;
    int32_t attempts;
    for (size = 0; size < sizeof block; size += 16) {
        const rv_memory memory = {NULL, NULL, NULL, block, size};
        if (rv_new(door_plan, sizeof door_plan, memory) != NULL) {
            break;
        }
    }
    printf("%zu %d\\n", size, (int)DOOR_MEMORY(0));
    for (attempts = 0; attempts <= 64; attempts++) {
        const rv_memory memory = {
            NULL, NULL, NULL, (char *)block + attempts % 16, DOOR_MEMORY(attempts)};
        rv_monitor *m = rv_new(door_plan, sizeof door_plan, memory);
        if ((m == NULL) || (rv_reserve(m, attempts) != RV_OK)) {
            return 1;
        }
    }
    return 0;
}
"""

KEYED = """
spec door
signal b : bool
event e(k : int)
requirement R1
  upon e
  then within 3 s b
requirement R2
  upon e
  then within 3 s b
  for each i in e.k
"""


@pytest.mark.parametrize("text", [text_of("door", "A"), KEYED], ids=["plain", "keyed"])
def test_the_stated_memory_is_enough(tmp_path, core_object, text):
    (plan,) = written(tmp_path, text)
    (tmp_path / "main.c").write_text(SIZES)
    fewest_bytes = []
    for line in (PLAIN, NARROW):
        run(tmp_path, *line, "main.c", plan, core_object(*line), "-o", "main", "-lm")
        least, stated = map(int, run(tmp_path, tmp_path / "main").split())
        assert least <= stated
        fewest_bytes.append(least)
    assert fewest_bytes[1] < fewest_bytes[0]
    data = pack(plan_alone(compile_spec(rvmon.loads(text).checked))).data
    assert fewest_bytes[0] == memory_of(data, 0)
    assert memory_of(data, FEWEST) > memory_of(data, 0)


def test_reserved_attempts_take_no_more_memory(exported):
    """They use the reserved memory instead of queues."""
    text = "signal q : bool\nevent e\nrequirement R\n  upon e\n  then within 9 ns q\n"
    checked = rvmon.loads(text).checked
    case = Case(checked, tuple(Sample(t, {"e": True, "q": False}) for t in range(8)))
    size = memory_of(pack(plan_alone(compile_spec(checked))).data, len(case.samples))
    found, large = exported([case]).judge([(0, size), (0, LARGE)], len(case.samples))
    assert found == large != ["none"]


CPP = """
#include "rvmon_core.hpp"
#include "door_plan.h"
#include <cstdio>

static void judge(rvmon::Monitor monitor)
{
    if (!monitor) {
        std::puts("none");
        return;
    }
    monitor.step(0, {rvmon::whole(DOOR_SIGNAL_B, 1)});
    monitor.step(1, {rvmon::unknown(DOOR_SIGNAL_B)});
    monitor.step(2, {rvmon::whole(DOOR_SIGNAL_B, 0)});
    monitor.records([](const rv_record &one) {
        std::printf("%d at %d\\n", one.verdict, (int)one.decided);
    });
    std::printf("%d %d\\n", monitor.finish(), monitor.verdict(DOOR_REQUIREMENT_A));
}

int main()
{
    static char block[DOOR_MEMORY(4)];
    rvmon::Monitor monitor(door_plan, sizeof door_plan);
    judge(std::move(monitor));
    judge(rvmon::Monitor(door_plan, sizeof door_plan, block, sizeof block));
    judge(rvmon::Monitor(door_plan, sizeof door_plan, block, 100));
    return monitor ? 1 : 0;
}
"""


def test_the_cpp_header_compiles_and_judges(tmp_path, core_object):
    (plan,) = written(tmp_path, text_of("door", "A"))
    (tmp_path / "main.cpp").write_text(CPP)
    run(tmp_path, *WATCHED, "-c", plan)
    objects = [plan.replace(".c", ".o"), core_object(*WATCHED)]
    warnings = ["-Wall", "-Wextra", "-Wconversion", "-Wshadow", "-pedantic", "-Werror"]
    for compiler in filter(shutil.which, ("clang++", "g++")):
        for standard in ("-std=c++20", "-std=c++11"):
            line = [compiler, standard, *warnings]
            run(tmp_path, *line, "-x", "c++", "-c", plan, "-o", "plan.o")
            run(tmp_path, *line, "-c", "main.cpp", "-o", "main.o")
    run(tmp_path, "g++", "-std=c++11", *SANITIZED, "main.cpp", *objects, "-o", "main")
    assert run(tmp_path, tmp_path / "main") == "0 at 2\n0 0\n0 at 2\n0 0\nnone\n"
