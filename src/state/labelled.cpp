#include "src/state/labelled.hpp"

#include <fmt/format.h>

namespace taut {

std::vector<Global> labelled(std::span<const Piece> pieces, const std::string& label,
                             const std::string& key) {
  garment::Labels labels;
  for (const Piece& piece : pieces)
    for (const auto& [name, vertices] : piece.parts.labels)
      for (const Global v : vertices) labels[name].push_back(piece.first_vertex + v);
  const auto found = labels.find(label);
  if (found == labels.end())
    throw InputError(fmt::format("{}: {}", key, garment::no_such_label(labels, label)));
  return found->second;
}

} // namespace taut
