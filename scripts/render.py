"""Draws one frame of a run. Started by scripts/render, which brings a screen if there is none.

The surface is coloured by a field of the vertices or cells (frames.xdmf) or of the constraints (edges.xdmf); that of
the constraints is averaged at the vertices.
"""
import argparse
import math
import sys
from pathlib import Path

import numpy as np
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy

UNITS = {"tension": "N", "velocity": "m/s", "speed": "m/s"}  # every strain is a pure number, "-"
RANK_COLOURS = ["#4477aa", "#ee6677", "#228833", "#ccbb44", "#66ccee", "#aa3377", "#ee8866", "#999933"]
CLOTH = [0.42, 0.58, 0.76]
CLOTH_BACK = [0.85, 0.70, 0.52]
OBSTACLE = [0.78, 0.78, 0.76]
INK = [0.15, 0.15, 0.18]


def parse():
    parser = argparse.ArgumentParser(prog="scripts/render", description="Draws one frame of a run.")
    parser.add_argument("run_folder", type=Path)
    moment = parser.add_mutually_exclusive_group()
    moment.add_argument("--frame", default="last", help="number of the frame, or 'last' (default)")
    moment.add_argument("--time", type=float, help="s; the nearest frame is drawn")
    parser.add_argument("--color", help="field that colours the cloth: strain, tension, owner_rank, ...")
    parser.add_argument("--range", type=float, nargs=2, metavar=("LOW", "HIGH"), help="of the colours")
    parser.add_argument("--edges", action="store_true", help="draw the edges of the cells")
    parser.add_argument("--view", type=float, nargs=3, default=[0.45, -1.0, 0.5], metavar=("X", "Y", "Z"),
                        help="where the eye stands, seen from the cloth (default: %(default)s)")
    parser.add_argument("--output", type=Path, help="default: picture.png in the run's folder")
    parser.add_argument("--size", default="1200x900", help="WIDTHxHEIGHT in pixels (default: %(default)s)")
    options = parser.parse_args()
    try:
        options.size = [int(pixels) for pixels in options.size.split("x")]
        width, height = options.size
    except ValueError:
        parser.error("--size: write WIDTHxHEIGHT")
    return options


def open_xdmf(path):
    if not path.is_file():
        sys.exit(f"render: {path}: no such file; give the output folder of a run")
    reader = simple.XDMFReader(FileNames=[str(path.resolve())])  # ParaView finds the data only from absolute paths
    reader.UpdatePipelineInformation()
    return reader


def moment_of(reader, options):
    times = np.atleast_1d(reader.TimestepValues)
    if options.time is not None:
        return float(times[np.abs(times - options.time).argmin()])
    number = len(times) - 1 if options.frame == "last" else int(options.frame)
    if not 0 <= number < len(times):
        sys.exit(f"render: there is no frame {number}; the run has the frames 0 to {len(times) - 1}")
    return float(times[number])


def with_field(reader, options, time):
    """The source that holds the field, and whether the field is at "POINTS" or "CELLS"."""
    if options.color is None:
        return reader, None
    for kind, data in (("POINTS", reader.PointData), ("CELLS", reader.CellData)):
        if options.color in data.keys():
            return reader, kind
    edges = open_xdmf(options.run_folder / "edges.xdmf")
    edges.UpdatePipeline(time)
    if options.color not in edges.CellData.keys():
        known = sorted({*reader.PointData.keys(), *reader.CellData.keys(), *edges.CellData.keys()})
        sys.exit(f"render: there is no field {options.color}; known are {', '.join(known)}")
    at_vertices = simple.CellDatatoPointData(Input=edges)
    return simple.AppendAttributes(Input=[reader, at_vertices]), "POINTS"


def values_of(source, kind, name):
    data = servermanager.Fetch(source)
    array = (data.GetPointData() if kind == "POINTS" else data.GetCellData()).GetArray(name)
    values = vtk_to_numpy(array)
    return np.linalg.norm(values, axis=1) if values.ndim == 2 else values


def colour_by_number(lut, name, values, chosen):
    low, high = chosen or (float(values.min()), float(values.max()))
    if chosen is None and low < 0 < high:
        low, high = -max(-low, high), max(-low, high)
    if low == high:
        high = low + (abs(low) or 1.0) * 1e-3
    lut.ApplyPreset("Cool to Warm" if low == -high else "Viridis (matplotlib)", True)
    lut.RescaleTransferFunction(low, high)


def colour_by_rank(lut, values):
    ranks = [int(rank) for rank in np.unique(values)]
    lut.InterpretValuesAsCategories = 1
    lut.Annotations = [text for rank in ranks for text in (str(rank), str(rank))]
    colours = [RANK_COLOURS[rank % len(RANK_COLOURS)] for rank in ranks]
    lut.IndexedColors = [int(colour[i:i + 2], 16) / 255 for colour in colours for i in (1, 3, 5)]


def scaled(pixels, options):
    return round(pixels * options.size[1] / 900)


def bar_room(options):
    """The part of the picture's width that the colour bar and its text take."""
    return 0.18 * options.size[1] / options.size[0]


def dress(bar, name, options):
    unit = "-" if "strain" in name else UNITS.get(name)
    bar.Title = name.replace("_", " ") + (f" ({unit})" if unit else "")
    bar.ComponentTitle = ""
    bar.TitleColor = bar.LabelColor = INK
    bar.TitleFontSize, bar.LabelFontSize = scaled(20, options), scaled(18, options)
    bar.AutomaticLabelFormat = 0
    bar.LabelFormat = bar.RangeLabelFormat = "%-#.3g"
    bar.TextPosition = "Ticks left/bottom, annotations right/top" if name == "owner_rank" else \
        "Ticks right/top, annotations left/bottom"
    bar.WindowLocation = "Any Location"
    title_left = 0.25 * bar_room(options) if name == "owner_rank" else 0.0
    bar.Position = [1.0 - bar_room(options) + title_left, 0.25]
    bar.ScalarBarLength, bar.ScalarBarThickness = 0.5, scaled(20, options)


def colour(view, parts, source, kind, options):
    name = options.color
    values = values_of(source, kind, name)
    for part in parts:
        simple.ColorBy(part, (kind, name))
        part.InterpolateScalarsBeforeMapping = int(name != "owner_rank")  # between ranks 0 and 2 there is no rank 1
    lut = simple.GetColorTransferFunction(name)
    if name == "owner_rank":
        colour_by_rank(lut, values)
    else:
        colour_by_number(lut, name, values, options.range)
    dress(simple.GetScalarBar(lut, view), name, options)
    parts[0].SetScalarBarVisibility(view, True)


def show_plain(view, source, colour_of_all):
    shown = simple.Show(source, view)
    shown.SetRepresentationType("Surface")
    simple.ColorBy(shown, None)
    shown.DiffuseColor = shown.AmbientColor = colour_of_all
    return shown


def show_faces(view, source):
    smooth = simple.GenerateSurfaceNormals(Input=simple.ExtractSurface(Input=source), FeatureAngle=180.0, Splitting=0,
                                           Consistency=0)
    shown = show_plain(view, smooth, CLOTH)
    shown.BackfaceRepresentation = "Surface"
    shown.BackfaceDiffuseColor = shown.BackfaceAmbientColor = CLOTH_BACK
    shown.Specular, shown.SpecularPower = 0.12, 12.0
    shown.Ambient, shown.Diffuse, shown.Interpolation = 0.2, 0.9, "Gouraud"
    return shown


def show_lines(view, source):
    shown = show_plain(view, simple.ExtractSurface(Input=source), CLOTH)
    shown.Ambient, shown.Diffuse, shown.LineWidth = 1.0, 0.0, 2.0  # a line has no side that could be lit
    return shown


def show_obstacles(view, options):
    """The obstacles, if the run has any; planes fade into the background."""
    if not (options.run_folder / "obstacles.xdmf").is_file():
        return
    reader = open_xdmf(options.run_folder / "obstacles.xdmf")
    reader.UpdatePipeline(view.ViewTime)
    shown = show_plain(view, simple.GenerateSurfaceNormals(Input=simple.ExtractSurface(Input=reader)), OBSTACLE)
    shown.Ambient, shown.Diffuse, shown.Specular = 0.35, 0.75, 0.0


def show_cloth(view, source, options):
    """What is drawn of the source: its faces, its line cells, or both."""
    parts = []
    for show, types in ((show_faces, ["Triangle", "Quadrilateral"]), (show_lines, ["Line", "Polyline"])):
        cells = simple.ExtractCellsByType(Input=source, CellTypes=types)
        cells.UpdatePipeline(view.ViewTime)
        if cells.GetDataInformation().GetNumberOfCells() > 0:
            parts.append(show(view, cells))
    if options.edges:
        wires = show_plain(view, simple.ExtractSurface(Input=source), INK)
        wires.SetRepresentationType("Wireframe")
        wires.Ambient, wires.Diffuse, wires.Opacity, wires.LineWidth = 1.0, 0.0, 0.3, 1.0
    return parts


def aim(view, points, options):
    """The nearest place in the wanted direction from which all points are in the picture."""
    width, height = options.size
    bar = bar_room(options) if options.color else 0.0
    back = np.array(options.view) / np.linalg.norm(options.view)
    right = np.cross([0.0, 0.0, 1.0], back)
    right = right / np.linalg.norm(right) if right.any() else np.array([1.0, 0.0, 0.0])
    axes = np.stack([right, np.cross(back, right), back])
    centre = 0.5 * (points.min(axis=0) + points.max(axis=0))
    tangent = math.tan(math.radians(15.0))  # of half the angle of view, vertical
    limits = np.array([(0.94 - bar) * tangent * width / height, 0.90 * tangent])
    for _ in range(10):  # perspective moves the middle of the picture with the distance
        local = (points - centre) @ axes.T
        distance = float((local[:, 2:] + np.abs(local[:, :2]) / limits).max())
        seen = local[:, :2] / (distance - local[:, 2:])
        middle = 0.5 * (seen.min(axis=0) + seen.max(axis=0)) * distance
        centre = centre + middle @ axes[:2]
    centre = centre + bar * tangent * width / height * distance * axes[0]
    view.CameraViewAngle = 30.0
    view.CameraFocalPoint = list(centre)
    view.CameraPosition = list(centre + distance * back)
    view.CameraViewUp = list(axes[1])


def main():
    options = parse()
    reader = open_xdmf(options.run_folder / "frames.xdmf")
    time = moment_of(reader, options)
    reader.UpdatePipeline(time)
    view = simple.CreateRenderView()
    view.ViewSize = options.size
    view.UseColorPaletteForBackground = 0
    view.Background = [1.0, 1.0, 1.0]
    view.OrientationAxesVisibility = 0
    view.UseFXAA = 1
    view.KeyLightElevation, view.KeyLightAzimuth = 65.0, -20.0  # from above, so that folds show
    view.FillLightKFRatio = 2.0
    view.ViewTime = time
    source, kind = with_field(reader, options, time)
    source.UpdatePipeline(time)
    parts = show_cloth(view, source, options)
    show_obstacles(view, options)
    if kind:
        colour(view, parts, source, kind, options)
    text = simple.Show(simple.Text(Text=f"t = {time:.3f} s"), view)
    text.Color, text.FontSize, text.WindowLocation = INK, scaled(20, options), "Lower Left Corner"
    aim(view, vtk_to_numpy(servermanager.Fetch(reader).GetPoints().GetData()).astype(float), options)
    output = options.output or options.run_folder / "picture.png"
    simple.SaveScreenshot(str(output), view, ImageResolution=options.size)
    print(output)


main()
