#pragma once
#include <nlohmann/json.hpp>

namespace taut::config {

/// The JSON Schema behind `case_schema` and `case_table`, keys in the order of describe.hpp. Beyond the
/// standard: "x-unit", the unit of a number or of the numbers in a list; "x-default", a default that is not a
/// constant, in words.
nlohmann::ordered_json schema();

} // namespace taut::config
