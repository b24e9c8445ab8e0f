"""Draws a run: a picture of one frame, a film of all, or a state that ParaView opens. Started by scripts/render, which
brings a screen if there is none.

The surface is coloured by a field of the vertices or cells (frames.xdmf) or of the constraints (edges.xdmf); that of
the constraints is averaged at the vertices.
"""
import argparse
import os
import sys
from pathlib import Path

from rendering.film import CODECS, make_film
from rendering.scene import Scene


def size(text):
    try:
        width, height = (int(pixels) for pixels in text.split("x"))
    except ValueError:
        raise argparse.ArgumentTypeError("write WIDTHxHEIGHT") from None
    if width < 1 or height < 1:
        raise argparse.ArgumentTypeError("a picture has at least one pixel each way")
    return [width, height]


def film(text):
    path = Path(text)
    if path.suffix not in CODECS:
        raise argparse.ArgumentTypeError(f"a film ends in {', '.join(CODECS)}")
    return path.absolute()


def parse():
    parser = argparse.ArgumentParser(prog="scripts/render",
                                     description="Draws a run: a picture, unless a film or a state is asked for.")
    parser.add_argument("run_folder", type=Path)
    moment = parser.add_mutually_exclusive_group()
    moment.add_argument("--frame", default="last", help="number of the frame, or 'last' (default)")
    moment.add_argument("--time", type=float, help="s; the nearest frame is drawn")
    parser.add_argument("--color", help="field that colours the cloth: strain, tension, rank, ...")
    parser.add_argument("--range", type=float, nargs=2, metavar=("LOW", "HIGH"), help="of the colours")
    parser.add_argument("--edges", action="store_true", help="draw the edges of the cells")
    parser.add_argument("--view", type=float, nargs=3, default=[0.45, -1.0, 0.5], metavar=("X", "Y", "Z"),
                        help="where the eye stands, seen from the cloth (default: %(default)s)")
    parser.add_argument("--size", type=size, default=[1200, 900], help="WIDTHxHEIGHT in pixels (default: 1200x900)")
    parser.add_argument("--output", type=Path, help="the picture (default: picture.png in the run's folder)")
    parser.add_argument("--film", type=film, help=f"all frames, one after the other: a file {', '.join(CODECS)}")
    parser.add_argument("--speed", type=float, default=1.0,
                        help="of the film; 0.25 is slow motion (default: %(default)s)")
    parser.add_argument("--state", action="store_true",
                        help="write run.pvsm into the run's folder; open it there: cd RUN_FOLDER && paraview run.pvsm")
    options = parser.parse_args()
    if not any(options.view):
        parser.error("--view: the eye must stand somewhere else than the cloth")
    if not options.speed > 0:
        parser.error("--speed: write a number > 0")
    return options


def moment_of(times, options):
    """The number of the frame to be drawn."""
    if options.time is not None:
        return min(range(len(times)), key=lambda k: abs(times[k] - options.time))
    last = len(times) - 1
    try:
        number = last if options.frame == "last" else int(options.frame)
    except ValueError:
        number = -1
    if not 0 <= number <= last:
        sys.exit(f"render: there is no frame {options.frame}; the run has the frames 0 to {last}")
    return number


def main():
    options = parse()
    folder = options.run_folder
    picture = (options.output or folder / "picture.png").absolute()
    if not folder.is_dir():
        sys.exit(f"render: {folder}: no such folder; give the output folder of a run")
    os.chdir(folder)
    many = options.film or options.state
    scene = Scene(options, lambda times: times if many else [times[moment_of(times, options)]])
    if options.film:
        make_film(scene, options.film, options.speed)
        print(options.film)
    if options.state:
        scene.save_state("run.pvsm")
        print(f"{folder}/run.pvsm: open it with  cd {folder} && paraview run.pvsm")
    if options.output or not many:
        scene.draw(scene.times[moment_of(scene.times, options) if many else 0], picture)
        print(picture)


main()
