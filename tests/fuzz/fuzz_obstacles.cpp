// The obstacles of a case, as YAML, and behind a line "#mesh" the OBJ file that all of its meshes are.
#include "src/contact/obstacle_surface.hpp"
#include "tests/fuzz/target.hpp"

#include <cmath>
#include <string>

namespace {

using namespace taut;

/// As write_input wrote it, under whatever name the case has for it.
void point_to(const std::filesystem::path& mesh, Case& input) {
  for (config::Obstacle& o : input.obstacles)
    if (o.mesh) o.mesh = mesh;
}

} // namespace

void taut::fuzz::read_input(std::string_view bytes) {
  constexpr std::string_view mark = "\n#mesh\n";
  const auto cut = std::min(bytes.find(mark), bytes.size());
  const auto behind = std::min(cut + mark.size(), bytes.size());
  Case input = read_case("cloth: {line: {length: 1, vertices: 2}}\n" + std::string(bytes.substr(0, cut)),
                         "folder/case.yaml");
  point_to(write_input("mesh.obj", bytes.substr(behind)), input);
  const Obstacles obstacles(MPI_COMM_SELF, input);
  std::vector<Vec3> positions;
  obstacles.place(0.5, positions);
  if (positions.size() != obstacles.start().size()) throw Contradiction("vertices got lost");
  const ObstacleSurface surface(obstacles, 1.0);
  if (surface.at(0.5).empty() != obstacles.empty()) throw Contradiction("obstacles without a surface");
}
