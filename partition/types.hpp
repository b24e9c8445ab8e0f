#pragma once
#include <Eigen/Core>
#include <cstdint>

namespace taut {

using Local = std::int32_t;  ///< index within one rank: owned entities first, then ghosts
using Global = std::int64_t; ///< index over all ranks

using Vec2 = Eigen::Vector2d;
using Vec3 = Eigen::Vector3d;
using Mat3 = Eigen::Matrix3d;

} // namespace taut
