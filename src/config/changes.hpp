#pragma once
#include "src/config/case.hpp"

namespace taut {

/// A key that two cases differ in; values as YAML, "none" where a case does not have the key.
struct KeyChange {
  std::string key; ///< "time.max_step", "pins.0.release"
  std::string before, after;
};

/// All of them, in the order of the case file.
std::vector<KeyChange> changes_between(const Case& before, const Case& after);

} // namespace taut
