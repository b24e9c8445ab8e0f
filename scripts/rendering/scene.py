"""A run in ParaView: what is drawn of it, and from where it is seen."""
import math
import os

import numpy as np
from paraview import simple
from vtkmodules.vtkCommonCore import vtkLogger

from rendering.colours import INK, UNNAMED, bar_room, colour, scaled
from rendering.fields import Field, open_xdmf, points_of, times_of
from rendering.seams import seam_script

vtkLogger.SetStderrVerbosity(vtkLogger.VERBOSITY_WARNING)  # some filters tell what they do
CLOTH = [0.42, 0.58, 0.76]
CLOTH_BACK = [0.85, 0.70, 0.52]
OBSTACLE = [0.78, 0.78, 0.76]
MOST_POINTS = 20000  # of a frame that are looked at to find the place of the eye


def make_view(options):
    view = simple.CreateRenderView()
    view.ViewSize = options.size
    view.UseColorPaletteForBackground = 0
    view.Background = [1.0, 1.0, 1.0]
    view.OrientationAxesVisibility = 0
    view.UseFXAA = 1
    view.KeyLightElevation, view.KeyLightAzimuth = 45.0, -40.0  # from the side, so that folds show
    view.FillLightKFRatio, view.BackLightKBRatio, view.HeadLightKHRatio = 3.0, 5.0, 4.0
    return view


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


def show_seams(view, source, width):
    """The seams of a garment, as lines on it."""
    seams = simple.ProgrammableFilter(Input=source, OutputDataSetType="vtkPolyData", Script=seam_script("mesh.h5"))
    shown = show_plain(view, seams, INK)
    shown.Ambient, shown.Diffuse, shown.LineWidth = 1.0, 0.0, width
    shown.RenderLinesAsTubes = 1  # so that half of a line is not in the cloth
    return shown


def show_cloth(view, source, options):
    """What is drawn of the source: its faces, its line cells, or both."""
    parts = []
    for show, types in ((show_faces, ["Triangle", "Quadrilateral"]), (show_lines, ["Line", "Polyline"])):
        cells = simple.ExtractCellsByType(Input=source, CellTypes=types)
        cells.UpdatePipeline(view.ViewTime)
        if cells.GetDataInformation().GetNumberOfCells() > 0:
            parts.append(show(view, cells))
        else:
            simple.Delete(cells)
    if options.edges:
        wires = show_plain(view, simple.ExtractSurface(Input=source), INK)
        wires.SetRepresentationType("Wireframe")
        wires.Ambient, wires.Diffuse, wires.Opacity, wires.LineWidth = 1.0, 0.0, 0.3, 1.0
    return parts


def show_obstacles(view, options):
    """The obstacles, if the run has any; planes fade into the background."""
    if not os.path.isfile("obstacles.xdmf"):
        return
    reader = open_xdmf(options.run_folder, "obstacles.xdmf")
    reader.UpdatePipeline(view.ViewTime)
    # spheres and capsules are two halves, whose common ring would show as an edge
    whole = simple.Clean(Input=simple.ExtractSurface(Input=reader), Tolerance=1e-6, ConvertPolysToLines=0)
    shown = show_plain(view, simple.GenerateSurfaceNormals(Input=whole), OBSTACLE)
    shown.Ambient, shown.Diffuse, shown.Specular = 0.35, 0.75, 0.0


def aim(view, points, options):
    """The nearest place in the wanted direction from which all points are in the picture."""
    width, height = options.size
    bar = bar_room(options) if options.color and options.color != UNNAMED else 0.0
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


class Scene:
    """All of the run that is drawn at `times`: the eye and the colours stay the same from one to the next."""

    def __init__(self, options, choose):
        """`choose` picks the times of all frames that are wanted."""
        cloth = open_xdmf(options.run_folder, "frames.xdmf")
        self.times = choose(times_of(cloth))
        self.options, self.view = options, make_view(options)
        self.view.ViewTime = self.times[-1]
        field = Field(cloth, options.run_folder, options.color, self.times[-1]) if options.color else None
        parts = show_cloth(self.view, cloth, options)
        if field and field.is_of_edges:
            parts = [show_lines(self.view, field.source)]
        if "seam" in cloth.PointData.keys():
            is_wanted = options.color == "seam"
            seams = show_seams(self.view, cloth, scaled(6.0 if is_wanted else 1.5, options))
            parts = [seams] if is_wanted else parts
        show_obstacles(self.view, options)
        if field:
            colour(self.view, parts, field, self.times, options)
        clock = simple.Show(simple.AnnotateTimeFilter(Input=cloth, Format="t = {time:.3f} s"), self.view)
        clock.Color, clock.FontSize, clock.WindowLocation = INK, scaled(20, options), "Lower Left Corner"
        points = [points_of(cloth, time) for time in self.times]
        aim(self.view, np.concatenate([p[::len(p) // MOST_POINTS + 1] for p in points]), options)

    def draw(self, time, path):
        self.view.ViewTime = time
        simple.SaveScreenshot(str(path), self.view, ImageResolution=self.options.size)

    def save_state(self, path):
        scene = simple.GetAnimationScene()
        scene.UpdateAnimationUsingDataTimeSteps()
        scene.AnimationTime = self.times[-1]
        simple.SaveState(str(path))
