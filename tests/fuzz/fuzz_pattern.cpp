// Sewing patterns, up to their meshes; those whose first byte is a brace as GarmentCode writes them.
#include "partition/error.hpp"
#include "src/garment/garment_mesh.hpp"
#include "src/garment/read_pattern.hpp"
#include "tests/fuzz/target.hpp"

#include <cmath>
#include <string>

void taut::fuzz::read_input(std::string_view bytes) {
  garment::SewingPattern pattern =
      garment::parse_pattern(std::string(bytes), bytes.starts_with('{') ? "pattern.json" : "pattern.yaml");
  check_panels(pattern);
  double area = 0, around = 0;
  for (garment::Panel& panel : pattern.panels) {
    area += std::abs(signed_area(panel));
    panel.edge_length.reset(); // a mesh of a thousand vertices or so is enough
    for (const garment::PatternEdge& edge : panel.edges) around += length_of(edge.curve);
  }
  const auto mesh = mesh_garment(pattern, {std::max(std::sqrt(area) / 20, around / 1000), {}});
  for (const Vec3& position : mesh.positions)
    if (!position.allFinite()) throw Contradiction("a sound pattern has a vertex nowhere");
}
