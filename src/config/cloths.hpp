#pragma once
#include "src/config/case.hpp"

/// Which cloth or obstacle of a case is meant.
namespace taut::config {

/// The number of the cloth with this name, or with this number; none if there is no such cloth.
std::optional<std::size_t> find_cloth(const Case& input, const std::string& name);

/// Its name, or "cloth 1".
std::string name_of_cloth(const Case& input, std::size_t k);

/// What a panel of a cloth is made of. A fabric of its own has no stiffnesses of weft and twist from the
/// cloth.
Material material_of(const Material& cloth, const Panel& panel);

/// Where the keys of a cloth stand: "cloth", or "cloths.1".
std::string key_of_cloth(const Case& input, std::size_t k);

/// A mistake in a case: at which key, and what to do.
struct Fault {
  std::string key, cure;
};

/// Names that do not tell cloths apart, pins on a cloth that is not there.
std::optional<Fault> fault_of_cloths(const Case& input);

/// The number of the obstacle with this name, or with this number; none if there is no such obstacle.
std::optional<std::size_t> find_obstacle(const Case& input, const std::string& name);

/// Attachments to an obstacle that is not there.
std::optional<Fault> fault_of_attachments(const Case& input);

} // namespace taut::config
