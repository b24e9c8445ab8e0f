"""What a step is made of, beside what the memory gives at the same moment, and the projection by one linear solver
after another."""
import json
import subprocess

SOLVES = {"solve_yarn": "CG, yarns", "solve_icc": "CG, ICC(0)", "solve_boomeramg": "CG, BoomerAMG",
          "solve_cholmod": "CHOLMOD", "solve_mumps": "MUMPS"}


def measured(program, side):
    """{name: result}, the fastest of three rounds in random order: what else runs on the machine only adds."""
    done = subprocess.run([program, str(side), "--benchmark_format=json", "--benchmark_repetitions=3",
                           "--benchmark_min_time=0.1", "--benchmark_enable_random_interleaving=true"],
                          check=True, capture_output=True, text=True)
    best: dict[str, dict] = {}
    for result in json.loads(done.stdout)["benchmarks"]:
        if result.get("error_occurred"):
            raise SystemExit(f"bench: {result['name']}: {result['error_message']}")
        if result["run_type"] == "iteration":
            name = result["run_name"].split("/")[0]
            if name not in best or result["cpu_time"] < best[name]["cpu_time"]:
                best[name] = result
    return best


def report(program, side):
    results = measured(program, side)
    peak = results["bandwidth"]["bytes_per_second"]
    print(f"{side} x {side} vertices, {2 * side * (side - 1)} constraints, one core; "
          f"memory gives {peak / 1e9:.1f} GB/s")
    print(f"{'kernel':<22} {'CPU ms':>9} {'ns/vertex':>10} {'GB/s':>7} {'of memory':>10}")
    for name, result in results.items():
        if name in SOLVES or name == "bandwidth":
            continue
        rate = result.get("bytes_per_second")
        print(f"{name:<22} {result['cpu_time']:>9.3f} {1e6 * result['cpu_time'] / side**2:>10.1f} " +
              (f"{rate / 1e9:>7.1f} {100 * rate / peak:>9.0f}%" if rate else f"{'':>7} {'':>10}"))
    yarn = results["solve_yarn"]["cpu_time"]
    print(f"{'projection to 1e-6':<22} {'CPU ms':>9} {'iterations':>10} {'times yarns':>18}")
    for name, label in SOLVES.items():
        print(f"{label:<22} {results[name]['cpu_time']:>9.2f} {results[name]['iterations_of_solver']:>10.0f} "
              f"{results[name]['cpu_time'] / yarn:>18.2f}")
