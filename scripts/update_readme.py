#!/usr/bin/env python3
"""Puts the table of all keys, as `taut schema --table` prints it, into src/config/README.md."""
import argparse
import re
import subprocess
import sys

import debian_python  # noqa: F401

from taut import launch

parser = argparse.ArgumentParser(description=__doc__)
parser.add_argument("--check", action="store_true", help="only say whether the table is that of the program")
launch.add_program(parser)
options = parser.parse_args()
readme = launch.ROOT / "src/config/README.md"
old = readme.read_text()
table = subprocess.run([options.program, "schema", "--table"], check=True, capture_output=True,
                       text=True).stdout.strip()
begin, end = "<!-- made by scripts/update_readme.py from `taut schema --table` -->", "<!-- end -->"
new = re.sub(re.escape(begin) + ".*?" + re.escape(end), lambda _: f"{begin}\n{table}\n{end}", old, flags=re.S)
if not options.check:
    readme.write_text(new)
elif new != old:
    sys.exit("src/config/README.md: the table of keys is not that of the program; run scripts/update_readme.py")
