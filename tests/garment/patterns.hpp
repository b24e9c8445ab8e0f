#pragma once
// Small patterns, and what a reader says of wrong ones.
#include "partition/error.hpp"
#include "src/garment/garment_mesh.hpp"
#include "src/garment/read_pattern.hpp"

#include <fstream>
#include <sstream>
#include <string>

namespace taut::test {

/// Read and checked.
inline garment::SewingPattern pattern_of(const std::string& text, const std::string& name = "shirt.yaml") {
  auto pattern = garment::parse_pattern(text, name);
  garment::check_panels(pattern);
  return pattern;
}

/// Of the sources.
inline garment::SewingPattern pattern_in(const std::string& file) {
  const std::string path = std::string(TAUT_SOURCE_DIR) + "/" + file;
  std::ifstream in(path);
  std::ostringstream all;
  all << in.rdbuf();
  return pattern_of(all.str(), path);
}

/// What comes of a pattern, up to its mesh with edges of this length.
inline std::string message_of(const std::string& text, double edge = 0.01,
                              const std::string& name = "shirt.yaml") {
  try {
    mesh_garment(pattern_of(text, name), {edge, {}});
  } catch (const InputError& error) {
    return error.what();
  }
  return "no error";
}

/// The lines of a panel: a rectangle from the origin.
inline std::string rectangle(const std::string& name, double width, double height,
                             const std::string& more = "") {
  std::ostringstream text;
  text << "  " << name << ":\n    vertices: [[0, 0], [" << width << ", 0], [" << width << ", " << height
       << "], [0, " << height
       << "]]\n    edges: [{endpoints: [0, 1]}, {endpoints: [1, 2]}, {endpoints: [2, 3]}, {endpoints: [3, "
       << "0]}]\n"
       << more;
  return text.str();
}

/// A panel of one edge with this curvature and a straight one back.
inline std::string curved(const std::string& curvature) {
  return "panels: {a: {vertices: [[0, 0], [1, 0]], edges: [{endpoints: [0, 1], curvature: " + curvature +
         "}, {endpoints: [1, 0]}]}}\n";
}

} // namespace taut::test
