#pragma once
#include "src/garment/curve.hpp"

#include <array>
#include <optional>
#include <string>
#include <vector>

/// A sewing pattern: flat panels, where they are placed around the body, and which of their edges are sewn
/// together. As plain data, in SI units.
namespace taut::garment {

/// A side of a panel.
struct PatternEdge {
  Curve curve; ///< in the plane of the panel; begins exactly where the edge before ends
  std::string label;
  std::string place; ///< "file:line:column", for messages
};

/// A place on a panel that has a label, such as that of a button.
struct PatternPoint {
  std::string label;
  Vec2 at; ///< m, in the plane of the panel
  std::string place;
};

/// A piece of cloth, bounded by one closed loop of edges. Seen from its right side (the outer one) the loop
/// runs counter-clockwise: where it does so in the panel's plane, the right side faces the normal (0, 0, 1),
/// else (0, 0, -1).
struct Panel {
  std::string name, label;
  std::string place;
  std::vector<PatternEdge> edges;
  std::vector<PatternPoint> points;
  Vec3 translation = Vec3::Zero(); ///< m; where the plane stands: p = rotation (x, y, 0) + translation
  Mat3 rotation = Mat3::Identity();
  double grain = 0;                  ///< rad: warp runs along the y axis turned by this, counter-clockwise
  std::optional<double> edge_length; ///< m, of its mesh; absent: that of the garment
};

/// An edge of a panel, both counted from 0.
struct SeamSide {
  int panel = 0, edge = 0;
  bool operator==(const SeamSide&) const = default;
};

/// Which end of the second edge is sewn to the start of the first: its end, so that both right sides come to
/// lie on the same side; or its start, so that the right side of one continues the wrong side of the other.
enum class SeamDirection { start_to_end, start_to_start };

/// Two edges that are sewn together from end to end; gathered, where they differ in length. Two edges of one
/// panel make a dart.
struct Seam {
  std::array<SeamSide, 2> sides;
  SeamDirection direction = SeamDirection::start_to_end;
  std::string place;
};

struct SewingPattern {
  std::string name; ///< how messages call it: the file
  std::vector<Panel> panels;
  std::vector<Seam> seams; ///< no edge is in two of them
};

/// The area inside the outline, m^2: positive if the loop runs counter-clockwise.
double signed_area(const Panel& panel);

/// The edges that are in no seam, panel by panel.
std::vector<SeamSide> unsewn_edges(const SewingPattern& pattern);

/// "collar.3": an edge, as messages and files call it.
std::string name_of(const SewingPattern& pattern, const SeamSide& side);

/// "collar.3-front.1".
std::string name_of(const SewingPattern& pattern, const Seam& seam);

} // namespace taut::garment
