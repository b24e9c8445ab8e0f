#pragma once
#include "partition/types.hpp"

#include <array>
#include <span>
#include <vector>

namespace taut {

/// Of the vertices of a mesh: length 1, outwards, those of the triangles weighted by area; zero where there
/// are none. Triangles may be oriented either way, but all alike.
std::vector<Vec3> outward_normals(std::span<const Vec3> positions,
                                  std::span<const std::array<Local, 3>> triangles);

/// Each of the values of vertices becomes the mean of its neighbours', so many times.
void even_out(std::vector<Vec3>& values, std::span<const std::array<Local, 3>> triangles, int rounds);

/// The radius of the ball that touches a surface at p, lies on the side of `normal` there, and has the place
/// q on its surface: |p − q|² / (2 (q − p)·n). `apart` is q − p.
inline double radius_of_ball(const Vec3& apart, const Vec3& normal) {
  return apart.squaredNorm() / (2 * apart.dot(normal));
}

} // namespace taut
