#!/usr/bin/env python3
"""What a newcomer meets in the first minutes: names of folders, defaults that serve, verdicts, help."""
import os
import subprocess
import unittest

import numpy as np

import running
from taut import Run, launch, read_case

TRIANGLES = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0.96 1.02 0\nf 1 2 3\nf 1 3 5\nf 1 5 4\n"
SHORT = ("--set", "time.end=0.02", "--set", "time.frame_rate=50")


class FirstMinutes(running.Folder):
    def said(self, *words, **options):
        code, out, err = self.taut(*words, **options)
        self.assertEqual(code, 0, err)
        return out, err

    def write(self, name, text):
        (self.folder / name).write_text(text)
        return name

    def test_a_run_ends_with_a_verdict(self):
        out, _ = self.said("run", "case.yaml", "--out", "result", *SHORT)
        first, second = out.splitlines()[-2:]
        self.assertRegex(first, r"^small: 0.02 s in \d+ steps \(0 rejected\), .* on the clock; strain at most "
                                r"\S+ %, the limit is 1 %$")
        self.assertEqual(second, "small: what it holds: taut info result; a picture: scripts/render result")
        out, _ = self.said("run", "case.yaml", "--out", "free", "--set", "inextensibility.method=none", *SHORT)
        self.assertIn("no limit is kept", out)
        out, _ = self.said("run", "case.yaml", "--out", "met", "--set", "contact={}", *SHORT)
        self.assertIn("no intersections found", out)
        out, _ = self.said("run", "case.yaml", "--out", "swings", "--set", "time.until_rest=1 mm/s", *SHORT)
        self.assertIn("; it has not come to rest", out)

    def test_rest_waits_for_what_is_still_to_happen(self):
        sets = ("time.end=0.3", "time.frame_rate=20", "time.until_rest=100 m/s", "pins=[{vertices: [0], release: 0.1}]")
        out, _ = self.said("run", "case.yaml", "--out", "held", *(w for s in sets for w in ("--set", s)))
        self.assertRegex(out, r"small: 0.15 s in \d+ steps")

    def test_ranks_are_those_of_mpirun(self):
        code, _, err = self.taut("run", "case.yaml", "--ranks", "4")
        self.assertEqual((code, err), (2, "taut: --ranks 4: not known here; ranks are what mpirun starts: mpirun -n 4 "
                                          "taut ..., of which taut info tells too"))

    def test_info_names_material_and_cost_of_contact(self):
        self.said("run", "case.yaml", "--out", "result", "--set", "contact={}", "--set", "cloth.fabric=denim", *SHORT)
        for path in ("result", "case.yaml"):
            out, _ = self.said("info", path)
            self.assertRegex(out, r"material +(denim, )?\S+ kg/m\^2, bending \S+ N m, shear \S+ N/m")
        out, _ = self.said("info", "result")
        self.assertIn("material    denim, ", out)
        self.assertRegex(out, r"cost .* contact \d+\.\d\d, output")

    def test_info_tells_what_a_case_will_cost(self):
        out, _ = self.said("info", "case.yaml", "--set", "cloth.grid.vertices=[9, 9]", "--set", "contact={}", *SHORT)
        self.assertIn(" 81 vertices, 64 cells, 144 constrained edges ", out)
        self.assertRegex(out, r"\n  cost        \d+ MB of memory; at least [1-9]\d* steps for 1 frame; a first "
                              r"step takes \S+ s: velocity \S+, projection \S+, contact \S+; later ones may")

    def test_untangling_tells_how_far_it_is(self):
        box = "obstacles=[{box: {min: [0.3, 0.3, -0.2], max: [0.7, 0.7, 0]}, " \
              "start: {rotate: {axis: [0, 0, 1], angle: 20 deg}, translate: [0, 0, 0.01]}}]"
        out, _ = self.said("check", "case.yaml", "--thorough", "--set", box, "--set", "contact.start=untangle")
        self.assertRegex(out, r"(?m)^small: untangling the start: \d+ intersections left after 5 rounds of at most 100")

    def test_partition_gives_a_verdict(self):
        self.assertIn("verdict: 30 vertices a rank are few", self.said("partition", "case.yaml", "--ranks", "4")[0])
        out, _ = self.said("partition", "case.yaml", "--ranks", "4", "--set", "cloth.grid.vertices=[120, 120]")
        self.assertIn("verdict: good; ", out)

    def test_help_of_a_command_has_examples_of_its_own(self):
        for command in ("run", "resume", "check", "info", "partition", "mesh", "export", "schema"):
            lines = self.said(command, "--help")[0].partition("Examples:\n")[2].splitlines()
            examples = [line for line in lines if " taut " in line or line.startswith("  taut")]
            self.assertTrue(examples, command)
            self.assertTrue(all(f"taut {command}" in line for line in examples if "PETSc" not in line), examples)

    def test_items_of_lists_in_brackets(self):
        self.said("run", "case.yaml", "--out", "result", "--set", "pins[0].vertices=[0, 5]", *SHORT)
        self.assertEqual(Run(self.folder / "result").case["pins"][0]["vertices"], [0, 5])

    def test_default_thickness_serves_irregular_meshes(self):
        """A tenth of the mean edge is more than half the shortest here."""
        self.write("irregular.obj", TRIANGLES)
        self.said("run", "case.yaml", "--out", "result", "--set", "cloth.mesh=irregular.obj", "--set",
                  "pins=[{vertices: [0]}]", "--set", "contact={}", *SHORT)

    def test_bending_of_weft_chooses_a_model_that_can(self):
        self.said("run", "case.yaml", "--out", "result", "--set", "cloth.material.bending_weft=1e-4", *SHORT)
        code, _, err = self.taut("check", "case.yaml", "--set", "cloth.line={length: 1, vertices: 11}", "--set",
                                 "cloth.material.bending_weft=1e-4")
        self.assertEqual(code, 2)
        self.assertIn("bending_weft", err)

    def test_a_start_moves_an_obstacle(self):
        """As the same body given where the start brings it, whatever it is made of."""
        self.write("body.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n")
        self.write("there.obj", "v 0.2 0.3 -0.1\nv 0.2 1.3 -0.1\nv -0.8 0.3 -0.1\nf 1 2 3\n")
        start = "start: {rotate: {axis: [0, 0, 1], angle: 90 deg}, translate: [0.2, 0.3, -0.1]}"
        for k, (given, meant) in enumerate((
                ("mesh: body.obj", "mesh: there.obj"),
                ("sphere: {centre: [0.1, 0, -0.1], radius: 0.1}", "sphere: {centre: [0.2, 0.4, -0.2], radius: 0.1}"),
                ("plane: {point: [0, 0, 0.05], normal: [1, 0, 2]}",
                 "plane: {point: [0.2, 0.3, -0.05], normal: [0, 1, 2]}"))):
            ends = []
            for name, body in ((f"moved{k}", f"{given}, {start}"), (f"meant{k}", meant)):
                motion = "motion: [{time: 0}, {time: 0.1, translate: [0, 0, 0.02]}]"
                self.said("run", "case.yaml", "--out", name, "--set", f"obstacles=[{{{body}, {motion}}}]", "--set",
                          "cloth.start.translate=[0, 0, 0.6]", *SHORT)
                ends.append(Run(self.folder / name).frames[-1])
            for field in ("obstacles/positions", "positions"):
                moved, expected = (np.sort(end[field], axis=0) for end in ends)
                np.testing.assert_allclose(moved, expected, atol=1e-9, err_msg=given)

    def test_files_of_other_programs(self):
        """Vertices without faces are dropped with a warning; polygons of an obstacle are cut into triangles."""
        self.write("cloth.obj", "v 5 5 5\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 2 3 4 5\ncurv2 1\ncurv2 2\n")
        self.write("body.obj", "v 0 0 -1\nv 1 0 -1\nv 2 1 -1\nv 1 2 -1\nv 0 1 -1\nf 1 2 3 4 5\n")
        _, err = self.said("run", "case.yaml", "--out", "result", "--set", "cloth.mesh=cloth.obj", "--set",
                           "pins=[{vertices: [0]}]", "--set", "obstacles=[{mesh: body.obj}]", *SHORT, ranks=2)
        self.assertEqual(err.splitlines(), [
            "taut: warning: cloth.obj:1: 1 vertex belongs to no face and no line, this the first, and is left out; "
            "vertices are numbered without",
            "taut: warning: cloth.obj:7: 'curv2' begins no line that is known here; 2 such lines were left out"])
        self.assertEqual(Run(self.folder / "result").summary["vertices"], 4)

    def test_counters_in_the_folder_of_the_run(self):
        self.said("run", "case.yaml", "--out", "result", "--counters", "result/counters.json", *SHORT)
        self.assertTrue((self.folder / "result/counters.json").exists())


class ScriptRun(running.Folder):
    """scripts/run, from any folder."""

    def run_script(self, *words):
        done = running.script("run", *words, *SHORT, cwd=self.folder,
                              env={**launch.ENVIRONMENT, "TAUT": str(launch.PROGRAM), "RANKS": "1"})
        return done.returncode, done.stderr

    def test_results_beside_the_name(self):
        text = running.SMALL.replace("name: small\n", "")
        (self.folder / "first.yaml").write_text(text)
        (self.folder / "mine").mkdir()
        (self.folder / "mine/case.yaml").write_text(text)
        for words, name in ((["case.yaml"], "small"), (["first.yaml"], "first"), (["mine"], "mine"),
                            (["mine/case.yaml"], "mine")):
            self.assertEqual(self.run_script(*words), (0, ""), words)
            self.assertTrue(Run(self.folder / "out" / name).completed, name)
            self.assertEqual(read_case(self.folder / "out" / name / "case.yaml")["name"], name)
        code, _, err = self.taut("run", "first.yaml", *SHORT)
        self.assertEqual(code, 2)
        self.assertIn("out/first: this folder holds a run already", err)  # both agree on the name

    def test_never_over_another_run(self):
        self.assertEqual(self.run_script("case.yaml"), (0, ""))
        (self.folder / "other.yaml").write_text(running.SMALL)
        before = os.stat(self.folder / "out/small/summary.json").st_mtime_ns
        code, err = self.run_script("other.yaml")
        self.assertEqual(code, 2)
        self.assertIn("out/small was not made by scripts/run of this case", err)
        self.assertEqual(os.stat(self.folder / "out/small/summary.json").st_mtime_ns, before)
        self.assertEqual(self.run_script("none.yaml")[0], 2)


if __name__ == "__main__":
    subprocess.run([launch.PROGRAM, "--version"], check=True, stdout=subprocess.DEVNULL)
    unittest.main()
