"""Build the monitor for a Cortex-M4, feed a recording to it under QEMU, compare the verdicts."""

import csv
import shutil
import subprocess
import sys
import tempfile
from decimal import Decimal
from pathlib import Path

import rvmon

HERE = Path(__file__).parent
SPEC, RECORDING = HERE.parent / "base.rv", HERE.parent / "base.csv"
FLAGS = "-std=c99 -mcpu=cortex-m4 -mthumb -Os -ffreestanding -ffunction-sections -DBASE_RANGES=16"
LINK = f"-nostartfiles --specs=nosys.specs -Wl,--gc-sections -T{HERE / 'board.ld'}"
BOARD = "-machine mps2-an386 -display none -icount shift=0 -chardev stdio,id=host"
HOST = "-semihosting-config enable=on,target=native,chardev=host"


def rows_of(spec):
    names = ",".join(f'"{name}"' for name in spec.requirements)
    yield f"static const char *const names[] = {{{names}}};"
    yield "static const struct { int64_t t; base_sample sample; } rows[] = {"
    with open(RECORDING, newline="", encoding="utf-8") as file:
        for row in csv.DictReader(file):
            cells = [row[name] for name in spec.schema.signals]
            said = ",".join("base_YES" if cell else "0" for cell in cells)
            values = ",".join(cell or "0" for cell in cells)
            event = "base_YES" if row["stop_request"] else "0"
            sample = f"{{.signal={{{said}}}, .value={{{values}}}, .event={{{event}}}}}"
            yield f"{{{int(Decimal(row['t']) * 10**9)}LL, {sample}}},"
    yield "};\n"


def run(command):
    return subprocess.run(command.split(), check=True, capture_output=True, text=True).stdout


def main():
    if not (shutil.which("arm-none-eabi-gcc") and shutil.which("qemu-system-arm")):
        sys.exit("needs gcc-arm-none-eabi, libnewlib-arm-none-eabi and qemu-system-arm")
    spec = rvmon.load(SPEC)
    with tempfile.TemporaryDirectory() as made:
        run(f"{sys.executable} -m rvmon compile {SPEC} --to c -o {made}")
        Path(made, "rows.h").write_text("\n".join(rows_of(spec)))
        program = f"{made}/base.elf"
        run(f"arm-none-eabi-gcc {FLAGS} -I{made} {LINK} {HERE}/main.c {made}/base.c -o {program}")
        print(run(f"arm-none-eabi-size {program}"), end="")
        *records, ticks = run(f"qemu-system-arm {BOARD} {HOST} -kernel {program}").splitlines()
    # The timer runs at 25 MHz, and QEMU executes an instruction in a nanosecond.
    total, most = (int(one) * 40 for one in ticks.split())
    print(*records, f"{total} instructions, at most {most} for a sample", sep="\n")
    found = spec.evaluate(RECORDING).attempts
    wanted = {f"{one.name} {one.verdict} {one.triggered} {one.decided}" for one in found}
    sys.exit(0 if {*records} == wanted else f"rvmon says otherwise: {sorted(wanted)}")


if __name__ == "__main__":
    main()
