#include "io/mesh_file.hpp"

#include "io/hdf5.hpp"
#include "io/obj.hpp"
#include "partition/comm.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <span>
#include <string>

namespace taut {
namespace {

namespace fs = std::filesystem;
using Complaint = std::optional<std::string>;

const std::string positions_name = "/rest_positions", faces_name = "/faces", offsets_name = "/face_offsets",
                  texture_name = "/texture", rest_shape_name = "/rest_shape";

Global rows_of_list(MPI_Comm comm, const H5Reader& file, const std::string& name) {
  const int columns = file.columns(name);
  agree(comm, columns == 1 ? Complaint()
                           : fmt::format("{}: {} has {} columns; give it one dimension", file.path().string(),
                                         name, columns));
  return file.rows(name);
}

/// Checked before the offsets are used: they say what to read of `/faces`.
Complaint check_offsets(std::span<const Global> offsets, Slab cells, Global corners) {
  if (cells.first == 0 && offsets.front() != 0) return "it does not begin with 0";
  if (cells.first + cells.count == cells.total && offsets.back() != corners)
    return fmt::format("it ends with {}, but {} has {} numbers", offsets.back(), faces_name, corners);
  for (const Global offset : offsets)
    if (offset < 0 || offset > corners)
      return fmt::format("it holds {}, but {} has {} numbers", offset, faces_name, corners);
  for (Global c = 0; c < cells.count; ++c)
    if (const Global size = offsets[c + 1] - offsets[c]; size < 2 || size > 4)
      return fmt::format("cell {} has {} vertices instead of 2, 3 or 4", cells.first + c, size);
  return std::nullopt;
}

/// `used` are the vertices of the cell as the file has them, so that a negative one is not taken for an
/// unused place.
Complaint check_cell(std::span<const Global> used, Global number, Global vertices) {
  for (auto v = used.begin(); v != used.end(); ++v) {
    if (*v < 0 || *v >= vertices)
      return fmt::format("cell {} names vertex {}, but vertices go from 0 to {}", number, *v, vertices - 1);
    if (std::find(v + 1, used.end(), *v) != used.end())
      return fmt::format("cell {} names vertex {} twice", number, *v);
  }
  return std::nullopt;
}

class MeshReader {
public:
  MeshReader(MPI_Comm comm, const fs::path& path) : comm_(comm), file_(comm, path) {}

  MeshSlab read(double scale) {
    MeshSlab mesh;
    mesh.name = file_.path().string();
    read_vertices(mesh, scale);
    read_cells(mesh);
    for (Corners2& corners : mesh.rest_shape)
      for (Vec2& corner : corners) corner *= scale;
    return mesh;
  }

private:
  void agree_on(const std::string& dataset, const Complaint& complaint) const {
    agree(comm_, complaint ? fmt::format("{}: {}: {}; correct the dataset", file_.path().string(), dataset,
                                         *complaint)
                           : Complaint());
  }

  Slab my_slab(Global total) const { return slab_of(total, size_of(comm_), rank_of(comm_)); }

  void read_vertices(MeshSlab& mesh, double scale) const {
    mesh.vertices = my_slab(file_.rows(positions_name));
    agree_on(positions_name, mesh.vertices.total > 0 ? Complaint() : "no vertices");
    mesh.rest_positions = file_.read_vectors(positions_name, mesh.vertices);
    const auto bad = std::ranges::find_if(mesh.rest_positions, [](const Vec3& x) { return !x.allFinite(); });
    agree_on(positions_name, bad == mesh.rest_positions.end()
                                 ? Complaint()
                                 : fmt::format("vertex {} is not finite",
                                               mesh.vertices.first + (bad - mesh.rest_positions.begin())));
    for (Vec3& x : mesh.rest_positions) x *= scale;
  }

  void read_cells(MeshSlab& mesh) const {
    const Global rows = rows_of_list(comm_, file_, offsets_name),
                 corners = rows_of_list(comm_, file_, faces_name);
    agree_on(offsets_name, rows > 1 ? Complaint() : "no faces or lines");
    mesh.cells = my_slab(rows - 1);
    // One offset more than cells: where the last cell ends.
    const auto offsets = file_.read<Global>(offsets_name, {mesh.cells.first, mesh.cells.count + 1, rows});
    agree_on(offsets_name, check_offsets(offsets, mesh.cells, corners));
    const auto faces =
        file_.read<Global>(faces_name, {offsets.front(), offsets.back() - offsets.front(), corners});
    Complaint complaint;
    mesh.cell.resize(mesh.cells.count);
    for (Global c = 0; c < mesh.cells.count; ++c) {
      const auto used = std::span(faces).subspan(offsets[c] - offsets[0], offsets[c + 1] - offsets[c]);
      std::ranges::copy(used, mesh.cell[c].vertices.begin());
      if (!complaint) complaint = check_cell(used, mesh.cells.first + c, mesh.vertices.total);
    }
    agree_on(faces_name, complaint);
    if (file_.has(texture_name)) mesh.texture = read_corners(texture_name, offsets, corners);
    if (file_.has(rest_shape_name)) mesh.rest_shape = read_corners(rest_shape_name, offsets, corners);
  }

  std::vector<Corners2> read_corners(const std::string& name, std::span<const Global> offsets,
                                     Global corners) const {
    const Global rows = file_.rows(name);
    const int columns = file_.columns(name);
    agree_on(name,
             rows == corners && columns == 2
                 ? Complaint()
                 : fmt::format("it has the shape ({}, {}) instead of ({}, 2): u and v of each number of {}",
                               rows, columns, corners, faces_name));
    const auto uv = file_.read<double>(name, {offsets.front(), offsets.back() - offsets.front(), corners});
    agree_on(name, std::ranges::all_of(uv, [](double x) { return std::isfinite(x); })
                       ? Complaint()
                       : "a number is not finite");
    std::vector<Corners2> result(offsets.size() - 1,
                                 {Vec2::Zero(), Vec2::Zero(), Vec2::Zero(), Vec2::Zero()});
    for (std::size_t c = 0; c < result.size(); ++c)
      for (Global i = offsets[c]; i < offsets[c + 1]; ++i) {
        const std::size_t at = 2 * std::size_t(i - offsets[0]);
        result[c][std::size_t(i - offsets[c])] = {uv[at], uv[at + 1]};
      }
    return result;
  }

  MPI_Comm comm_;
  H5Reader file_;
};

} // namespace

MeshSlab read_mesh_h5(MPI_Comm comm, const fs::path& path, double scale) {
  return MeshReader(comm, path).read(scale);
}

std::vector<Vec3> read_positions(MPI_Comm comm, const fs::path& path, double scale, Slab expected) {
  if (path.extension() != ".h5") return read_obj_positions(comm, path, scale, expected);
  const H5Reader file(comm, path);
  if (const Global rows = file.rows("/positions"); rows != expected.total)
    throw InputError(
        fmt::format("{}: /positions has {} vertices, the mesh {}; give the vertices of the mesh, in "
                    "the same order, in other places",
                    path.string(), rows, expected.total));
  auto positions = file.read_vectors("/positions", expected);
  for (Vec3& p : positions) p *= scale;
  return positions;
}

MeshSlab read_mesh(MPI_Comm comm, const fs::path& path, double scale, Polygons polygons) {
  const std::string extension = path.extension().string();
  for (const char* surface : {".obj", ".ply", ".stl"})
    if (extension == surface) return read_obj(comm, path, scale, polygons);
  if (extension == ".h5") return read_mesh_h5(comm, path, scale);
  throw InputError(
      fmt::format("{}: the extension '{}' is not known; give a mesh file .obj, .ply, .stl or .h5",
                  path.string(), extension));
}

} // namespace taut
