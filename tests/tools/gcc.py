"""How tests compile C strictly, and so that it stops at its first false step."""

STRICT = ("-std=c99", "-Wall", "-Wextra", "-Werror", "-pedantic")

SANITIZED = ("-O0", "-fsanitize=address,undefined", "-fsanitize-undefined-trap-on-error")
"""Where something undefined is done, the program dies: that takes a third of the time that it takes
to compile what tells of it."""
