#pragma once
#include "partition/distributed_mesh.hpp"

namespace taut {

/// The part of a yarn that lies on this rank: owned edges [begin, end), in their order along the yarn. A yarn
/// that leaves a rank and comes back has several segments there.
struct YarnSegment {
  Local begin, end;
  Global yarn;       ///< original number of the lowest edge of the yarn: the same on all its segments
  bool cut;          ///< the yarn has other segments, here or on other ranks
  bool runs_forward; ///< begin is nearer to the start of the yarn than end - 1; of an uncut one always

  Local size() const { return end - begin; }
};

/// The yarns of a mesh: maximal chains of constrained edges that go straight on through regular vertices (see
/// YarnTriple), found in parallel and the same for any partition. A closed yarn is cut open where its lowest
/// edge has its lower vertex, in original numbers.
///
/// Each cut yarn has one owner, the rank at one of its two ends, chosen so that yarns spread evenly. The end
/// edges of its segments (one for a segment of a single edge), in order along the yarn, are its knots. An
/// owner holds the knots of its yarns one yarn after the other.
struct Yarns {
  std::vector<YarnSegment> segments; ///< in the order of their edges
  std::vector<Local>
      knots; ///< edges of this rank's cut segments that are knots: segment by segment, along the yarn
  std::vector<Local>
      before_knot; ///< the local edge that precedes each knot on another segment of the yarn; -1: none does
  Plan to_owner;   ///< from values at `knots` to values at the owners' knots
  Local owned_knots = 0;         ///< how many knots this rank holds as an owner
  std::vector<char> starts_yarn; ///< of owned knots: 1 where a yarn begins
  Global count = 0;              ///< yarns over all ranks

  /// Edges of all segments: the owned ones.
  std::size_t edges() const { return segments.empty() ? 0 : std::size_t(segments.back().end); }
};

/// Collective.
Yarns find_yarns(const DistributedMesh& mesh);

/// The yarn of every local edge, numbered from 0 in the order of the yarns' lowest edges: the same for any
/// partition. Collective.
std::vector<Global> yarn_numbers(const DistributedMesh& mesh, const Yarns& yarns);

} // namespace taut
