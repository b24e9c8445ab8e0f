#include "src/output/xdmf_descriptions.hpp"

#include "src/output/h5_field.hpp"

#include <algorithm>

namespace taut {

XdmfCells shape_of(const DistributedMesh& mesh) {
  Global smallest = 4, largest = 2;
  for (const LocalCell& c : mesh.cells) {
    smallest = std::min<Global>(smallest, c.size());
    largest = std::max<Global>(largest, c.size());
  }
  smallest = -max_over(mesh.comm, -smallest);
  largest = max_over(mesh.comm, largest);
  if (smallest != largest) return XdmfCells::mixed;
  return largest == 2 ? XdmfCells::lines : largest == 3 ? XdmfCells::triangles : XdmfCells::quads;
}

XdmfDescription describe_cells(const DistributedMesh& mesh, std::span<const FrameField> fields) {
  XdmfDescription d;
  d.points = mesh.vertices.total;
  d.shape = shape_of(mesh);
  d.cells = mesh.total_cells;
  d.cells_dataset = d.shape == XdmfCells::mixed ? "/xdmf_cells" : "/faces";
  Global length = 0;
  for (const Local c : mesh.owned_cells) {
    const int corners = mesh.cells[c].size();
    length += corners;
    if (d.shape == XdmfCells::mixed) length += corners == 2 ? 2 : 1; // as in xdmf_mixed_cells
  }
  d.cells_length = sum_over(mesh.comm, length);
  for (const FrameField& f : fields)
    if (f.centre != FieldCentre::edge) d.fields.push_back(describe(f));
  return d;
}

XdmfDescription describe_edges(const DistributedMesh& mesh, std::span<const FrameField> fields) {
  XdmfDescription d;
  d.points = mesh.vertices.total;
  d.shape = XdmfCells::lines;
  d.cells = mesh.edges.total;
  d.cells_length = 2 * mesh.edges.total;
  d.cells_dataset = "/constraints/edges";
  for (const FrameField& f : fields)
    if (f.centre == FieldCentre::edge) d.fields.push_back(describe(f));
  return d;
}

} // namespace taut
