#include "src/output/frame_fields.hpp"

#include "partition/yarns.hpp"
#include "src/config/methods.hpp"
#include "src/constraints/averaged_metric.hpp"
#include "src/contact/clearance.hpp"
#include "src/contact/gap_gauge.hpp"
#include "src/contact/thickness.hpp"
#include "src/output/strain_fields.hpp"

#include <algorithm>
#include <cmath>
#include <memory>

namespace taut {

namespace {

using enum FieldCentre;
using enum FieldHome;
using Fields = std::vector<FrameField>;

std::vector<Global> yarns_of_edges(const DistributedMesh& mesh) {
  return yarn_numbers(mesh, find_yarns(mesh));
}

/// On faces the yarn along a direction that meets their first corner; -1: none.
std::vector<Global> yarns_of_cells(const DistributedMesh& mesh, Along direction) {
  const std::vector<Global> yarn = yarns_of_edges(mesh);
  std::vector<Global> result;
  for (const Local c : mesh.owned_cells) {
    const auto s = sides_of(mesh, c);
    const auto [first, second] = direction == Along::warp ? std::array{s[0], s[2]} : std::array{s[3], s[1]};
    result.push_back(first >= 0 ? yarn[first] : second >= 0 ? yarn[second] : Global(-1));
  }
  return result;
}

/// Of each cell the number of the cloth that it is part of.
std::vector<std::int32_t> cloths_of_cells(const Cloth& cloth) {
  std::vector<std::int32_t> number;
  for (const Local c : cloth.mesh.owned_cells)
    number.push_back(std::int32_t(cloth.piece_of(cloth.mesh.cells[c].vertices[0])));
  return number;
}

/// The number of a seam that each vertex is on; -1: none.
std::vector<std::int32_t> seams_of_vertices(const Cloth& cloth,
                                            const std::vector<garment::NamedSeam>& seams) {
  const IndexMap& map = cloth.mesh.vertices;
  std::vector<std::int32_t> seam;
  for (Local i = 0; i < map.owned; ++i) {
    const auto found = std::find_if(seams.begin(), seams.end(), [&](const garment::NamedSeam& s) {
      return std::binary_search(s.vertices.begin(), s.vertices.end(), map.original[i]);
    });
    seam.push_back(found == seams.end() ? -1 : std::int32_t(found - seams.begin()));
  }
  return seam;
}

/// u along warp and v along weft, 0: of the first cell that a vertex is in; cells of other panels may have
/// others there.
std::vector<Vec3> texture_of_vertices(const DistributedMesh& mesh) {
  std::vector<Vec3> texture(mesh.vertices.size(), Vec3::Zero());
  std::vector<bool> has(texture.size(), false);
  for (std::size_t c = 0; c < mesh.cells.size(); ++c)
    for (int k = 0; k < mesh.cells[c].size(); ++k) {
      const auto i = std::size_t(mesh.cells[c].vertices[k]);
      if (!has[i]) texture[i].head<2>() = mesh.texture[c][k];
      has[i] = true;
    }
  return texture;
}

void add_clearance(const Cloth& cloth, const Obstacles& obstacles, Fields& fields) {
  const auto clearance = std::make_shared<Clearance>(obstacles);
  fields.push_back({"clearance", "/clearance", vertex, each_frame, "m", [&cloth, clearance](const State& s) {
                      return clearance->measure(
                          std::span(s.positions).first(std::size_t(cloth.mesh.vertices.owned)), s.time);
                    }});
}

void add_contact(const Cloth& cloth, const Obstacles& obstacles, const Case& input, Fields& fields) {
  fields.push_back({"contact_force", "/contact_forces", vertex, each_frame, "N",
                    [](const State& s) { return s.reported.contact_force; }});
  if (!obstacles.empty()) add_clearance(cloth, obstacles, fields);
  const auto gauge = std::make_shared<GapGauge>(cloth, obstacles, 2.0 * Thickness(cloth, input).largest());
  fields.push_back({"gap", "/gaps", vertex, each_frame, "m", [gauge, &obstacles](const State& s) {
                      std::vector<Vec3> bodies;
                      obstacles.place(s.time, bodies);
                      return gauge->measure(s.positions, bodies);
                    }});
}

/// Of a garment: which panel cells are of, which seam vertices are on.
void add_parts(const Cloth& cloth, Fields& fields) {
  const auto parts = std::make_shared<garment::NamedParts>(parts_of(cloth));
  if (!parts->panels.empty())
    fields.push_back({"panel", "/cells/panel", cell, shared_mesh, "", [&cloth, parts](const State&) {
                        std::vector<std::int32_t> panel;
                        for (const Global c : cloth.mesh.owned_cell_originals)
                          panel.push_back(parts->panel_of(c));
                        return panel;
                      }});
  if (!parts->seams.empty())
    fields.push_back({"seam", "/seams/of_vertices", vertex, shared_mesh, "",
                      [&cloth, parts](const State&) { return seams_of_vertices(cloth, parts->seams); }});
}

void add_yarns(const DistributedMesh& mesh, Fields& fields) {
  fields.push_back({"yarn", "/constraints/yarn", edge, shared_mesh, "",
                    [&mesh](const State&) { return yarns_of_edges(mesh); }});
  for (const auto& [name, direction] :
       {std::pair{"yarn_warp", Along::warp}, std::pair{"yarn_weft", Along::weft}})
    fields.push_back(
        {name, std::string("/cells/") + name, cell, shared_mesh, "",
         [&mesh, direction = direction](const State&) { return yarns_of_cells(mesh, direction); }});
}

void add_strain(const Cloth& cloth, Fields& fields) {
  fields.push_back({"strain", "/strain", edge, each_frame, "",
                    [&cloth](const State& s) { return strains_of_edges(cloth, s); }});
  for (const auto& [name, direction] :
       {std::pair{"strain_warp", Along::warp}, std::pair{"strain_weft", Along::weft}})
    fields.push_back({name, std::string("/cells/") + name, cell, each_frame, "",
                      [&cloth, direction = direction](const State& s) {
                        return strains_of_cells(cloth, s.positions, direction);
                      }});
}

/// Of the metrics that are kept in the place of edges; 0 at vertices that have none.
void add_averages(const Cloth& cloth, Fields& fields) {
  const auto metric = std::make_shared<AveragedMetric>(cloth);
  for (const auto& [name, k] : {std::pair{"average_strain_warp", 0}, std::pair{"average_strain_weft", 1}})
    fields.push_back({name, std::string("/") + name, vertex, each_frame, "", [metric, k = k](const State& s) {
                        std::vector<double> strain(metric->cloth().mesh.vertices.owned, 0.0);
                        for (Local i = 0; i < Local(strain.size()); ++i)
                          if (metric->has(i)) strain[i] = std::sqrt(metric->at(i, s.positions)[k]) - 1.0;
                        return strain;
                      }});
}

void add_tension(const Cloth& cloth, Fields& fields) {
  fields.push_back({"tension", "/tension", edge, each_frame, "N",
                    [&cloth](const State& s) { return tensions_of_edges(cloth, s); }});
  for (const auto& [name, direction] :
       {std::pair{"tension_warp", Along::warp}, std::pair{"tension_weft", Along::weft}})
    fields.push_back({name, std::string("/cells/") + name, cell, each_frame, "N",
                      [&cloth, direction = direction](const State& s) {
                        return mean_over_sides(cloth.mesh, tensions_of_edges(cloth, s), direction);
                      }});
}

} // namespace

Fields frame_fields(const Cloth& cloth, const Obstacles& obstacles, const Case& input) {
  const auto wants = [&](config::Field field) {
    const auto& wanted = input.output.fields;
    return std::find(wanted.begin(), wanted.end(), field) != wanted.end();
  };
  Fields fields;
  if (wants(config::Field::velocity))
    fields.push_back(
        {"velocity", "/velocities", vertex, each_frame, "m/s", [](const State& s) { return s.velocities; }});
  if (wants(config::Field::reaction))
    fields.push_back({"reaction", "/reactions", vertex, each_frame, "N",
                      [](const State& s) { return s.reported.reaction; }});
  if (wants(config::Field::contact) && input.has_contact()) add_contact(cloth, obstacles, input, fields);
  if (wants(config::Field::owner_rank))
    fields.push_back({"owner_rank", "/owner_rank", vertex, shared_mesh, "", [&cloth](const State&) {
                        return std::vector<std::int32_t>(cloth.mesh.vertices.owned, rank_of(cloth.mesh.comm));
                      }});
  if (cloth.pieces.size() > 1)
    fields.push_back({"cloth", "/cells/cloth", cell, shared_mesh, "",
                      [&cloth](const State&) { return cloths_of_cells(cloth); }});
  add_parts(cloth, fields);
  if (any_of(cloth.mesh.comm, !cloth.mesh.texture.empty()))
    fields.push_back({"texture", "/texture_of_vertices", vertex, shared_mesh, "m",
                      [&cloth](const State&) { return texture_of_vertices(cloth.mesh); }});
  if (wants(config::Field::yarn)) add_yarns(cloth.mesh, fields);
  if (wants(config::Field::strain)) {
    add_strain(cloth, fields);
    if (config::constrain_of(input, cloth.mesh.has_triangles) == config::Constrain::vertices)
      add_averages(cloth, fields);
  }
  if (wants(config::Field::tension)) add_tension(cloth, fields);
  return fields;
}

} // namespace taut
