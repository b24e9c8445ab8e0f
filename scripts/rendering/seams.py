"""Where the seams of a garment are."""
import h5py
import numpy as np

# A state that ParaView opens holds the filter that draws them with all it needs.
DRAW = """
from vtkmodules.vtkCommonDataModel import vtkCellArray
lines = vtkCellArray()
for side in {sides}:
    lines.InsertNextCell(2, side)
cloth, seams = self.GetInputDataObject(0, 0), self.GetOutputDataObject(0)
seams.SetPoints(cloth.GetPoints())
seams.SetLines(lines)
seams.GetPointData().ShallowCopy(cloth.GetPointData())
"""


def sides_of(mesh):
    """(m, 2): the sides of all cells, each once, its lower vertex first."""
    faces, offsets = mesh["faces"][:], mesh["face_offsets"][:]
    after = np.arange(1, len(faces) + 1)
    after[offsets[1:] - 1] = offsets[:-1]  # the last corner of a cell is followed by its first
    return np.unique(np.sort(np.stack([faces, faces[after]], axis=1), axis=1), axis=0)


def sides_on_seams(path):
    """(m, 2): those sides of cells whose ends are both on one seam; a vertex may be on several."""
    with h5py.File(path, "r") as mesh:
        offsets, vertices = mesh["seams/offsets"][:], mesh["seams/vertices"][:]
        sides, is_on_any = sides_of(mesh), mesh["seams/of_vertices"][:] >= 0
    sides = sides[is_on_any[sides].all(axis=1)]
    is_seam = np.zeros(len(sides), bool)
    for first, last in zip(offsets[:-1], offsets[1:]):
        is_seam |= np.isin(sides, vertices[first:last]).all(axis=1)
    return sides[is_seam]


def seam_script(path):
    """What a filter of ParaView does to make lines of them."""
    return DRAW.format(sides=sides_on_seams(path).tolist())
