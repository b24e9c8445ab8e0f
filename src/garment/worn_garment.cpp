#include "src/garment/worn_garment.hpp"

#include "io/hdf5.hpp"
#include "partition/error.hpp"
#include "src/garment/plane.hpp"

#include <Eigen/Dense>
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <unordered_map>

namespace taut::garment {

namespace {

/// The parts of the three corners that make up a point of the plane.
Vec3 weights_of(const std::array<Vec2, 3>& x, const Vec2& p) {
  const Vec2 a = x[1] - x[0], b = x[2] - x[0], d = p - x[0];
  const double area = cross(a, b), v = cross(d, b) / area, w = cross(a, d) / area;
  return {1 - v - w, v, w};
}

double distance_to(const std::array<Vec2, 3>& x, const Vec2& p) {
  if (weights_of(x, p).minCoeff() >= 0) return 0;
  double least = HUGE_VAL;
  for (int k = 0; k < 3; ++k) {
    const Vec2 side = x[(k + 1) % 3] - x[k];
    const double t = std::clamp((p - x[k]).dot(side) / side.squaredNorm(), 0.0, 1.0);
    least = std::min(least, (x[k] + t * side - p).norm());
  }
  return least;
}

double longest_side(const std::array<Vec2, 3>& x) {
  return std::max({(x[1] - x[0]).norm(), (x[2] - x[1]).norm(), (x[0] - x[2]).norm()});
}

} // namespace

/// The triangles of a panel by the squares of its plane that they touch.
class WornGarment::Grid {
public:
  /// Squares of this size (m), at least that of a triangle.
  Grid(const WornPanel& panel, double size) : panel_(panel), size_(size) {
    for (std::size_t k = 0; k < panel.triangles.size(); ++k) {
      const auto& x = panel.triangles[k].texture;
      const Square low = square_of(x[0].cwiseMin(x[1]).cwiseMin(x[2])),
                   high = square_of(x[0].cwiseMax(x[1]).cwiseMax(x[2]));
      for (int i = low[0]; i <= high[0]; ++i)
        for (int j = low[1]; j <= high[1]; ++j) squares_[key_of({i, j})].push_back(int(k));
    }
  }

  /// The triangle nearest to a point, of those within one square around; none if there is none so near.
  const Triangle* nearest(const Vec2& p) const {
    const Triangle* found = nullptr;
    double least = size_;
    const Square here = square_of(p);
    for (int i = -1; i <= 1; ++i)
      for (int j = -1; j <= 1; ++j) {
        const auto square = squares_.find(key_of({here[0] + i, here[1] + j}));
        if (square == squares_.end()) continue;
        for (const int k : square->second)
          if (const double d = distance_to(panel_.triangles[k].texture, p); d < least) {
            least = d;
            found = &panel_.triangles[k];
          }
      }
    return found;
  }

private:
  using Square = std::array<int, 2>;
  Square square_of(const Vec2& p) const {
    return {int(std::floor(p[0] / size_)), int(std::floor(p[1] / size_))};
  }
  static std::int64_t key_of(const Square& s) { return (std::int64_t(s[0]) << 32) + s[1]; }

  const WornPanel& panel_;
  double size_; ///< m
  std::unordered_map<std::int64_t, std::vector<int>> squares_;
};

WornGarment::WornGarment(MPI_Comm comm, const std::filesystem::path& mesh, const std::filesystem::path& frame)
    : name_(mesh.string()) {
  const NamedParts parts = read_named_parts(comm, mesh);
  const H5Reader file(comm, mesh), last(comm, frame);
  if (parts.panels.empty() || !file.has("/texture"))
    throw InputError(fmt::format("{}: is no garment with panels and texture coordinates; give a run of a "
                                 "pattern",
                                 name_));
  const auto all = [&](Global rows) { return Slab{0, rank_of(comm) == 0 ? rows : 0, rows}; };
  const auto faces = file.read<Global>("/faces", all(file.rows("/faces")));
  const auto offsets = file.read<Global>("/face_offsets", all(file.rows("/face_offsets")));
  const auto texture = file.read<double>("/texture", all(file.rows("/texture")));
  const auto positions = last.read_vectors("/positions", all(file.rows("/rest_positions")));
  for (const NamedPanel& p : parts.panels) panels_.push_back({p.name, {}});
  for (std::size_t c = 0; c + 1 < offsets.size(); ++c)
    for (Global k = offsets[c] + 2; k < offsets[c + 1]; ++k) {
      Triangle& t = panels_[std::size_t(parts.panel_of(Global(c)))].triangles.emplace_back();
      const std::array<Global, 3> corners{offsets[c], k - 1, k};
      for (int i = 0; i < 3; ++i) {
        t.texture[i] = Vec2(texture[2 * corners[i]], texture[2 * corners[i] + 1]);
        t.places[i] = positions[faces[corners[i]]];
      }
      longest_side_ = std::max(longest_side_, longest_side(t.texture));
    }
}

const WornGarment::WornPanel& WornGarment::panel(const std::string& name) const {
  const auto found =
      std::find_if(panels_.begin(), panels_.end(), [&](const WornPanel& p) { return p.name == name; });
  if (found != panels_.end()) return *found;
  std::vector<std::string> names;
  for (const WornPanel& p : panels_) names.push_back(p.name);
  throw InputError(fmt::format("{}: has no panel '{}' but {}; give a run of the same pattern", name_, name,
                               fmt::join(names, ", ")));
}

std::vector<Vec3> WornGarment::carry(const GarmentMesh& mesh, const std::string& prefix) const {
  std::vector<Vec3> places;
  for (const MeshedPanel& p : mesh.panels) {
    const Grid grid(panel(prefix + p.name), longest_side_);
    for (Global v = p.first_vertex; v < p.first_vertex + p.vertices; ++v) {
      const Vec2 at(mesh.material[v][1], -mesh.material[v][0]);
      const Triangle* t = grid.nearest(at);
      if (!t)
        throw InputError(
            fmt::format("{}: panel '{}' has another shape there: it does not reach ({:.4g}, {:.4g}) "
                        "m along warp and weft; give a run of the same pattern",
                        name_, p.name, at[0], at[1]));
      const Vec3 w = weights_of(t->texture, at);
      places.push_back(w[0] * t->places[0] + w[1] * t->places[1] + w[2] * t->places[2]);
    }
  }
  check_seams(mesh, places);
  return places;
}

/// Where a run was sewn, what belongs together is apart by what a coarse mesh cuts off at curved outlines.
void WornGarment::check_seams(const GarmentMesh& mesh, std::span<const Vec3> places) const {
  for (const MeshedSeam& seam : mesh.seams)
    for (const auto& [a, b] : seam.pairs)
      if (const double distance = (places[a] - places[b]).norm(); distance > longest_side_)
        throw InputError(fmt::format("{}: seam {} is open there, by {:.3g} mm; give a run that was sewn",
                                     name_, seam.name, 1000 * distance));
}

} // namespace taut::garment
