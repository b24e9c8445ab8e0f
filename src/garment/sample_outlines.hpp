#pragma once
#include "src/garment/sewing_pattern.hpp"

#include <map>
#include <string>
#include <vector>

namespace taut::garment {

/// How long the edges of the mesh are to be, m.
struct EdgeLengths {
  double garment = 0.01;
  std::map<std::string, double> panels; ///< by name; they come before those of the pattern
};

/// Throws `InputError` for a panel that the pattern does not have.
void check_edge_lengths(const EdgeLengths& lengths, const SewingPattern& pattern);

double edge_length_of(const EdgeLengths& lengths, const Panel& panel);

/// Points on the loop of a panel, in its order and its plane, m. Those of edge k begin with point first[k]
/// and end with the first of edge k + 1. An edge much shorter than those of the mesh is one point, the first
/// of the next; first[k] of the last edge is then the number of points.
struct Outline {
  std::vector<Vec2> points;
  std::vector<int> first;

  /// The points of an edge, both ends with it, as numbers.
  std::vector<int> of_edge(int edge) const;
};

/// Cuts all edges of all panels into segments about as long as the panel's edge length (0.6 to 1.25 times),
/// equal along an edge. The two edges of a seam get the same number, at the same parts of their lengths: as
/// many as the one that needs more. Next to shorter segments, of a short edge or a finer panel, segments
/// grow, so that neighbours differ by a factor of about two at most. Edges much shorter than that become
/// points (short_edges.hpp).
std::vector<Outline> sample_outlines(const SewingPattern& pattern, const EdgeLengths& lengths);

} // namespace taut::garment
