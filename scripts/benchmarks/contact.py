"""Every case with contact, whole, with an exact test for intersections after every step."""
import subprocess


def cell(run, case, ranks, sets):
    try:
        s, _ = run(case, ranks, ["contact.check=step", *sets])
    except subprocess.CalledProcessError as error:
        return f"failed: exit code {error.returncode}"
    return (f"{s['steps']} ({s['rejected_steps']}); {100 * s['strain']['max']:.2f} %; {s['contact']['intersections']}; "
            f"{s['projection']['iterations_mean']:.1f}")


def report(run, cases, ranks, sets, print_row):
    """`run(case, ranks, sets)` is one run's summary and CPU seconds."""
    print("Of each run: steps (rejected); largest strain; intersections; projections a step.\n")
    print_row(["case", *(f"{number} rank{'s' if number > 1 else ''}" for number in ranks)])
    print_row(["---"] * (1 + len(ranks)))
    for case in cases:
        print_row([case, *(cell(run, case, number, sets) for number in ranks)])
