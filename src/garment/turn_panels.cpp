#include "src/garment/turn_panels.hpp"

#include "partition/error.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace taut::garment {

namespace {

/// Two panels with a side in common; alike: their cells run along it in opposite directions.
struct Neighbours {
  std::size_t panels[2];
  bool alike;
};

std::vector<Neighbours> neighbours_of(const GarmentMesh& mesh, const SewnMesh& sewn) {
  struct Side {
    std::size_t panel;
    bool upwards;
  };
  std::map<std::pair<Global, Global>, Side> met;
  std::vector<Neighbours> neighbours;
  for (std::size_t p = 0; p < mesh.panels.size(); ++p) {
    const MeshedPanel& panel = mesh.panels[p];
    for (Global c = panel.first_cell; c < panel.first_cell + panel.cells; ++c) {
      const Cell& cell = sewn.cells[c];
      for (int k = 0, n = cell.size(); k < n; ++k) {
        const Global from = cell.vertices[k], to = cell.vertices[(k + 1) % n];
        const auto [side, is_new] = met.try_emplace(std::minmax(from, to), Side{p, from < to});
        if (!is_new && side->second.panel != p)
          neighbours.push_back({{side->second.panel, p}, side->second.upwards != (from < to)});
      }
    }
  }
  return neighbours;
}

/// For each panel whether it is to be turned.
std::vector<bool> turns_of(const GarmentMesh& mesh, const std::string& name,
                           const std::vector<Neighbours>& neighbours) {
  enum class Turn { unknown, stays, turns };
  std::vector<Turn> turns(mesh.panels.size(), Turn::unknown);
  const auto across = [](Turn one, bool alike) {
    return alike ? one : one == Turn::stays ? Turn::turns : Turn::stays;
  };
  const auto spread = [&] { // one panel farther; whether there was one
    bool changed = false;
    for (const auto& [panels, alike] : neighbours) {
      Turn &one = turns[panels[0]], &two = turns[panels[1]];
      if ((one == Turn::unknown) == (two == Turn::unknown)) continue;
      (one == Turn::unknown ? one : two) = across(one == Turn::unknown ? two : one, alike);
      changed = true;
    }
    return changed;
  };
  for (Turn& first : turns)
    if (first == Turn::unknown) {
      first = Turn::stays;
      while (spread()) {
      }
    }
  for (const auto& [panels, alike] : neighbours)
    if (turns[panels[1]] != across(turns[panels[0]], alike))
      throw InputError(
          fmt::format("{}: panels '{}' and '{}' are sewn right side to wrong side, and no turning of panels "
                      "mends it: look at the order of the edges of their seams, and at right_wrong",
                      name, mesh.panels[panels[0]].name, mesh.panels[panels[1]].name));
  std::vector<bool> result;
  for (const Turn turn : turns) result.push_back(turn == Turn::turns);
  return result;
}

} // namespace

void turn_panels(const GarmentMesh& mesh, const std::string& name, SewnMesh& sewn) {
  const std::vector<bool> turns = turns_of(mesh, name, neighbours_of(mesh, sewn));
  for (std::size_t p = 0; p < mesh.panels.size(); ++p) {
    if (!turns[p]) continue;
    const MeshedPanel& panel = mesh.panels[p];
    for (Global c = panel.first_cell; c < panel.first_cell + panel.cells; ++c) {
      const int n = sewn.cells[c].size();
      std::reverse(sewn.cells[c].vertices.begin() + 1, sewn.cells[c].vertices.begin() + n);
      std::reverse(sewn.texture[c].begin() + 1, sewn.texture[c].begin() + n);
    }
  }
}

} // namespace taut::garment
