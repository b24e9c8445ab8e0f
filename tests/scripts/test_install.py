#!/usr/bin/env python3
"""What `cmake --install` leaves in a clean prefix serves: program, scripts, Python, and the projection as a library."""
import math
import os
import re
import subprocess
import sys
import unittest
from pathlib import Path

import running
from taut import launch

BUILD = Path(sys.argv.pop(1))  # the folder of the build


class Installation(running.Folder):
    def done(self, *words, **options):
        done = subprocess.run([*map(str, words)], capture_output=True, text=True, check=False, cwd=self.folder,
                              **options)
        self.assertEqual(done.returncode, 0, done.stdout[-3000:] + done.stderr[-3000:])
        return done.stdout

    def setUp(self):
        super().setUp()
        self.prefix = self.folder / "prefix"
        self.done("cmake", "--install", BUILD, "--prefix", self.prefix)

    def test_program_and_scripts(self):
        program, scripts = self.prefix / "bin/taut", self.prefix / "share/taut/scripts"
        self.done(program, "run", "case.yaml", "--out", "result", "--set", "time.end=0.05")
        self.done(scripts / "plot", "result")
        environment = {**os.environ, "PYTHONPATH": str(scripts)}
        environment.pop("TAUT")
        said = self.done(sys.executable, "-c", "from taut import launch; print(launch.PROGRAM)", env=environment)
        self.assertEqual(said.strip(), str(program.resolve()))
        self.done(sys.executable, "-m", "taut", "result", env=environment)

    def test_a_project_that_links_the_projection(self):
        for header in self.prefix.glob("include/taut/**/*.hpp"):
            text = header.read_text()
            self.assertNotRegex(text, '#include "|#include <(hdf5|embree|CGAL|yaml)', header)
            self.assertNotIn("contact/", "".join(line for line in text.splitlines() if "#include" in line), header)
        page = (launch.ROOT / "scripts/README.md").read_text()  # the project is the one that is printed there
        for language, name in (("cmake", "CMakeLists.txt"), ("cpp", "main.cpp")):
            blocks = re.findall(rf"^```{language}\n(.*?)^```", page, re.M | re.S)
            (self.folder / name).write_text(blocks[0])
        self.done("cmake", "-S", ".", "-B", "built", "-G", "Ninja", f"-DCMAKE_PREFIX_PATH={self.prefix}",
                  "-DCMAKE_BUILD_TYPE=Release")
        self.done("cmake", "--build", "built")
        program = self.folder / "built/hung_sheet"
        for ranks in (1, 2):
            said = self.done(*launch.command(program, ranks=ranks), env=launch.ENVIRONMENT)
            found = {int(n): (float(x), float(y)) for n, x, y in re.findall(r"vertex (\d): (\S+) (\S+)", said)}
            self.assertEqual(sorted(found), list(range(6)))
            for a, b in ((0, 1), (1, 2), (3, 4), (4, 5), (0, 3), (1, 4), (2, 5)):
                self.assertAlmostEqual(math.dist(found[a], found[b]), 1, delta=0.0101)
        needed = self.done("readelf", "--dynamic", program)
        self.assertIn("libpetsc", needed)
        self.assertNotRegex(needed, "NEEDED.*(hdf5|embree|geos|yaml|gmp)")
        commands = (self.folder / "built/build.ninja").read_text()
        self.assertNotIn("-Wshadow", commands)  # warnings are Taut's own
        self.assertIn("-std=gnu++20", commands)

    def test_pip(self):
        source = self.folder / "scripts"  # pip leaves traces beside what it installs
        self.done("cp", "-r", launch.ROOT / "scripts", source)
        self.done("/usr/bin/python3", "-m", "pip", "install", "--quiet", "--no-deps", "--no-build-isolation",
                  "--target", "site", source)
        said = self.done("/usr/bin/python3", "-c", "import taut.launch; print(taut.__file__, taut.launch.variables())",
                         env={**launch.ENVIRONMENT, "PYTHONPATH": str(self.folder / "site")})
        self.assertIn(str(self.folder / "site"), said)


if __name__ == "__main__":
    unittest.main()
