"""python3 -m taut OUT: what a run holds for Python, the fields of its frames and the columns of its steps."""
import argparse
import sys

from taut.run import Run, RunError


def lines(run):
    yield f"{run.folder}: {run.status}, {len(run.frames)} frames"
    for title, datasets in (("mesh", run.mesh), ("frames[-1]", run.frames[-1] if run.frames else None)):
        for name, field in (datasets.fields if datasets else {}).items():
            yield f"  run.{title}[\"{name}\"]  {' x '.join(map(str, field.shape))}  {field.unit}".rstrip()
    yield f"  run.steps[...] of {len(run.read_steps()[1])} steps: {', '.join(run.steps)}"


def main():
    parser = argparse.ArgumentParser(prog="python3 -m taut", description=__doc__)
    parser.add_argument("run_folder")
    try:
        print("\n".join(lines(Run(parser.parse_args().run_folder))))
    except (RunError, OSError) as error:
        sys.exit(f"taut: {error}")


if __name__ == "__main__":
    main()
