"""The four ways in which SHAKE fails [G07 section 4.1], by the cases of tests/filters/test_constrained, and how often
it does so on a drape: attempts rejected and the steps it comes down to, next to the other methods."""
import json
import subprocess

from studies import scenes
from taut.launch import ENVIRONMENT

TOYS = ["Q1NoSolution", "Q2SingularThoughThereAreSolutions", "Q3DependentGradients", "Q4RedundantConstraints"]
METHODS: dict[str, dict] = {
    "shake": {}, "shake lagged": {"shake": {"matrix": "lagged"}}, "icd": {}, "fast_projection": {}}
ABOUT = "SHAKE fails in four cases (Q1-Q4); ICD solves Q1, Q2 and Q4 as they are, and Q3 in half the step."
KEYS = ["case", "method", "max_step_s"]


def plan(quick):
    toys = [dict(zip(KEYS, (toy, "shake and icd", 0.01))) for toy in TOYS]
    side, steps = (11, [0.02, 0.01]) if quick else (31, [0.02, 0.01, 0.005, 0.0025])
    return toys + [dict(zip(KEYS, (f"drape {side}", method, step))) for step in steps for method in METHODS]


def measure(laboratory, point):
    if point["case"] in TOYS:
        return measure_toy(laboratory, point["case"])
    method = point["method"]
    run = laboratory.run(scenes.drape(int(point["case"].split()[1]), 0.5, point["max_step_s"], method=method.split()[0],
                                      strain=0.01,
                                      **METHODS[method]))
    return run.measures()


def measure_toy(laboratory, name):
    report = laboratory.path(name + ".json")
    subprocess.run([laboratory.beside("tests/test_constrained"), f"--gtest_filter=ShakeFailure.{name}"],
                   stdout=subprocess.DEVNULL,
                   env={**ENVIRONMENT, "GTEST_OUTPUT": f"json:{report}"}, check=False)
    test = json.loads(report.read_text())["testsuites"][0]["testsuite"][0]
    return {"status": "as in the paper" if "failures" not in test else "otherwise",
            **{name: test[name].split(";")[0] for name in ("shake", "icd")}}


def drapes(rows):
    return [row for row in rows if row["case"] not in TOYS]


def share(row):
    return row["rejected"] / (row["rejected"] + row["steps"])


def draw(axes, rows):
    for method in METHODS:
        found = sorted((row["max_step_s"], 100 * share(row)) for row in drapes(rows) if row["method"] == method and
                       row.get("steps"))
        axes.semilogx([1000 * x for x, _ in found], [y for _, y in found], "o-", label=method)
    axes.set_xlabel("longest time step, ms")
    axes.set_ylabel("steps rejected, %")
    axes.legend()


def judge(rows):
    toys = [row for row in rows if row["case"] in TOYS]
    lines = [f"{row['case']}: {row['status']}; shake: {row['shake']}; icd: {row['icd']}" for row in toys]
    lines += [f"{row['case']}, {row['method']}, steps up to {1000 * row['max_step_s']:g} ms: {row['status']}, "
              f"{row['steps']:g} steps, "
              f"{row['rejected']:g} rejected" for row in drapes(rows) if row.get("steps")]
    return all(row["status"] == "as in the paper" for row in toys), "\n".join(lines)
