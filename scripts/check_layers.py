#!/usr/bin/env python3
"""Checks that every file includes only what stands to the left of it in the order of layers, and that MPI-only and PETSc-only
folders stay so. Prints each offence as file:line."""
import pathlib
import re
import sys

root = pathlib.Path(__file__).resolve().parent.parent
# Each layer with what it may include besides itself.
layers = {
    "partition": [],
    "io": ["partition"],
    "src/config": ["partition", "io"],
    "src/state": ["partition", "io", "src/config"],
    "src/linear": ["partition", "io", "src/config", "src/state"],
    "src/forces": ["partition", "io", "src/config", "src/state", "src/linear"],
    "src/contact": ["partition", "io", "src/config", "src/state", "src/linear", "src/forces"],
    "src/filters": ["partition", "io", "src/config", "src/state", "src/linear", "src/forces", "src/contact"],
    "src/time": ["partition", "io", "src/config", "src/state", "src/linear", "src/forces", "src/contact", "src/filters"],
    "src/output": ["partition", "io", "src/config", "src/state", "src/linear", "src/forces", "src/contact", "src/filters", "src/time"],
    "src/command": ["partition", "io", "src/config", "src/state", "src/linear", "src/forces", "src/contact", "src/filters", "src/time",
                    "src/output"],
}
# Headers of a library belong to one layer.
reserved = {"petsc": "src/linear", "metis": "partition", "ptscotch": "partition", "hdf5": "io", "yaml-cpp": "src/config", "embree": "src/contact", "CGAL": "src/contact"}

offences = []
for layer, allowed in layers.items():
    for file in sorted((root / layer).glob("*.[ch]pp")):
        for number, line in enumerate(file.read_text().splitlines(), 1):
            match = re.match(r'\s*#include [<"]([^>"]+)[>"]', line)
            if not match:
                continue
            header = match.group(1)
            home = next((l for l in layers if header.startswith(l + "/")), None)
            if home and home != layer and home not in allowed:
                offences.append(f"{file.relative_to(root)}:{number}: {layer} must not include {home}")
            for library, owner in reserved.items():
                if header.startswith(library) and layer != owner:
                    offences.append(f"{file.relative_to(root)}:{number}: {header} belongs to {owner} alone")
print("\n".join(offences) or "layers: in order")
sys.exit(1 if offences else 0)
