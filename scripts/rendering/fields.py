"""Where a field of a run is found, and its values."""
import json
import sys
from pathlib import Path

import h5py
import numpy as np
from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy

ALIASES = {"rank": "owner_rank"}


def open_xdmf(folder, name):
    """By its bare name: the working folder is that of the run, and a state file then holds no path that could go
    stale."""
    if not Path(name).is_file():
        sys.exit(f"render: {folder / name}: no such file; give the output folder of a run")
    reader = simple.XDMFReader(registrationName=name, FileNames=[name])
    reader.UpdatePipelineInformation()
    return reader


def times_of(reader):
    return [float(time) for time in np.atleast_1d(reader.TimestepValues)]


def points_of(reader, time):
    reader.UpdatePipeline(time)
    return vtk_to_numpy(servermanager.Fetch(reader).GetPoints().GetData()).astype(float)


class Field:
    """A field by its name, on a source that has it at its "POINTS" or "CELLS": the cloth, or its edges."""

    def __init__(self, cloth, folder, name, time):
        self.name = ALIASES.get(name, name)
        cloth.UpdatePipeline(time)
        for kind, data in (("POINTS", cloth.PointData), ("CELLS", cloth.CellData)):
            if self.name in data.keys():
                self.source, self.kind, self.is_of_edges = cloth, kind, False
                return
        edges = open_xdmf(folder, "edges.xdmf")
        edges.UpdatePipeline(time)
        if self.name not in edges.CellData.keys():
            known = sorted({*cloth.PointData.keys(), *cloth.CellData.keys(), *edges.CellData.keys()})
            sys.exit(f"render: there is no field {self.name}; known are {', '.join(known)}")
        self.source, self.kind, self.is_of_edges = edges, "CELLS", True

    def names(self):
        """{number: name} of what its values are numbers of."""
        with h5py.File("mesh.h5", "r") as mesh:
            names = json.loads(mesh.attrs.get(f"{self.name}s", "[]"))
        return dict(enumerate(names))

    def values(self, time):
        """One number each: of a vector its length."""
        self.source.UpdatePipeline(time)
        data = servermanager.Fetch(self.source)
        values = vtk_to_numpy((data.GetPointData()
                               if self.kind == "POINTS" else data.GetCellData()).GetArray(self.name))
        return np.linalg.norm(values, axis=1) if values.ndim == 2 else values
