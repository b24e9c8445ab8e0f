#include "src/garment/write_mesh.hpp"

#include "io/hdf5.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>

namespace taut::garment {

namespace {

/// A name as one word of an OBJ file.
std::string word(std::string name) {
  std::ranges::replace_if(
      name, [](unsigned char c) { return c <= ' ' || c == '#' || c == '\\'; }, '_');
  return name;
}

std::string obj_text(const GarmentMesh& mesh) {
  fmt::memory_buffer text;
  const auto out = std::back_inserter(text);
  for (const Vec3& p : mesh.positions) fmt::format_to(out, "v {} {} {}\n", p[0], p[1], p[2]);
  for (const Vec2& m : mesh.material) fmt::format_to(out, "vt {} {}\n", m[1], -m[0]);
  for (const MeshedPanel& panel : mesh.panels) {
    fmt::format_to(out, "g {}\n", word(panel.name));
    for (Global c = panel.first_cell; c < panel.first_cell + panel.cells; ++c) {
      text.push_back('f');
      for (int k = 0; k < mesh.cells[c].size(); ++k)
        fmt::format_to(out, " {0}/{0}", mesh.cells[c].vertices[k] + 1);
      text.push_back('\n');
    }
  }
  return {text.data(), text.size()};
}

/// Rank 0 gives all rows.
class RootWriter {
public:
  RootWriter(MPI_Comm comm, H5Writer& file) : comm_(comm), file_(file), root_(rank_of(comm) == 0) {}

  template<class T>
  void write(const std::string& name, const std::vector<T>& numbers, int columns) {
    Global rows = Global(numbers.size()) / columns;
    MPI_Bcast(&rows, 1, MPI_INT64_T, 0, comm_);
    const auto mine = root_ ? std::span<const T>(numbers) : std::span<const T>();
    file_.write<T>(name, mine, columns, {0, root_ ? rows : 0, rows});
  }

private:
  MPI_Comm comm_;
  H5Writer& file_;
  bool root_;
};

void write_corners(RootWriter& file, const std::string& name, std::span<const Cell> cells,
                   const std::vector<Corners2>& corners) {
  std::vector<double> numbers;
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (int k = 0; k < cells[c].size(); ++k)
      numbers.insert(numbers.end(), {corners[c][k][0], corners[c][k][1]});
  file.write(name, numbers, 2);
}

void write_cells(RootWriter& file, std::span<const Cell> cells, const GarmentMesh& mesh) {
  std::vector<Global> corners, offsets{0};
  std::vector<Corners2> texture;
  std::vector<std::int32_t> panel;
  for (const Cell& cell : cells) {
    corners.insert(corners.end(), cell.vertices.begin(), cell.vertices.begin() + cell.size());
    offsets.push_back(Global(corners.size()));
  }
  for (const Cell& cell : mesh.cells) texture.push_back(texture_of(mesh, cell));
  for (std::size_t p = 0; p < mesh.panels.size(); ++p)
    panel.insert(panel.end(), std::size_t(mesh.panels[p].cells), std::int32_t(p));
  file.write("/faces", corners, 1);
  file.write("/face_offsets", offsets, 1);
  write_corners(file, "/texture", cells, texture);
  file.write("/cells/panel", panel, 1);
}

void write_seam_pairs(RootWriter& file, const GarmentMesh& mesh) {
  std::vector<Global> pairs, offsets{0};
  for (const MeshedSeam& seam : mesh.seams) {
    for (const auto& [a, b] : seam.pairs) pairs.insert(pairs.end(), {a, b});
    offsets.push_back(Global(pairs.size() / 2));
  }
  file.write("/seams/pairs", pairs, 2);
  file.write("/seams/offsets", offsets, 1);
}

std::vector<std::string> names_of(const std::vector<NamedSeam>& seams) {
  std::vector<std::string> names;
  for (const NamedSeam& seam : seams) names.push_back(seam.name);
  return names;
}

void write_positions(RootWriter& file, const std::vector<Vec3>& positions) {
  std::vector<double> numbers;
  for (const Vec3& p : positions) numbers.insert(numbers.end(), p.begin(), p.end());
  file.write("/rest_positions", numbers, 3);
}

} // namespace

void write_obj(MPI_Comm comm, const GarmentMesh& mesh, const std::filesystem::path& path) {
  write_text_whole(comm, path, rank_of(comm) == 0 ? obj_text(mesh) : "");
}

void write_h5(MPI_Comm comm, const GarmentMesh& mesh, const std::filesystem::path& path) {
  write_whole(comm, path, [&](H5Writer& file) {
    RootWriter root(comm, file);
    write_positions(root, mesh.positions);
    write_cells(root, mesh.cells, mesh);
    write_seam_pairs(root, mesh);
    const NamedParts parts = share(comm, parts_of(mesh));
    write_panels(file, parts.panels);
    write_names(file, "seams", names_of(parts.seams));
    write_labels(comm, file, parts.labels);
  });
}

void write_h5(MPI_Comm comm, const GarmentMesh& mesh, const SewnMesh& sewn,
              const std::filesystem::path& path) {
  write_whole(comm, path, [&](H5Writer& file) {
    RootWriter root(comm, file);
    write_positions(root, sewn.positions);
    write_cells(root, sewn.cells, mesh);
    write_corners(root, "/rest_shape", sewn.cells, sewn.rest_shape);
    const NamedParts parts = share(comm, parts_of(mesh, sewn));
    write_panels(file, parts.panels);
    write_seams(comm, file, parts.seams);
    write_labels(comm, file, parts.labels);
  });
}

} // namespace taut::garment
