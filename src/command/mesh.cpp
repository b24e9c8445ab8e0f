#include "io/whole_file.hpp"
#include "src/command/command.hpp"
#include "src/config/values.hpp"
#include "src/garment/draw_svg.hpp"
#include "src/garment/read_pattern.hpp"
#include "src/garment/write_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace taut::command {

namespace {

using garment::EdgeLengths;
using garment::GarmentMesh;

double read_length(const std::string& option, const std::string& text) {
  const config::Key key{.unit = config::Unit::metre, .range = config::positive};
  const config::Tree tree{config::Tree::Kind::scalar, option, text, {}, {}};
  double length = 0;
  config::read(config::Spot{tree, "length of an edge", key}, length);
  return length;
}

/// Of options such as "5mm" and "collar=2mm".
EdgeLengths edge_lengths(const std::vector<std::string>& options) {
  EdgeLengths lengths;
  bool found = false;
  for (const std::string& option : options) {
    const auto equals = option.rfind('=');
    const double length = read_length("--edge " + option, option.substr(equals + 1)); // npos + 1 is 0
    found |= equals == std::string::npos;
    (equals == std::string::npos ? lengths.garment : lengths.panels[option.substr(0, equals)]) = length;
  }
  if (!found) throw InputError("--edge: give the length of the edges of all panels, e.g. --edge 5mm");
  return lengths;
}

double in_degrees(double angle) { return angle * 180 / std::numbers::pi; }

std::string panel_table(const GarmentMesh& mesh) {
  std::size_t width = 5;
  for (const auto& p : mesh.panels) width = std::max(width, p.name.size());
  std::string text = fmt::format("  {:<{}} {:>10} {:>9} {:>10} {:>10} {:>10} {:>15}\n", "panel", width,
                                 "area/m^2", "edge/mm", "vertices", "quads", "triangles", "smallest angle");
  for (const auto& p : mesh.panels)
    text += fmt::format("  {:<{}} {:>10.4f} {:>9.3g} {:>10} {:>10} {:>10} {:>15.1f}\n", p.name, width, p.area,
                        1000 * p.edge_length, p.vertices, p.cells - p.triangles, p.triangles,
                        in_degrees(p.sharpest.angle));
  return text;
}

std::string seam_table(const GarmentMesh& mesh) {
  if (mesh.seams.empty()) return "";
  std::size_t width = 4;
  for (const auto& s : mesh.seams) width = std::max(width, s.name.size());
  std::string text = fmt::format("  {:>4} {:<{}} {:>10} {:>10} {:>9} {:>7}\n", "", "seam", width, "length/m",
                                 "length/m", "gathered", "pairs");
  for (std::size_t i = 0; i < mesh.seams.size(); ++i) {
    const auto& [name, lengths, pairs] = mesh.seams[i];
    const auto [shorter, longer] = std::minmax(lengths[0], lengths[1]);
    const std::string gathered = longer > 1.005 * shorter ? fmt::format("{:.2f} : 1", longer / shorter) : "";
    text += fmt::format("  {:>4} {:<{}} {:>10.4f} {:>10.4f} {:>9} {:>7}\n", i, name, width, lengths[0],
                        lengths[1], gathered, pairs.size());
  }
  return text;
}

std::string summary(const std::string& name, const GarmentMesh& mesh) {
  double area = 0;
  Global triangles = 0;
  const garment::MeshedPanel* sharpest = &mesh.panels.front();
  for (const auto& p : mesh.panels) {
    area += p.area;
    triangles += p.triangles;
    if (p.sharpest.angle < sharpest->sharpest.angle) sharpest = &p;
  }
  std::string labels;
  for (const auto& [label, vertices] : mesh.labels)
    labels += fmt::format("{} {} ({} vertices)", labels.empty() ? "" : ",", label, vertices.size());
  return fmt::format("{}: {} panels of {:.4f} m^2, {} seams, {} vertices, {} cells ({:.1f} % triangles)\n",
                     name, mesh.panels.size(), area, mesh.seams.size(), mesh.positions.size(),
                     mesh.cells.size(), 100 * double(triangles) / double(mesh.cells.size())) +
         panel_table(mesh) + seam_table(mesh) + "  labels:" + (labels.empty() ? " none" : labels) + "\n" +
         fmt::format("  smallest angle {:.1f} degrees, in panel {} at ({:.4f}, {:.4f}) m of its plane\n",
                     in_degrees(sharpest->sharpest.angle), sharpest->name, sharpest->sharpest.place[0],
                     sharpest->sharpest.place[1]);
}

void write(MPI_Comm comm, const GarmentMesh& mesh, const std::filesystem::path& file) {
  if (file.empty()) return;
  if (file.extension() == ".obj") return write_obj(comm, mesh, file);
  write_h5(comm, mesh, file);
}

} // namespace

int mesh(MPI_Comm comm, const MeshOptions& options) {
  const std::string extension = options.out.extension().string();
  if (!options.out.empty() && extension != ".obj" && extension != ".h5")
    throw InputError(fmt::format("--out {}: the extension '{}' is not known; give a mesh file .obj or .h5",
                                 options.out.string(), extension));
  const EdgeLengths lengths = edge_lengths(options.edges);
  const garment::SewingPattern pattern = garment::read_pattern(comm, options.pattern);
  GarmentMesh made;
  on_rank_0(comm, [&] { made = mesh_garment(pattern, lengths); });
  const bool speaks = rank_of(comm) == 0;
  if (speaks) {
    for (const std::string& warning : made.warnings) fmt::print(stderr, "taut: warning: {}\n", warning);
    fmt::print("{}", summary(options.pattern.string(), made));
  }
  write(comm, made, options.out);
  if (!options.svg.empty()) write_text_whole(comm, options.svg, speaks ? draw_svg(made) : "");
  return success;
}

} // namespace taut::command
