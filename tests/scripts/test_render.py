#!/usr/bin/env python3
"""scripts/render on small runs: what is in its pictures, its film and its state."""
import ast
import os
import subprocess
import sys
import unittest

import matplotlib.image
import numpy as np

import running
from taut import launch

SIZE = (400, 300)
# A belt that is as wide as an edge, between two panels: each side of its cells across joins two seams.
BELTED = """\
panels:
  above: {translation: [0, 0.12, 0], vertices: &wide [[0, 0], [0.5, 0], [0.5, 0.1], [0, 0.1]], edges: &edges [
    {endpoints: [0, 1]}, {endpoints: [1, 2]}, {endpoints: [2, 3]}, {endpoints: [3, 0]}]}
  belt: {translation: [0, 0.05, 0], vertices: [[0, 0], [0.5, 0], [0.5, 0.05], [0, 0.05]], edges: *edges}
  below: {translation: [0, -0.07, 0], vertices: *wide, edges: *edges}
stitches:
  - [{panel: above, edge: 0}, {panel: belt, edge: 2}]
  - [{panel: belt, edge: 0}, {panel: below, edge: 2}]
"""
BELTED_CASE = """\
cloth: {pattern: belted.yaml, edge: 5 cm, fabric: cotton}
gravity: [0, 0, 0]
time: {end: 0.02, frame_rate: 50}
"""
RANK_0, RANK_1 = (0x44, 0x77, 0xaa), (0xee, 0x66, 0x77)


def render(*arguments):
    environment = {key: value for key, value in os.environ.items()
                   if key != "DISPLAY"}  # as on a machine without a screen
    done = running.script("render", *arguments, "--size", "{}x{}".format(*SIZE), env=environment, timeout=150)
    return done.returncode, done.stdout, done.stderr


def image_of(path):
    return matplotlib.image.imread(path)[:, :, :3]


def drawn(image):
    """What is not background, without the corner in which the time stands."""
    mask = np.abs(image - 1.0).max(axis=2) > 0.05
    mask[-SIZE[1] // 10:, :SIZE[0] // 3] = False
    return mask


def hue_near(image, colour):
    """Pixels of a colour, whatever light falls on them."""
    wanted = np.array(colour) / np.linalg.norm(colour)
    length = np.linalg.norm(image, axis=2, keepdims=True)
    return int(((image / np.maximum(length, 1e-6)) @ wanted > 0.995).sum())


def imported(path):
    """The top packages that a script imports."""
    for node in ast.walk(ast.parse(path.read_text())):
        if isinstance(node, ast.Import):
            yield from (name.name.partition(".")[0] for name in node.names)
        elif isinstance(node, ast.ImportFrom):
            yield (node.module or "").partition(".")[0]


class Packages(unittest.TestCase):
    def test_what_pictures_import_is_installed(self):
        scripts = launch.ROOT / "scripts"
        paths = [scripts / "render.py", *(scripts / "rendering").glob("*.py"), *(scripts / "taut").glob("*.py")]
        used = {name for path in paths for name in imported(path)}
        outside = used - set(sys.stdlib_module_names) - {"paraview", "rendering", "taut", "vtkmodules"}
        self.assertIn("h5py", outside)
        listed = subprocess.run(["bash", "-c", 'source "$0"; echo "${pvpython_packages[@]}"', scripts / "packages.sh"],
                                capture_output=True, text=True, check=True).stdout.split()
        self.assertEqual(sorted(listed), sorted(f"python3-{name}" for name in outside))


class Render(running.Folder):
    def picture(self, run, *options):
        path = self.folder / "picture.png"
        code, out, err = render(run, "--output", path, *options)
        self.assertEqual((code, out.strip().splitlines()[-1]), (0, str(path)), err)
        self.assertNotIn("WARN", err)
        image = image_of(path)
        self.assertEqual(image.shape, (SIZE[1], SIZE[0], 3))
        return image

    def test_the_cloth_is_in_the_picture(self):
        run = self.run_case("result")
        image = self.picture(run)
        mask = drawn(image)
        self.assertGreater(mask.mean(), 0.05)
        rows, columns = np.nonzero(mask)
        self.assertGreater(max(np.ptp(rows) / SIZE[1], np.ptp(columns) / SIZE[0]), 0.8)  # it fills the picture
        self.assertEqual(mask[:5].sum() + mask[-5:].sum() + mask[:, :5].sum() + mask[:, -5:].sum(), 0)  # and is whole
        earlier = drawn(self.picture(run, "--time", "0.1"))
        self.assertGreater((earlier != mask).mean(), 0.02)
        np.testing.assert_array_equal(drawn(self.picture(run, "--frame", "2")), earlier)

    def test_fields_colour_it(self):
        run = self.run_case("result", "--set", "time.end=0.2", ranks=2)
        plain = self.picture(run)
        ranks = self.picture(run, "--color", "rank")
        self.assertGreater(hue_near(ranks, RANK_1), 100 + 10 * hue_near(plain, RANK_1))
        self.assertGreater(hue_near(ranks, RANK_0), 100)
        strain, tension = (self.picture(run, "--color", field) for field in ("strain", "tension"))
        for coloured in (strain, tension):
            both = drawn(plain) & drawn(coloured)
            self.assertGreater((np.abs(plain - coloured).max(axis=2)[both] > 0.1).mean(), 0.05)
        self.assertTrue((strain != tension).any())  # at least in the bar: tension is nearly proportional to strain here

    def test_a_sphere_is_round(self):
        """Its two halves meet without an edge."""
        run = self.run_case("result", "--set", "time.end=0.05", "--set",
                            "obstacles=[{sphere: {centre: [0.5, 0.5, -0.25], radius: 0.2}}]")
        image = self.picture(run, "--view", "0", "-1", "0.1")
        rows, columns = np.nonzero(drawn(image) & (np.ptp(image, axis=2) < 0.06))  # grey, unlike the cloth
        middle = (columns == int(np.median(columns)))
        shade = image[np.sort(rows[middle])[3:-3], int(np.median(columns))]
        self.assertGreater(len(shade), 40)
        self.assertLess(np.abs(np.diff(shade, axis=0)).max(), 0.015)  # 0.008; 0.024 with an edge

    def test_seams_are_lines_along_them(self):
        """And nothing is drawn from one to the next, nor when ParaView opens the state."""
        (self.folder / "belted.yaml").write_text(BELTED)
        (self.folder / "case.yaml").write_text(BELTED_CASE)
        code, _, err = self.taut("run", "case.yaml", "--out", "belted", ranks=2)
        self.assertEqual(code, 0, err)
        run = self.folder / "belted"
        for image in (self.picture(run, "--state", "--view", "0", "-1", "0"), self.opened(run)):
            inked = (drawn(image) & (image.max(axis=2) < 0.3)).mean(axis=1)
            lines = np.nonzero(inked > 0.5)[0]
            self.assertEqual(np.count_nonzero(np.diff(lines) > 1), 3)  # both sides of two seams, not sewn
            self.assertLess(np.delete(inked, lines).max(), 0.01)

    def test_film_and_state(self):
        run = self.run_case("result", "--set", "time.end=0.3")
        code, _, err = render(run, "--film", self.folder / "film.mp4", "--state", "--color", "strain")
        self.assertEqual(code, 0, err)
        told = subprocess.run(["ffprobe", "-v", "error", "-count_frames", "-of", "csv=p=0", "-show_entries",
                               "stream=nb_read_frames,r_frame_rate", self.folder / "film.mp4"],
                              capture_output=True, text=True, check=True).stdout.strip()
        self.assertEqual(told, f"20/1,{len(running.listed_frames(run))}")
        self.assertFalse((run / "picture.png").exists())
        state = (run / "run.pvsm").read_text()
        self.assertIn('value="frames.xdmf"', state)
        self.assertNotIn(str(self.folder), state)  # the folder may go elsewhere
        moved = run.rename(self.folder / "moved")
        self.assertGreater(drawn(self.opened(moved)).mean(), 0.05)

    def opened(self, run):
        """What ParaView shows when it opens the state in the folder of the run."""
        script = self.folder / "open.py"
        script.write_text("from paraview import simple\nsimple.LoadState('run.pvsm')\n"
                          f"simple.SaveScreenshot('shown.png', simple.GetActiveView(), ImageResolution={list(SIZE)})\n")
        done = running.script("with-screen", "pvpython", script, cwd=run, timeout=120)
        self.assertEqual(done.returncode, 0, done.stderr)
        return image_of(run / "shown.png")

    def test_says_what_is_wrong(self):
        run = self.run_case("result", "--set", "time.end=0.1")
        for arguments, code, message in (
                ((self.folder,), 1,
                 f"render: {self.folder}/frames.xdmf: no such file; give the output folder of a run"),
                ((self.folder / "nowhere",), 1, f"render: {self.folder}/nowhere: no such folder; give the output "
                                                f"folder of a run"),
                ((run, "--color", "colour"), 1, "render: there is no field colour; known are "),
                ((run, "--frame", "99"), 1, "render: there is no frame 99; the run has the frames 0 to 2"),
                ((run, "--film", "film.xyz"), 2, "a film ends in .mp4, .webm, .gif")):
            found, _, err = render(*arguments)
            self.assertEqual(found, code, err)
            self.assertIn(message, err)
            self.assertNotIn("screen was lost", err)


if __name__ == "__main__":
    unittest.main()
