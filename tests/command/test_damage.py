#!/usr/bin/env python3
"""Files of a run that change after they were written: the damage is named, and never taken for the result.

--repeat is how often a random file is damaged (default 6): a bit of it is turned over, or a page of it is zeroed.
"""
import argparse
import random
import shutil
import unittest
import zlib

import h5py

from running import Folder, frame, listed_frames
from taut import Datasets, RunError

OPTIONS = argparse.Namespace(repeat=6, seed=None)
PAGE = 4096
CHECKPOINTS = ("--set", "checkpoint.every_steps=43")  # those of steps 86 and 100 are kept


def flip_bit(file, chance):
    data = bytearray(file.read_bytes())
    data[chance.randrange(len(data))] ^= 1 << chance.randrange(8)
    file.write_bytes(data)


def zero_page(file, chance):
    data = bytearray(file.read_bytes())
    first = PAGE * chance.randrange(len(data) // PAGE + 1)
    size = len(data[first:first + PAGE])
    if not any(data[first:first + size]):
        return flip_bit(file, chance)  # it was empty already
    data[first:first + size] = bytes(size)
    file.write_bytes(data)


def change_and_sign(file, change):
    """Another file in the place of a sound one: its checksum is right, what is in it is not."""
    with h5py.File(file, "r+") as data:
        change(data)
    body = file.read_bytes()
    file.write_bytes(body + f"\ntaut crc32 {zlib.crc32(body):08x}\n".encode())


class Damage(Folder):
    def setUp(self):
        super().setUp()
        self.whole = self.run_case("whole", *CHECKPOINTS)
        self.count = 0

    def copy(self):
        self.count += 1
        return shutil.copytree(self.whole, self.folder / f"run-{self.count}")

    def resume(self, run, ranks=1):
        return self.taut("resume", run.name, "--set", "time.end=0.55", ranks=ranks, limit=30)

    def test_at_random_places(self):
        seed = OPTIONS.seed if OPTIONS.seed is not None else random.randrange(10**6)
        chance = random.Random(seed)
        expected = {}
        for ranks in (1, 3):
            expected[ranks] = self.copy()
            self.assertEqual(self.resume(expected[ranks], ranks)[0], 0)
        for turn in range(OPTIONS.repeat):
            with self.subTest(seed=seed, turn=turn):
                self.damage_and_resume(expected, chance, (1, 3)[turn % 2])
        print(f"damaged {OPTIONS.repeat} files (seed {seed})")

    def damage_and_resume(self, expected, chance, ranks):
        run = self.copy()
        file = chance.choice([run / "checkpoint/step_000000100.h5", run / "mesh.h5",
                              *(run / "frames").glob("*.h5")])
        chance.choice((flip_bit, zero_page))(file, chance)
        name = str(file.relative_to(self.folder))
        code, _, err = self.taut("check", run.name, ranks=ranks)
        self.assertEqual(code, 2, name)
        self.assertIn(f"taut: {name}: ", err)
        code, out, err = self.resume(run, ranks)
        self.assertEqual(code, 0, name)
        self.assertIn(f"{name}: ", err)
        if file.parent.name == "checkpoint":
            self.assertIn("after step 86", out)
        self.assert_as_expected(run, expected[ranks], file)
        shutil.rmtree(run)

    def assert_as_expected(self, run, whole, damaged):
        """To the bit where the same checkpoint was taken; a damaged frame is not listed."""
        listed = [name for name, _ in listed_frames(run)]
        names = [name for name, _ in listed_frames(whole) if run / name != damaged]
        self.assertEqual(listed, names)
        if damaged.parent.name != "checkpoint":
            for name in names:
                self.assertEqual((run / name).read_bytes(), (whole / name).read_bytes(), name)
        else:
            self.assert_readable(run)

    def test_no_sound_checkpoint_ends_with_2(self):
        for ranks in (1, 3):
            run = self.copy()
            for step in (86, 100):
                flip_bit(run / f"checkpoint/step_{step:09}.h5", random.Random(step))
            code, _, err = self.resume(run, ranks)
            self.assertEqual(code, 2, err)
            self.assertIn("step_000000100.h5: ", err)
            self.assertIn("step_000000086.h5: ", err.splitlines()[-1])
            self.assertFalse((run / "lock").exists())

    def test_values_are_those_of_the_case(self):
        """Pinned vertices are where their pins have them, even in a file whose checksum is right."""
        def move_pinned_vertex(data):
            data["positions"][0, 2] += 0.01

        run = self.copy()
        change_and_sign(run / "checkpoint/step_000000100.h5", move_pinned_vertex)
        code, out, err = self.resume(run)
        self.assertEqual(code, 0, err)
        self.assertIn("step_000000100.h5: pins.0: at 0.5 s vertex 0 is 0.01 m away from where its pin has it", err)
        self.assertIn("after step 86", out)

    def test_scripts_refuse_a_damaged_frame(self):
        run = self.copy()
        self.assertIn("positions", frame(run, "frames/frame_000003.h5"))
        flip_bit(run / "frames/frame_000003.h5", random.Random(1))
        with self.assertRaisesRegex(RunError, "frame_000003.h5: damaged"):
            Datasets(run / "frames/frame_000003.h5").read_all()


if __name__ == "__main__":
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--repeat", type=int, default=6, help="random damages (default: 6)")
    parser.add_argument("--seed", type=int, help="of the damages (default: another each time, told at the end)")
    OPTIONS, others = parser.parse_known_args()
    unittest.main(argv=[__file__, *others])
