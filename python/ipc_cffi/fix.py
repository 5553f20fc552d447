"""python -m ipc_cffi.fix SCRIPT ...: what programs for Python 2 and the module IPC need changed.

Reports places, and changes nothing.
"""
from __future__ import annotations

import io
import re
import sys
from typing import Iterator, List, Tuple

#: What a line of Python 2 looks like, and what to do about it.
SPOTS: List[Tuple[str, str]] = [
    (r"^\s*print(\s+[^\s(=.,]|\s*$|\s*>>|\s+\(.*\)\s*%)", "print is a function: print(...)"),
    (r"^\s*raise\s+(\"|')", "a string cannot be raised: raise Exception(...)"),
    (r"^\s*raise\s+[\w.]+\s*,", "raise Class, value: raise Class(value)"),
    (r"^\s*except\s+[^:]*\w\)?\s*,\s*\w+\s*:", "except Class, name: except Class as name"),
    (r"\b(0[xX][0-9a-fA-F]+|\d+)[lL]\b", "numbers have no suffix L"),
    (r"(?<![\w.'\"])0[0-7]+\b(?![.\w])", "octal numbers begin with 0o"),
    (r"\braw_input\s*\(", "raw_input is input"),
    (r"\bxrange\s*\(", "xrange is range"),
    (r"\.has_key\s*\(", "has_key: use in"),
    (r"\bexec\s+[\"'\w]", "exec is a function"),
    (r"<>", "<> is !="),
    (r"`[^`]+`", "`x` is repr(x)"),
    (r"\bStandardError\b", "StandardError is Exception"),
    (r"^\s*(import|from)\s+(_IPC|formatters|primFmttrs)\b", "internals of the old module"),
    (r"\bstring\.(join|split|replace|lower|upper|strip|atoi|atof)\s*\(",
     "functions of the module string are methods of str"),
]


def spots(text: str) -> Iterator[Tuple[int, str]]:
    """(number of the line, what is to be done) for each place in a program."""
    for number, line in enumerate(io.StringIO(text), 1):
        code = re.sub(r"(\"(\\.|[^\"\\])*\"|'(\\.|[^'\\])*')", '""', line)
        code = code.partition("#")[0]
        for pattern, advice in SPOTS:
            if re.search(pattern, code):
                yield number, advice


def main(paths: List[str]) -> int:
    """Reports on files; 1 if there is something to do."""
    found = False
    for path in paths:
        with open(path, encoding="utf-8", errors="surrogateescape") as file:
            text = file.read()
        for number, advice in spots(text):
            found = True
            print(f"{path}:{number}: {advice}")
        try:
            compile(text, path, "exec")
        except (SyntaxError, ValueError) as error:
            found = True
            print(f"{path}:{getattr(error, 'lineno', None) or 1}: no Python 3 yet: {error.args[0]}")
    return int(found)


if __name__ == "__main__":
    if len(sys.argv) < 2 or sys.argv[1] in ("-h", "--help"):
        print((__doc__ or "").strip())
        sys.exit(0 if len(sys.argv) > 1 else 2)
    sys.exit(main(sys.argv[1:]))
