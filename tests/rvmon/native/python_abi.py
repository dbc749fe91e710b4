"""Our own declarations of Python's stable ABI, made into C that compiles beside the real ones.

`python_abi.h` is read by its layout: structures with one field a line, constants after the comment
that names them, objects and functions one a line.
"""

import re
from pathlib import Path

HEADER = Path(__file__).parents[3] / "src" / "rvmon" / "core" / "native" / "python" / "python_abi.h"
STRUCTURE = re.compile(r"^typedef struct( \w+)? \{\n(.*?)^\} (\w+);", re.DOTALL | re.MULTILINE)
FIELD = re.compile(r"^ .*?(\w+)(?:\)\(void\))?;$", re.MULTILINE)
CONSTANTS = re.compile(r"^/\* Constants: .*?^#endif", re.DOTALL | re.MULTILINE)
CONSTANT = re.compile(r"^#define (\w+) (.+)$", re.MULTILINE)
OBJECT = re.compile(r"^extern .*?(\w+);$", re.MULTILINE)
FUNCTION = re.compile(r"^(?!typedef|extern|#| ).*?\b\(?(\w+)\)?\(.*\);$", re.MULTILINE)
COUNTED = {"ob_refcnt"}
"""Fields that have other types in later versions: we never read them."""


def declared(header: str) -> list[str]:
    """The names of declared objects and functions."""
    return OBJECT.findall(header) + FUNCTION.findall(header)


def comparison(header: str) -> str:
    """C that compiles with the real header iff both declare the same."""
    lines = [
        '#include "python_abi.h"',
        "#define SAME(a, b) __builtin_types_compatible_p(__typeof__(a), __typeof__(b))",
    ]
    # Names of the stable ABI for compiled modules only start with an underscore.
    public = [name for name in declared(header) if not name.startswith("_")]
    lines += [f'_Static_assert(sizeof(&{name}) > 0, "{name}");' for name in public]
    lines += ["#define RVMON_COMPARE_PYTHON_H", "#undef RVMON_PYTHON_ABI_H"]
    lines.append('#include "python_abi.h"')
    for name, value in CONSTANT.findall(CONSTANTS.findall(header)[0]):
        lines.append(f'_Static_assert(({name}) == ({value}), "{name}");')
    for _tag, body, name in STRUCTURE.findall(header):
        lines.append(f"typedef struct {{\n{body}}} own_{name};")
        lines.append(f'_Static_assert(sizeof(own_{name}) == sizeof({name}), "{name}");')
        for field in FIELD.findall(body):
            places = f"offsetof(own_{name}, {field}) == offsetof({name}, {field})"
            types = f"SAME(((own_{name} *)0)->{field}, (({name} *)0)->{field})"
            same = places if field in COUNTED else f"{places} && {types}"
            lines.append(f'_Static_assert({same}, "{name}.{field}");')
    return "\n".join(lines) + "\n"
