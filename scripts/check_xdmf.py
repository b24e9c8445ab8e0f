#!/usr/bin/env python3
"""Opens a run in ParaView as a user would and compares what ParaView shows with what the HDF5 files hold.

    scripts/check_xdmf.py RUN_FOLDER

For every time step of frames.xdmf and edges.xdmf: the time, the positions, the cells and every field, number by
number. Needs ParaView's Python (pvpython) and starts it itself. Exit code 1 and a message at the first difference.
"""
import os
import sys
from pathlib import Path

try:
    from paraview import servermanager, simple
except ImportError:  # an ordinary Python: start again in ParaView's
    if "TAUT_IN_PVPYTHON" in os.environ:
        sys.exit("check_xdmf: pvpython cannot load ParaView; install python3-paraview")
    os.environ["TAUT_IN_PVPYTHON"] = "1"
    try:
        os.execvp("pvpython", ["pvpython", *sys.argv])
    except FileNotFoundError:
        sys.exit("check_xdmf: pvpython is not installed; install paraview and python3-paraview")

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy

import taut
from taut.run import uniform_grids


class Difference(Exception):
    """ParaView does not show what the files hold."""


def require_equal(what, shown, held):
    shown, held = np.asarray(shown), np.asarray(held)
    if shown.shape != held.shape:
        raise Difference(f"{what}: ParaView shows the shape {shown.shape}, the file holds {held.shape}")
    different = shown != held
    if different.any():
        at = tuple(int(i) for i in np.argwhere(different)[0])
        raise Difference(f"{what}: {int(different.sum())} numbers differ; at {at} ParaView shows {shown[at]}, "
                         f"the file holds {held[at]}")


class Run(taut.Run):
    """The HDF5 files of a run, read without XDMF."""

    def read(self, file, dataset):
        held = taut.Datasets(self.folder / file)
        if dataset not in held:
            raise Difference(f"{file}: no dataset {dataset}")
        return held[dataset]

    def require_source(self, name, frame, file, dataset):
        """The XDMF takes a field from this frame or the mesh, and not from a neighbour of the dataset it should."""
        if file not in ("mesh.h5", str(frame.path.relative_to(self.folder))):
            raise Difference(f"field {name}: it is taken from {file} instead of {frame.path.name}")
        namesakes = ["/" + path for path in taut.Datasets(self.folder / file).read_all() if Path(path).name == name]
        if namesakes and dataset not in namesakes:
            raise Difference(f"field {name}: it is taken from {dataset} instead of {namesakes[0]}")

    def cells(self, xdmf_name):
        """Vertex numbers of all cells, one after the other, and where each begins."""
        if xdmf_name == "edges.xdmf":
            edges = self.read("mesh.h5", "/constraints/edges")
            return edges.ravel(), 2 * np.arange(len(edges) + 1)
        return self.read("mesh.h5", "/faces"), self.read("mesh.h5", "/face_offsets")


def fields_of(xdmf_path):
    """Per frame: a list of (name, "Node" or "Cell", file, dataset), as the XDMF text names them."""
    return [[(field.get("Name"), field.get("Center"), *field.find("DataItem").text.strip().split(":"))
             for field in grid.findall("Attribute")] for grid in uniform_grids(xdmf_path)]


def check_frame(run, xdmf_name, shown, frame, fields):
    require_equal("positions", vtk_to_numpy(shown.GetPoints().GetData()),
                  frame.positions)
    vertices, offsets = run.cells(xdmf_name)
    require_equal("cell offsets", vtk_to_numpy(shown.GetCells().GetOffsetsArray()), offsets)
    require_equal("cell vertices", vtk_to_numpy(shown.GetCells().GetConnectivityArray()), vertices)
    for name, centre, file, dataset in fields:
        run.require_source(name, frame, file, dataset)
        data = shown.GetPointData() if centre == "Node" else shown.GetCellData()
        array = data.GetArray(name)
        if array is None:
            raise Difference(f"field {name}: ParaView does not show it")
        require_equal(f"field {name}", vtk_to_numpy(array), run.read(file, dataset))


def check(run, xdmf_name):
    path = (run.folder / xdmf_name).resolve()  # ParaView finds the HDF5 files only from an absolute path
    reader = simple.XDMFReader(FileNames=[str(path)])
    reader.UpdatePipelineInformation()
    times = list(reader.TimestepValues) if hasattr(reader.TimestepValues, "__len__") else [reader.TimestepValues]
    require_equal(f"{xdmf_name}: times", times, [frame.time for frame in run.frames])
    for time, frame, fields in zip(times, run.frames, fields_of(path), strict=True):
        reader.UpdatePipeline(time)
        shown = servermanager.Fetch(reader)
        try:
            check_frame(run, xdmf_name, shown, frame, fields)
        except Difference as difference:
            raise Difference(f"{xdmf_name} at time {time}: {difference}") from None
        names = ", ".join(name for name, *_ in fields)
        print(f"{xdmf_name} at time {time:g}: {shown.GetNumberOfPoints()} positions, "
              f"{shown.GetNumberOfCells()} cells and {names or 'no fields'} equal {frame.path.name}")
    simple.Delete(reader)


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__)
    folder = Path(sys.argv[1])
    try:
        run = Run(folder)
        if not run.frames:
            raise Difference(f"{folder}/frames: no frames")
        for xdmf_name in ("frames.xdmf", "edges.xdmf"):
            if not (folder / xdmf_name).is_file():
                raise Difference(f"{folder / xdmf_name}: no such file")
            check(run, xdmf_name)
    except Difference as difference:
        sys.exit(f"check_xdmf: {difference}")


main()
