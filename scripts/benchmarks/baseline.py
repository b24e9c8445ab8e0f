"""The scene every newcomer tries, cases/two-pins, by Taut and by plain XPBD, one after the other."""
import json
import math
import subprocess

from benchmarks import refined

LIMIT = 0.01  # strain
ROUNDS = 6


def plain_xpbd(program, side, substeps, end):
    """The first run within the limit: strain falls about as substeps^-1.3, so the next try is where it should just be
    met."""
    for _ in range(ROUNDS):
        done = subprocess.run([program, str(side), str(substeps), str(end)], check=True, capture_output=True, text=True)
        found = json.loads(done.stdout)
        if found["strain"] <= LIMIT:
            return found
        substeps = math.ceil(substeps * min(16.0, max(1.05, (found["strain"] / LIMIT) ** 0.75)))
    raise SystemExit(f"bench: plain XPBD keeps no strain of {LIMIT:g} on {side} x {side} vertices with {substeps} "
                     f"substeps of 10 ms")


def report(program, run, sides, end):
    """`run(case, settings)` gives a run's summary. CPU seconds are those of the time steps."""
    print(f"two-pins until {end:g} s, one core, largest strain at most {100 * LIMIT:g} %")
    print(f"{'vertices':>9} {'method':<12} {'CPU s/s':>9} {'strain %':>9} {'depth m':>8}   ")
    for side in sides:
        summary = run(refined.CASE, [*refined.with_side(side), f"time.end={end}"])
        xpbd = plain_xpbd(program, side, 4 * side, end)
        taut = summary["seconds"]["cpu"] / end
        print(f"{side**2:>9} {'Taut':<12} {taut:>9.2f} {100 * summary['strain']['max']:>9.2f} {summary['depth']:>8.3f}")
        print(f"{side**2:>9} {'plain XPBD':<12} {xpbd['cpu_s_per_s']:>9.2f} {100 * xpbd['strain']:>9.2f} "
              f"{xpbd['depth']:>8.3f}   "
              f"{xpbd['cpu_s_per_s'] / taut:.1f} times the cost of Taut, {xpbd['substeps']} substeps of 10 ms",
              flush=True)
