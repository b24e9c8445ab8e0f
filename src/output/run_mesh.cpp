#include "src/output/run_mesh.hpp"

#include "src/output/h5_field.hpp"
#include "src/output/xdmf_descriptions.hpp"

namespace taut {

namespace {

/// The cells of this rank's slab as HDF5's lists of vertices.
struct CellLists {
  std::vector<Global> vertices, offsets{0};
};

CellLists cells_in_order(const DistributedMesh& mesh) {
  std::vector<std::array<Global, 4>> owned;
  for (const Local c : mesh.owned_cells) {
    auto& cell = owned.emplace_back(std::array<Global, 4>{-1, -1, -1, -1});
    for (int k = 0; k < mesh.cells[c].size(); ++k)
      cell[k] = mesh.vertices.original[mesh.cells[c].vertices[k]];
  }
  CellLists lists;
  for (const auto& cell : mesh.cell_order.to_slab<std::array<Global, 4>>(owned)) {
    for (const Global v : cell)
      if (v >= 0) lists.vertices.push_back(v);
    lists.offsets.push_back(Global(lists.vertices.size()));
  }
  return lists;
}

/// Rows of a list whose lengths differ from rank to rank.
Slab rows_of(MPI_Comm comm, std::size_t count) {
  return {exclusive_sum(comm, Global(count)), Global(count), sum_over(comm, Global(count))};
}

void write_corners(H5Writer& file, const DistributedMesh& mesh, const std::string& name,
                   const std::vector<Corners2>& corners) {
  struct Row {
    Corners2 at;
    double size;
  };
  std::vector<Row> owned;
  for (const Local c : mesh.owned_cells) owned.push_back({corners[c], double(mesh.cells[c].size())});
  std::vector<double> numbers;
  for (const Row& row : mesh.cell_order.to_slab<Row>(owned))
    for (int k = 0; k < int(row.size); ++k) numbers.insert(numbers.end(), {row.at[k][0], row.at[k][1]});
  file.write<double>(name, numbers, 2, rows_of(mesh.comm, numbers.size() / 2));
}

void write_cells(H5Writer& file, const DistributedMesh& mesh) {
  const CellLists cells = cells_in_order(mesh);
  const Slab corners = rows_of(mesh.comm, cells.vertices.size());
  std::vector<Global> offsets(cells.offsets.begin(), cells.offsets.end() - 1);
  const bool last = rank_of(mesh.comm) == size_of(mesh.comm) - 1;
  if (last) offsets.push_back(cells.offsets.back());
  for (Global& o : offsets) o += corners.first;
  file.write<Global>("/faces", cells.vertices, 1, corners);
  file.write<Global>("/face_offsets", offsets, 1, rows_of(mesh.comm, offsets.size()));
  file.attribute("faces", mesh.cell_order.slab().total);
  if (!mesh.texture.empty()) write_corners(file, mesh, "/texture", mesh.texture);
  if (!mesh.rest_shape.empty()) write_corners(file, mesh, "/rest_shape", mesh.rest_shape);
  if (shape_of(mesh) != XdmfCells::mixed) return;
  const auto numbers = xdmf_mixed_cells(cells.vertices, cells.offsets);
  file.write<Global>("/xdmf_cells", numbers, 1, rows_of(mesh.comm, numbers.size()));
}

void write_edges(H5Writer& file, const Cloth& cloth) {
  const DistributedMesh& mesh = cloth.mesh;
  const Slab edges = mesh.edge_order.slab();
  std::vector<std::array<Global, 2>> ends;
  for (Local e = 0; e < mesh.edges.owned; ++e)
    ends.push_back(
        {mesh.vertices.original[mesh.edge_vertices[e][0]], mesh.vertices.original[mesh.edge_vertices[e][1]]});
  ends = mesh.edge_order.to_slab<std::array<Global, 2>>(ends);
  file.write<Global>("/constraints/edges", {reinterpret_cast<const Global*>(ends.data()), 2 * ends.size()}, 2,
                     edges);
  file.write<double>("/constraints/rest_lengths", mesh.edge_order.to_slab<double>(cloth.rest_length), 1,
                     edges);
}

/// Of a garment: whoever begins with it finds its labels again.
void write_names(H5Writer& file, const Cloth& cloth) {
  const garment::NamedParts parts = parts_of(cloth);
  if (!parts.panels.empty()) garment::write_panels(file, parts.panels);
  if (!parts.seams.empty()) garment::write_seams(cloth.mesh.comm, file, parts.seams);
  if (!parts.labels.empty()) garment::write_labels(cloth.mesh.comm, file, parts.labels);
}

} // namespace

void write_run_mesh(const std::filesystem::path& file, const Cloth& cloth, std::span<const FrameField> fields,
                    const ObstacleFrames& obstacles, const State& state) {
  const DistributedMesh& mesh = cloth.mesh;
  write_whole(mesh.comm, file, [&](H5Writer& out) {
    out.write("/rest_positions", mesh.vertex_order.to_slab<Vec3>(mesh.rest_positions),
              mesh.vertex_order.slab());
    write_cells(out, mesh);
    write_edges(out, cloth);
    for (const FrameField& field : fields)
      if (field.home == FieldHome::shared_mesh) write_field(out, mesh, field, state);
    write_names(out, cloth);
    if (!obstacles.empty()) obstacles.write_once(out);
  });
}

} // namespace taut
