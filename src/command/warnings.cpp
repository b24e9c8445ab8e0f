#include "src/command/warnings.hpp"

#include "src/config/cloths.hpp"
#include "src/config/methods.hpp"
#include "src/contact/clearance.hpp"
#include "src/contact/closest.hpp"
#include "src/contact/thickness.hpp"
#include "src/state/resolve.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

namespace taut::command {

namespace {

using Warnings = std::vector<std::string>;

void add_patterns(const Simulation& simulation, const Case&, Warnings& warnings) {
  for (const Piece& piece : simulation.cloth().pieces)
    warnings.insert(warnings.end(), piece.warnings.begin(), piece.warnings.end());
}

void add_seams(const Simulation& simulation, const Case& input, Warnings& warnings) {
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    const config::Cloth& cloth = input.cloths[k];
    const std::size_t seams = simulation.cloth().pieces[k].parts.seams.size();
    if (cloth.pattern && !input.sewing && !cloth.start.run && seams > 0)
      warnings.push_back(fmt::format(
          "{}.pattern: nothing sews its {} seam{}, so its panels stay apart; sewing: {{}} in the case does",
          config::key_of_cloth(input, k), seams, seams == 1 ? "" : "s"));
  }
}

void add_locking(const Simulation& simulation, const Case&, Warnings& warnings) {
  const config::Inextensibility& limits = simulation.inextensibility();
  const auto& pieces = simulation.cloth().pieces;
  const bool has_triangles_only =
      std::any_of(pieces.begin(), pieces.end(), [](const Piece& p) { return p.triangles_only; });
  if (has_triangles_only && limits.constrain == config::Constrain::edges && simulation.strain_limit())
    warnings.push_back("a mesh of triangles locks if all its edges keep their lengths: it folds only along "
                       "edges, in small steps; use quads, or inextensibility.constrain: vertices with method "
                       "fast_projection or newton");
}

/// Newton's method where its linear solver does badly.
void add_expense(const Simulation& simulation, const Case& input, Warnings& warnings) {
  const Global vertices = simulation.cloth().mesh.vertices.total;
  if (input.inextensibility.method == config::InextensibilityMethod::newton &&
      input.contact_model() != config::ContactModel::none && vertices > most_vertices_to_factor)
    warnings.push_back(fmt::format("method newton is expensive with contact on as many as {} vertices; "
                                   "inextensibility.method: fast_projection costs a fraction, but garments "
                                   "do not come to rest by it",
                                   vertices));
}

/// Millimetres and inches taken for metres.
void add_scale(const Simulation& simulation, const Case&, Warnings& warnings) {
  constexpr double too_wide = 100, narrowest = 1e-3; // m
  const DistributedMesh& mesh = simulation.cloth().mesh;
  std::array<double, 6> ends;
  ends.fill(-HUGE_VAL);
  for (const Vec3& x : mesh.rest_positions)
    for (int k = 0; k < 3; ++k) {
      ends[k] = std::max(ends[k], x[k]);
      ends[3 + k] = std::max(ends[3 + k], -x[k]);
    }
  max_in_place(mesh.comm, ends);
  const double width = std::max({ends[0] + ends[3], ends[1] + ends[4], ends[2] + ends[5]});
  if (width >= too_wide || width < narrowest)
    warnings.push_back(
        fmt::format("the cloth is {:.3g} m wide; if its mesh is in other units, give `scale`, the "
                    "metres per unit",
                    width));
}

void add_density(const Simulation&, const Case& input, Warnings& warnings) {
  constexpr double lightest = 3e-3, heaviest = 5; // kg/m^2
  const auto check = [&](std::size_t k, const std::string& key, double density) {
    if (!input.cloths[k].line && (density < lightest || density > heaviest))
      warnings.push_back(
          fmt::format("{}.{}material.density: no fabric weighs {:.3g} kg/m^2; they are between "
                      "{:g} and {:g}; g/m^2 is a unit too",
                      config::key_of_cloth(input, k), key, density, lightest, heaviest));
  };
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    check(k, "", input.cloths[k].material.density);
    for (const auto& [name, panel] : input.cloths[k].panels)
      if (panel.material.density) check(k, fmt::format("panels.{}.", name), *panel.material.density);
  }
}

/// Millionths of a newton metre taken for newton metres.
void add_bending(const Simulation&, const Case& input, Warnings& warnings) {
  constexpr double stiffest = 1e-2; // N m
  const auto check = [&](std::size_t k, const std::string& key, std::optional<double> bending) {
    if (!input.cloths[k].line && bending && *bending > stiffest)
      warnings.push_back(fmt::format("{}.{}material.bending: no fabric is as stiff as {:.3g} N m; most are "
                                     "between 1e-6 and 1e-4; uN m is a unit too",
                                     config::key_of_cloth(input, k), key, *bending));
  };
  for (std::size_t k = 0; k < input.cloths.size(); ++k) {
    check(k, "", input.cloths[k].material.bending);
    for (const auto& [name, panel] : input.cloths[k].panels)
      check(k, fmt::format("panels.{}.", name), panel.material.bending);
  }
}

void add_pins(const Simulation& simulation, const Case&, Warnings& warnings) {
  if (const auto jump = simulation.pins().find_jump(simulation.cloth(), simulation.state()))
    warnings.push_back(fmt::format("{}: it jumps there in the first step; let `motion` begin where the cloth "
                                   "starts, or move `start`",
                                   *jump));
}

/// Contact pushes it out to its thickness in the first step, and so throws it off.
void add_touching(const Simulation& simulation, const Case& input, Warnings& warnings) {
  constexpr double much = 0.9; // of the thickness
  const Cloth& cloth = simulation.cloth();
  const bool untangles = input.contact && input.contact->start == config::StartContact::untangle;
  if (input.sewing || untangles || !input.has_contact() || simulation.obstacles().bodies() == 0) return;
  const double thickness = Thickness(cloth, input).smallest();
  const std::span<const Vec3> owned =
      std::span(simulation.state().positions).first(std::size_t(cloth.mesh.vertices.owned));
  double nearest = HUGE_VAL;
  for (const double distance : Clearance(simulation.obstacles()).measure(owned, simulation.state().time))
    nearest = std::min(nearest, distance);
  nearest = -max_over(cloth.mesh.comm, -nearest);
  if (nearest >= 0 && nearest < much * thickness) // what is inside is refused
    warnings.push_back(
        fmt::format("the cloth starts {:.3g} mm from an obstacle, nearer than its thickness of "
                    "{:.3g} mm, and is pushed away in the first step; move `start`, or lessen "
                    "contact.thickness",
                    1000 * nearest, 1000 * thickness));
}

/// By how often a ray meets the surface of a closed body.
bool is_inside(const Obstacles& obstacles, int body, const Vec3& point) {
  constexpr double beyond = 1e10;                                      // m, of what any body reaches
  const Vec3 far_away = point + beyond * Vec3(0.5773, 0.2113, 0.7887); // along no axis and no diagonal
  bool inside = false;
  for (const Element& e : obstacles.elements()) {
    if (e.body != body || !e.is_triangle()) continue;
    std::array<Vec3, 3> corners;
    for (int k = 0; k < 3; ++k) corners[k] = obstacles.moved(body, obstacles.start()[e.vertices[k]], 0);
    inside ^= passes(point, far_away, corners);
  }
  return inside;
}

/// Where the start does not intersect, a cloth is inside if one of its vertices is. Panels may be, in a body
/// that begins slim.
void add_inside(const Simulation& simulation, const Case& input, Warnings& warnings) {
  if (input.sewing) return;
  const Cloth& cloth = simulation.cloth();
  const Obstacles& obstacles = simulation.obstacles();
  for (int body = 0; body < obstacles.bodies(); ++body) {
    const config::Obstacle& given = input.obstacles[std::size_t(body)];
    if (!(given.box || given.mesh) || given.sequence || obstacles.body(body).rims > 0) continue;
    for (std::size_t k = 0; k < cloth.pieces.size(); ++k) {
      const auto& numbers = cloth.mesh.vertices.original;
      const auto first = std::find(numbers.begin(), numbers.begin() + cloth.mesh.vertices.owned,
                                   cloth.pieces[k].first_vertex);
      const Local v = Local(first - numbers.begin());
      const bool mine = v < cloth.mesh.vertices.owned;
      if (any_of(cloth.mesh.comm, mine && is_inside(obstacles, body, simulation.state().positions[v])))
        warnings.push_back(
            fmt::format("{} starts inside {}, a closed body, and will stay there; move `start` if "
                        "it is to be outside",
                        config::key_of_cloth(input, k), obstacles.body(body).name));
    }
  }
}

} // namespace

void warn_of_start(const Simulation& simulation, const Case& input) {
  Warnings warnings;
  for (const auto add : {add_patterns, add_seams, add_locking, add_expense, add_scale, add_density,
                         add_bending, add_pins, add_touching, add_inside})
    add(simulation, input, warnings);
  if (rank_of(simulation.cloth().mesh.comm) != 0) return;
  for (const std::string& words : warnings)
    fmt::print(stderr, "taut: warning: {}: {}\n", input.file.string(), words);
}

} // namespace taut::command
