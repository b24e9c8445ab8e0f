#!/usr/bin/env python3
"""Puts the table of all keys, as `taut schema --table` prints it, into README.md: scripts/update_readme.py [--check] [PROGRAM]"""
import pathlib
import re
import subprocess
import sys

root = pathlib.Path(__file__).resolve().parent.parent
arguments = [a for a in sys.argv[1:] if a != "--check"]
program = arguments[0] if arguments else str(root / "build" / "taut")
readme = root / "README.md"
old = readme.read_text()
table = subprocess.run([program, "schema", "--table"], check=True, capture_output=True, text=True).stdout.strip()
begin, end = "<!-- made by scripts/update_readme.py from `taut schema --table` -->", "<!-- end -->"
new = re.sub(re.escape(begin) + ".*?" + re.escape(end), lambda _: f"{begin}\n{table}\n{end}", old, flags=re.S)
if "--check" in sys.argv and new != old:
    sys.exit("README.md: the table of keys is not that of the program; run scripts/update_readme.py")
readme.write_text(new)
