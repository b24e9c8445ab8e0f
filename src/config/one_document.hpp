#pragma once
#include <yaml-cpp/yaml.h>

#include <optional>
#include <string>

namespace taut::config {

/// Where something else than the end follows the first YAML document of `text`. Throws YAML::Exception.
/// To be asked before YAML::LoadAll is: in "[1], 2" it finds documents without end.
std::optional<YAML::Mark> second_document(const std::string& text);

} // namespace taut::config
