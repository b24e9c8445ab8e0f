#pragma once
#include "partition/types.hpp"

#include <string>
#include <vector>

/// The cloth of one frame in formats of other programs, as the bytes of a file. Not collective.
namespace taut {

struct Surface {
  std::vector<Vec3> positions;
  std::vector<Global> corners;   ///< vertices of one face after the other, counted from 0
  std::vector<Global> offsets;   ///< of faces in `corners`, and where the last ends
  std::vector<double> texture{}; ///< u, v of each corner; may be empty
  double metres_per_unit = 1;    ///< of `positions`, for formats that say so
  char up = 'z';                 ///< the same
};

/// Wavefront OBJ, with `vt` where there is texture.
std::string obj_text(const Surface& surface);

/// PLY, binary little endian, float32.
std::string ply_text(const Surface& surface);

/// USD as text: one mesh, with primvar `st` where there is texture.
std::string usda_text(const Surface& surface);

} // namespace taut
