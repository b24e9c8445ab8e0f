#!/usr/bin/env python3
"""The pages of all folders say what is there: links, files, commands, options, keys, cases."""
import json
import re
import shlex
import subprocess
import unittest
from functools import cache

import yaml

import running
from taut import launch

ROOT = launch.ROOT
LISTED = subprocess.run(["git", "-C", ROOT, "ls-files", "-co", "--exclude-standard", "*.md"], capture_output=True,
                        text=True, check=False).stdout.split()
PAGES = [ROOT / name for name in LISTED if (ROOT / name).exists() and name != "CHANGELOG.md"]
DIALECT = r"\b(dearer|mended|goes? with every|does not go with)\b"
ROOMS = ("src/", "io/", "partition/", "tests/", "scripts/", "cases/", ".ci/")
COMMAND = re.compile(r"(?:mpirun (?:-\S+(?: \d+)? )*)?(build/taut|taut|scripts/[\w.-]+)(?= |$)(.*)")


def blocks(text):
    """(language, lines) of each block of code, fenced or indented."""
    for found in re.finditer(r"^```(\w*)\n(.*?)^```", text, re.M | re.S):
        yield found[1], found[2].replace("\\\n", "").splitlines()
    outside = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    for found in re.finditer(r"(?:^|\n\n)((?:    [^\n]*\n)+)", outside):
        yield "", [line[4:] for line in found[1].splitlines()]


def commands(text):
    """What a page tells to type: (program, words)."""
    lines = [line for language, block in blocks(text) if language in ("", "sh") for line in block]
    prose = re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)
    lines += [code.replace("\n", " ") for code in re.findall(r"`((?:build/|scripts/|taut |mpirun )[^`]*)`", prose)]
    for line in lines:
        for part in re.split(r" && |^\$ ", re.sub(r"(^|\s)#.*", "", line)):
            if found := COMMAND.fullmatch(part.strip()):
                words = shlex.split(found[2])
                program = found[1]
                if "build/taut" in words:  # scripts/hosts 3 2 build/taut run ...
                    yield program, []
                    program, words = "taut", words[words.index("build/taut") + 1:]
                yield program, words


@cache
def help_of(*words):
    answer = subprocess.run([launch.PROGRAM, *words, "--help"], capture_output=True, text=True, check=False)
    return answer.stdout if answer.returncode == 0 else None


@cache
def keys():
    table = subprocess.run([launch.PROGRAM, "schema", "--table"], capture_output=True, text=True, check=True).stdout
    return set(re.findall(r"^\| `([^`]+)`", table, re.M))


@cache
def source_of(script):
    """The text of a script and of the modules of scripts/, where its options may stand."""
    return (ROOT / script).read_text() + "".join(path.read_text() for path in (ROOT / "scripts").rglob("*.py"))


def anchors(page):
    """As GitHub makes them of headings."""
    titles = re.findall(r"^#+ (.*)$", re.sub(r"^```.*?^```", "", page.read_text(), flags=re.M | re.S), re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


class Pages(running.Folder):
    def each(self):
        return [(page, page.read_text()) for page in PAGES]

    def test_there_are_pages(self):
        self.assertGreater(len(PAGES), 30)
        self.assertLess((ROOT / "README.md").stat().st_size, 10_000)
        for room in ("src", "io", "partition", "cases", "tests", "scripts", *(f"src/{name}" for name in (
                "config", "command", "contact", "constraints", "filters", "forces", "garment", "linear", "newton",
                "time"))):
            self.assertTrue((ROOT / room / "README.md").exists(), room)

    def test_lines_and_words(self):
        for page, text in self.each():
            for number, line in enumerate(text.splitlines(), 1):
                if not line.startswith("|") or page == ROOT / "README.md":
                    self.assertLessEqual(len(line), 120, f"{page}:{number}")
                self.assertIsNone(re.search(DIALECT, line), f"{page}:{number}: {line}")

    def test_links(self):
        for page, text in self.each():
            for link in re.findall(r"\]\(([^)\s]+)\)", re.sub(r"^```.*?^```", "", text, flags=re.M | re.S)):
                if re.match(r"https?:", link):
                    continue
                path, _, anchor = link.partition("#")
                target = (page.parent / path) if path else page
                self.assertTrue(target.exists(), f"{page}: {link}")
                if anchor:
                    self.assertIn(anchor, anchors(target), f"{page}: {link}")

    def test_files_that_are_named(self):
        for page, text in self.each():
            for name in re.findall(r"`([\w./-]+)`", text):
                if name.startswith(ROOMS):
                    self.assertTrue((ROOT / name).exists() or (page.parent / name).exists(), f"{page}: {name}")

    def test_commands(self):
        found = 0
        for page, text in self.each():
            for program, words in commands(text):
                found += 1
                place = f"{page.relative_to(ROOT)}: {program} {shlex.join(words)}"
                if program.startswith("scripts/"):
                    self.check_script(program, words, place)
                else:
                    self.check_program(words, place)
        self.assertGreater(found, 80)

    def check_script(self, script, words, place):
        if not words and (ROOT / script).is_dir():
            return
        self.assertTrue((ROOT / script).is_file(), place)
        if script in ("scripts/run", "scripts/check-case") and words and re.fullmatch("[a-z-]+", words[0]):
            if not words[0].startswith("-"):
                self.assertTrue((ROOT / "cases" / words[0] / "case.yaml").exists(), place)
        for key in [word for word in words if re.match(r"--[a-z]", word) and word != "--set"]:
            if script not in ("scripts/test", "scripts/run", "scripts/slurm.sh"):
                self.assertIn(key.partition("=")[0], source_of(script), place)
        self.check_settings(words, place)

    def check_program(self, words, place):
        if not words or words[0].startswith("-"):
            return
        text = help_of(words[0])
        self.assertIsNotNone(text, place)
        for word in words[:words.index("--")] if "--" in words else words:
            if word.startswith("--"):
                self.assertRegex(text, rf"(?m)^\s+(-\w,)?{re.escape(word.partition('=')[0])}\b", place)
            if word.startswith("cases/"):
                self.assertTrue((ROOT / word).exists(), place)
        self.check_settings(words, place)

    def check_settings(self, words, place):
        for option, setting in zip(words, words[1:]):
            if option == "--set" and "=" in setting:
                key = re.sub(r"\[\d+\]|\.\d+(?=\.|$)", "[]", setting.partition("=")[0])
                self.assertIn(re.sub(r"^cloths\[\]\.", "cloth.", key), keys(), place)

    def test_cases(self):
        """Every block of YAML that holds a case, or a part of one, is one that `taut check` takes."""
        found = 0
        for page, text in self.each():
            for case in [yaml.safe_load("\n".join(lines).replace("{…}", "{}")) for language, lines in blocks(text)
                         if language == "yaml"]:
                if not {key.partition(".")[0] for key in keys()} >= set(case):
                    continue  # of other programs
                found += 1
                self.check_case(case, page)
        self.assertGreater(found, 5)

    def check_case(self, case, page):
        if not {"cloth", "cloths"} & set(case):  # beside a cloth, out of the way of bodies
            case["cloth"] = {"grid": {"size": [0.3, 0.3], "vertices": [4, 4]}, "start": {"translate": [0, 3, 3]}}
        (self.folder / "denim.obj").write_bytes((ROOT / "cases/skirt/start.obj").read_bytes())
        body = (ROOT / "cases/body-sequence/body/body_0001.obj").read_text()
        within = re.sub(r"^v (\S+) (\S+)", lambda v: f"v {v[1]} {float(v[2]) + 1.2}", body, flags=re.M)  # the shirt
        (self.folder / "body.obj").write_text(within)
        pattern = json.loads((ROOT / "cases/shirt/shirt.json").read_text())
        next(iter(pattern["pattern"]["panels"].values()))["edges"][0]["label"] = "lower_interface"
        (self.folder / "shirt.json").write_text(json.dumps(pattern))
        path = self.folder / "snippet.yaml"
        path.write_text(yaml.safe_dump(case, allow_unicode=True))
        answer = subprocess.run([launch.PROGRAM, "check", path], capture_output=True, text=True, check=False)
        self.assertEqual(answer.returncode, 0, f"{page.relative_to(ROOT)}: {answer.stderr}")


if __name__ == "__main__":
    unittest.main()
