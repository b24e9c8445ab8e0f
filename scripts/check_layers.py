#!/usr/bin/env python3
"""Checks the shape of the sources, tests aside; prints each offence as file:line.

Every file includes only what stands before its own folder in the order of layers, headers of a library belong to one
layer, no file has more than 300 lines, and no function more than 60.
"""
import ast
import re
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parent.parent
LAYERS = ["partition", "io", "src/config", "src/garment", "src/state", "src/linear", "src/forces", "src/contact",
          "src/constraints", "src/newton", "src/filters", "src/time", "src/output", "src/command"]
# Headers by how they begin, and whose they are.
RESERVED = {"petsc": "src/linear", "metis": "partition", "ptscotch": "partition", "hdf5": "io",
            "yaml-cpp": "src/config", "geos": "src/garment", "embree": "src/contact",
            "CGAL": "src/contact"}
FILE_LINES, FUNCTION_LINES = 300, 60


def sources():
    """All files of C++ and Python, (path, text)."""
    listed = subprocess.run(["git", "ls-files", "-co", "--exclude-standard"], cwd=ROOT, check=True, capture_output=True,
                            text=True).stdout
    for name in sorted(listed.splitlines()):
        path = ROOT / name
        if name.startswith("tests/") or not path.is_file() or path.suffix not in (".cpp", ".hpp", ".py", ""):
            continue
        text = path.read_text()
        if path.suffix or re.match(r"#!.*python", text):
            yield name, text


def layer_of(name):
    return next((layer for layer in LAYERS if name.startswith(layer + "/")), None)


def includes(name, text):
    """What a file of a layer must not include."""
    layer = layer_of(name)
    if layer is None:
        return
    for match in re.finditer(r'^\s*#include [<"]([^>"]+)[>"]', text, re.M):
        header, line = match[1], text.count("\n", 0, match.start(1)) + 1
        home = layer_of(header)
        if home and LAYERS.index(home) > LAYERS.index(layer):
            yield line, f"{layer} must not include {home}"
        for library, owner in RESERVED.items():
            if header.startswith(library) and layer != owner:
                yield line, f"{header} belongs to {owner} alone"


def functions_of_cpp(text):
    """(first line, lines) of the outermost blocks that belong to something with brackets, as clang-format sets them:
    the closing brace stands in the column in which the head begins."""
    lines = [re.sub(r"\s*//.*", "", line) for line in text.splitlines()]
    number = 0
    while number < len(lines):
        start, head = number, lines[number]
        while "(" in head and head[-1] not in ";{}" and number + 1 < len(lines) and lines[number + 1]:
            number += 1
            head += lines[number]
        if "(" in head and head.endswith("{"):
            closing = re.sub(r"\S.*", "}", lines[start])
            number = next((k for k in range(number, len(lines)) if lines[k].startswith(closing)), number)
            yield start + 1, number - start + 1
        number += 1


def functions_of_python(text):
    for node in ast.walk(ast.parse(text)):
        if isinstance(node, ast.FunctionDef) and node.end_lineno is not None:
            yield node.lineno, node.end_lineno - node.lineno + 1


def sizes(name, text):
    """What is too long."""
    length = text.count("\n")
    if length > FILE_LINES:
        yield 1, f"the file has {length} lines; at most {FILE_LINES}"
    functions = functions_of_cpp(text) if name.endswith("pp") else functions_of_python(text)
    for line, count in functions:
        if count > FUNCTION_LINES:
            yield line, f"the function has {count} lines; at most {FUNCTION_LINES}"


def main():
    offences = [f"{name}:{line}: {offence}" for name, text in sources()
                for check in (includes, sizes) for line, offence in check(name, text)]
    print("\n".join(offences) or "layers: in order")
    sys.exit(1 if offences else 0)


main()
