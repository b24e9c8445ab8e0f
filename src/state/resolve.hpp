#pragma once
#include "src/state/cloth.hpp"

namespace taut {

/// Up to which the factor of Newton's whole system is the default on meshes with triangles.
inline constexpr Global most_vertices_to_factor = 100000;

/// What a case leaves to the mesh, decided once.
struct Resolved {
  config::Inextensibility inextensibility; ///< `constrain` and `solver` are given, and `compliance` but
                                           ///< for xpbd
  std::optional<double> strain_limit;      ///< of every accepted step; none if nothing keeps one
  std::optional<double> faces_limit;       ///< the same of single triangles
  double weight = 0;                       ///< of the cloth, N
  std::vector<Vec2> stretch;               ///< stiffness of warp and weft, of sections: N/m, N on lines
};

/// Throws InputError for what the mesh cannot have. Collective.
Resolved resolve(const Case& input, const Cloth& cloth);

/// In kg. Collective.
double mass_of(const Cloth& cloth);

} // namespace taut
