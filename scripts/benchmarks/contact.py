"""Every case with contact, whole, with an exact test for intersections after every step."""
import subprocess

COLUMNS = ["case", "vertices", "ranks", "steps (rejected)", "strain", "intersections", "projections a step", "finding contacts"]


def row(s):
    return [s["vertices"], s["ranks"], f"{s['steps']} ({s['rejected_steps']})", f"{100 * s['strain']['max']:.2f} %",
            s["contact"]["intersections"], f"{s['projection']['iterations_mean']:.2f}", f"{100 * s['contact_share']:.0f} %"]


def report(run, cases, ranks, sets, print_row):
    """`run(case, ranks, sets)` is one run's summary and CPU seconds."""
    print_row(COLUMNS)
    print_row(["---"] * len(COLUMNS))
    for case in cases:
        for number in ranks:
            try:
                summary, _ = run(case, number, ["contact.check=step", *sets])
                print_row([case, *row(summary)])
            except subprocess.CalledProcessError as error:
                print_row([case, "", number, f"failed: exit code {error.returncode}", "", "", "", ""])
