#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace taut::config {

/// A cloth known by name.
struct Fabric {
  std::string_view name;
  double density;          ///< kg/m^2
  double bending;          ///< N m
  double shear;            ///< N/m per radian of shear angle
  std::string_view source; ///< where the numbers are from and how they were computed
};

std::span<const Fabric> fabrics();
std::vector<std::string> fabric_names();

/// nullptr if there is none of this name.
const Fabric* find_fabric(std::string_view name);

} // namespace taut::config
