#pragma once
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace taut::config {

/// Cusick's drape coefficient, %, between the bounds that are published.
struct DrapeBand {
  int low = 0, high = 0;
  std::string_view source{}; ///< empty: none was found
};

/// A cloth known by name.
struct Fabric {
  std::string_view name;
  double density;          ///< kg/m^2
  double bending;          ///< N m
  double shear;            ///< N/m per radian of shear angle
  std::string_view source; ///< where the numbers are from and how they were computed
  DrapeBand published;
  int drape; ///< %, which this program had (scripts/validate cusick)
};

/// Whether its own drape is that of the cloths it is called after, in a word or two.
std::string_view verdict(const Fabric& fabric);

/// All of them in Markdown.
std::string fabric_table();

std::span<const Fabric> fabrics();
std::vector<std::string> fabric_names();

/// nullptr if there is none of this name.
const Fabric* find_fabric(std::string_view name);

} // namespace taut::config
