"""Build a monitor for a Cortex-M4, feed it a recording under QEMU, and compare the verdicts.

python run.py [SPEC RECORDING]
"""

import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

import rvmon

HERE = Path(__file__).parent
DEFAULT = HERE.parent / "base.rv", HERE.parent / "base.csv"
ATTEMPTS = 16  # the most attempts that may be open at once
FLAGS = "-std=c99 -mcpu=cortex-m4 -mthumb -Os -ffp-contract=off -ffunction-sections -fdata-sections"
LINK = f"-nostartfiles --specs=nosys.specs -Wl,--gc-sections -T{HERE / 'board.ld'}"
BOARD = "-machine mps2-an386 -display none -icount shift=0 -chardev stdio,id=host"
HOST = "-semihosting-config enable=on,target=native,chardev=host"


def header(prefix, spec, samples):
    """The recording as C: instant and number of updates per sample, and all updates in a row."""
    number = {name: place for place, name in enumerate([*spec.schema.signals, *spec.schema.events])}
    yield f'#include "{prefix}_plan.h"'
    yield f"#define PLAN {prefix}_plan"
    yield f"#define REQUIREMENTS {prefix}_requirements"
    yield f"#define ATTEMPTS {ATTEMPTS}"
    yield f"#define MEMORY ({prefix.upper()}_MEMORY(ATTEMPTS) + 4096) /* and what it remembers */"
    yield "static const rv_update all_updates[] = {"
    for sample in samples:
        for name, value in sample.values.items():
            says = "UNKNOWN" if value is None else "NO" if value is False else "YES"
            number_of = "{RV_UNKNOWN, {0}}"
            if value is not None and name in spec.schema.signals:
                is_real = spec.schema.signals[name] == "real"
                says, kind = "YES", "REAL, {.real" if is_real else "WHOLE, {.whole"
                number_of = f"{{RV_{kind} = {float(value) if is_real else int(value)}}}}}"
            yield f"    {{{number[name]}, RV_SAYS_{says}, {number_of}, NULL}},"
    yield "};"
    yield "static const struct { int64_t t; int32_t count; } rows[] = {"
    yield from (f"    {{{sample.t}, {len(sample.values)}}}," for sample in samples)
    yield "};\n"


def run(command):
    return subprocess.run(command.split(), check=True, capture_output=True, text=True).stdout


def main(spec_path, recording):
    if not (shutil.which("arm-none-eabi-gcc") and shutil.which("qemu-system-arm")):
        sys.exit("needs gcc-arm-none-eabi, libnewlib-arm-none-eabi and qemu-system-arm")
    spec = rvmon.load(spec_path)
    with tempfile.TemporaryDirectory() as made:
        run(f"{sys.executable} -m rvmon export {spec_path} --to c -o {made}")
        (plan,) = Path(made).glob("*_plan.c")
        rows = "\n".join(
            header(plan.stem.removesuffix("_plan"), spec, [*spec.recording(recording)])
        )
        Path(made, "rows.h").write_text(rows)
        for source in (f"{HERE}/main.c", plan, f"{made}/rvmon_core.c"):
            run(f"arm-none-eabi-gcc {FLAGS} -I{made} -c {source} -o {made}/{Path(source).stem}.o")
        objects = f"{made}/main.o {made}/{plan.stem}.o {made}/rvmon_core.o"
        run(f"arm-none-eabi-gcc {FLAGS} {LINK} {objects} -o {made}/board.elf -lm")
        print(run(f"arm-none-eabi-size {objects} {made}/board.elf").replace(f"{made}/", ""), end="")
        *records, last = run(
            f"qemu-system-arm {BOARD} {HOST} -kernel {made}/board.elf"
        ).splitlines()
    code, total, most, begun, reserved, used = map(int, last.split())
    # The timer runs at 25 MHz and QEMU executes an instruction per ns: 40 instructions per tick.
    print(*records, f"{40 * total} instructions, at most {40 * most} for a sample", sep="\n")
    print(f"{begun} bytes to begin, {reserved} with {ATTEMPTS} attempts, {used} at the end")
    found = spec.evaluate(recording).attempts
    wanted = {f"{one.name} {one.verdict} {one.triggered} {one.decided} " for one in found}
    sys.exit(0 if {*records} == wanted and code == 0 else f"rvmon says otherwise: {sorted(wanted)}")


if __name__ == "__main__":
    main(*(sys.argv[1:] or DEFAULT))
