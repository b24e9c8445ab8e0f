"""Every case with contact, whole, with an exact test for intersections after every step."""
import csv
import json
import os
import pathlib
import subprocess
import tempfile

COLUMNS = ["case", "vertices", "ranks", "steps (rejected)", "strain", "intersections", "projections a step", "finding contacts"]


def rows_of(command, sets):
    """The summary and the steps of one run, also of one that found an intersection; None if it did not get so far."""
    with tempfile.TemporaryDirectory() as folder:
        words = [*command, "--out", folder + "/out", "--progress", "lines"]
        for setting in ["contact.check=step", *sets]:
            words += ["--set", setting]
        subprocess.run(words, check=False, stdout=subprocess.DEVNULL, env=dict(os.environ, OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1"))
        summary = pathlib.Path(folder, "out", "summary.json")
        if not summary.exists():
            return None, []
        with open(folder + "/out/steps.csv", newline="") as file:
            return json.loads(summary.read_text()), list(csv.DictReader(file))


def report(command, cases, ranks, sets, print_row):
    """`command(case, ranks)` is the start of a command line."""
    print_row(COLUMNS)
    print_row(["---"] * len(COLUMNS))
    for case in cases:
        for number in ranks:
            s, steps = rows_of(command(case, number), sets)
            if s is None or s["status"] != "completed":
                print_row([case, "", number, "failed", "", "", "", ""])
                continue
            total = sum(float(step[key]) for step in steps for key in ("velocity_s", "projection_s", "contact_s"))
            share = sum(float(step["contact_s"]) for step in steps) / total
            print_row([case, s["vertices"], number, f"{s['steps']} ({s['rejected_steps']})", f"{100 * s['strain']['max']:.2f} %",
                       s["contact"]["intersections"], f"{s['projection']['iterations_mean']:.2f}", f"{100 * share:.0f} %"])
