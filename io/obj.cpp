#include "io/obj.hpp"

#include "io/obj_parser.hpp"
#include "io/ply.hpp"
#include "io/scatter.hpp"
#include "io/stl.hpp"
#include "partition/comm.hpp"

#include <fmt/format.h>

#include <array>
#include <fstream>
#include <string>
#include <system_error>

namespace taut {
namespace {

namespace fs = std::filesystem;

std::string read_text(const fs::path& path) {
  std::error_code error;
  const bool regular = fs::is_regular_file(path, error);
  std::ifstream in(path, std::ios::binary);
  if (!regular || !in)
    throw InputError(fmt::format("{}: no such file, or it may not be read; check its name", path.string()));
  std::string text(fs::file_size(path), '\0');
  if (!in.read(text.data(), static_cast<std::streamsize>(text.size())))
    throw InputError(fmt::format("{}: reading stopped before the end; check the disk", path.string()));
  return text;
}

ObjFile parse(const std::string& text, const fs::path& path, Polygons polygons) {
  const fs::path extension = path.extension();
  if (extension == ".ply") return parse_ply(text, path.string());
  if (extension == ".stl") return parse_stl(text, path.string());
  return parse_obj(text, path.string(), polygons);
}

void warn_of(const Unused& unused, const fs::path& path) {
  if (unused.vertices > 0)
    fmt::print(stderr,
               "taut: warning: {}{}: {} {} to no face and no line, this the first, and {} left out; vertices "
               "are numbered without\n",
               path.string(), unused.first_line > 0 ? fmt::format(":{}", unused.first_line) : "",
               unused.vertices, unused.vertices == 1 ? "vertex belongs" : "vertices belong",
               unused.vertices == 1 ? "is" : "are");
}

/// The parsed file, on rank 0; empty on the others. `check` may refuse it.
template<class Check>
ObjFile parse_on_rank_0(MPI_Comm comm, const fs::path& path, double scale, Polygons polygons, Check&& check) {
  ObjFile file;
  on_rank_0(comm, [&] {
    file = parse(read_text(path), path, polygons);
    const Unused unused = drop_unused(file);
    check(file);
    warn_of(unused, path);
  });
  for (Vec3& position : file.positions) position *= scale;
  return file;
}

void warn_of(const ObjFile::Unknown& unknown, const fs::path& path) {
  fmt::print(stderr, "taut: warning: {}:{}: '{}' begins no line that is known here; {} such {} left out\n",
             path.string(), unknown.first_line, unknown.first_word, unknown.lines,
             unknown.lines == 1 ? "line was" : "lines were");
}

} // namespace

MeshSlab read_obj(MPI_Comm comm, const fs::path& path, double scale, Polygons polygons) {
  const ObjFile file = parse_on_rank_0(comm, path, scale, polygons, [&](const ObjFile& parsed) {
    if (parsed.positions.empty())
      throw InputError(fmt::format("{}: no vertices; write one 'v x y z' a line", path.string()));
    if (parsed.cells.empty())
      throw InputError(
          fmt::format("{}: no faces or lines; write 'f a b c d', 'f a b c' or 'l a b'", path.string()));
  });
  std::array<Global, 2> totals{static_cast<Global>(file.positions.size()),
                               static_cast<Global>(file.cells.size())};
  MPI_Bcast(totals.data(), 2, MPI_INT64_T, 0, comm);
  const int ranks = size_of(comm), rank = rank_of(comm);
  MeshSlab mesh;
  mesh.name = path.string();
  mesh.vertices = slab_of(totals[0], ranks, rank);
  mesh.cells = slab_of(totals[1], ranks, rank);
  mesh.rest_positions = scatter_slabs(comm, file.positions, mesh.vertices);
  mesh.vertex_lines = scatter_slabs(comm, file.vertex_lines, mesh.vertices);
  mesh.cell = scatter_slabs(comm, file.cells, mesh.cells);
  if (any_of(comm, !file.texture.empty())) mesh.texture = scatter_slabs(comm, file.texture, mesh.cells);
  mesh.cell_lines = scatter_slabs(comm, file.cell_lines, mesh.cells);
  if (file.unknown.lines > 0) warn_of(file.unknown, path);
  return mesh;
}

std::vector<Vec3> read_obj_positions(MPI_Comm comm, const fs::path& path, double scale, Slab expected) {
  const ObjFile file = parse_on_rank_0(comm, path, scale, Polygons::triangulate, [&](const ObjFile& parsed) {
    if (static_cast<Global>(parsed.positions.size()) != expected.total)
      throw InputError(
          fmt::format("{}: it has {} vertices, the mesh {}; give the vertices of the mesh, in the same "
                      "order, in other places",
                      path.string(), parsed.positions.size(), expected.total));
  });
  return scatter_slabs(comm, file.positions, expected);
}

} // namespace taut
