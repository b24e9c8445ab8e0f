#include "partition/yarns.hpp"

#include "partition/fetch.hpp"

#include <algorithm>
#include <bit>
#include <map>
#include <numeric>

namespace taut {

namespace {

/// One of the two ends of a segment, as all ranks call it: the edge, and its vertex that looks outwards.
struct EndName {
  Global edge, vertex; ///< original numbers
  auto operator<=>(const EndName&) const = default;
};

struct Place {
  int rank = -1;
  Local segment = -1;
  int end = 0; ///< 0: at `begin`, 1: at `end - 1`
};

/// What lies beyond one end of a segment, up to and with the segment of `last`; built by doubling the
/// distance again and again.
struct Beyond {
  Place last; ///< the last segment seen, and the end by which to leave it
  EndName last_name;
  Global lowest;    ///< lowest original edge number seen
  Local count = 0;  ///< segments seen
  int finished = 0; ///< 1: the yarn ends at `last`
};

/// The edge that continues each local edge through its first and its second vertex, -1 for none.
std::vector<std::array<Local, 2>> continuations(const DistributedMesh& mesh) {
  std::vector<std::array<Local, 2>> next(mesh.edges.size(), {-1, -1});
  for (const auto& [before, centre, after] : mesh.triples) {
    const Local e = edge_between(mesh, centre, before), f = edge_between(mesh, centre, after);
    if (e < 0 || f < 0) continue;
    next[e][mesh.edge_vertices[e][0] == centre ? 0 : 1] = f;
    next[f][mesh.edge_vertices[f][0] == centre ? 0 : 1] = e;
  }
  return next;
}

class YarnFinder {
public:
  explicit YarnFinder(const DistributedMesh& mesh)
      : mesh_(mesh), rank_(rank_of(mesh.comm)), next_(continuations(mesh)) {}

  Yarns find() {
    chain_segments();
    if (cut_closed()) chain_segments();
    name_yarns();
    spread_knots();
    return std::move(yarns_);
  }

private:
  struct Segment {
    std::array<EndName, 2> name;
    std::array<EndName, 2> neighbour; ///< the end that continues here; edge -1 for none
    std::array<int, 2> neighbour_rank{-1, -1};
    std::array<Place, 2> link;           ///< the same as a place; rank -1 for none
    std::array<Local, 2> onward{-1, -1}; ///< its edge, as a local number
    Global lowest;
    std::array<Beyond, 2> beyond;
  };

  void chain_segments() {
    cut_into_segments();
    find_ends();
    join();
    measure();
  }

  void cut_into_segments() {
    yarns_.segments.clear();
    for (Local e = 0; e < mesh_.edges.owned; ++e) {
      const bool goes_on = e > 0 && (next_[e][0] == e - 1 || next_[e][1] == e - 1);
      if (!goes_on) yarns_.segments.push_back({e, e, -1, false, true});
      ++yarns_.segments.back().end;
    }
  }

  /// The vertex of the segment's edge at `end` that no other edge of the segment has.
  int outer_side(const YarnSegment& s, int end) const {
    if (s.size() == 1) return end;
    const auto& edge = mesh_.edge_vertices[end == 0 ? s.begin : s.end - 1];
    const auto& inner = mesh_.edge_vertices[end == 0 ? s.begin + 1 : s.end - 2];
    return edge[0] == inner[0] || edge[0] == inner[1] ? 1 : 0;
  }

  void find_ends() {
    segments_.clear();
    for (const YarnSegment& s : yarns_.segments) {
      Segment segment;
      segment.lowest =
          *std::min_element(mesh_.edges.original.begin() + s.begin, mesh_.edges.original.begin() + s.end);
      for (int end = 0; end < 2; ++end) {
        const Local edge = end == 0 ? s.begin : s.end - 1;
        const int side = outer_side(s, end);
        const Global vertex = mesh_.vertices.original[mesh_.edge_vertices[edge][side]];
        segment.name[end] = {mesh_.edges.original[edge], vertex};
        const Local onward = next_[edge][side];
        segment.neighbour[end] = {onward < 0 ? -1 : mesh_.edges.original[onward], vertex};
        segment.onward[end] = onward;
        if (onward >= 0)
          segment.neighbour_rank[end] =
              mesh_.owns_edge(onward) ? rank_ : mesh_.edges.ghost_owners[onward - mesh_.edges.owned];
      }
      segments_.push_back(segment);
    }
  }

  /// Asks `rank` about `question` for each of `asked`; answers come from `answer`, in order.
  template<class Answer, class Question, class Function>
  std::vector<Answer> ask(const std::vector<Question>& questions, const std::vector<int>& ranks,
                          Function&& answer) const {
    const auto heard = exchange(mesh_.comm, questions, ranks);
    std::vector<Answer> answers;
    std::vector<int> back;
    for (int r = 0; r < size_of(mesh_.comm); ++r)
      for (Global i = heard.offsets[r]; i < heard.offsets[r + 1]; ++i) {
        answers.push_back(answer(heard.items[i]));
        back.push_back(r);
      }
    const auto received = exchange(mesh_.comm, answers, back);
    std::vector<Global> at(received.offsets.begin(), received.offsets.end());
    std::vector<Answer> result;
    for (const int r : ranks) result.push_back(received.items[at[r]++]);
    return result;
  }

  template<class Visit>
  void for_each_end(Visit&& visit) {
    for (std::size_t s = 0; s < segments_.size(); ++s)
      for (int end = 0; end < 2; ++end) visit(segments_[s], Local(s), end);
  }

  /// Turns the names of neighbouring ends into places.
  void join() {
    std::map<EndName, Place> place_of;
    for_each_end([&](Segment& s, Local number, int end) { place_of[s.name[end]] = {rank_, number, end}; });
    std::vector<EndName> questions;
    std::vector<int> ranks;
    for_each_end([&](Segment& s, Local, int end) {
      if (s.neighbour_rank[end] < 0) return;
      questions.push_back(s.neighbour[end]);
      ranks.push_back(s.neighbour_rank[end]);
    });
    auto answers = ask<Place>(questions, ranks, [&](const EndName& name) { return place_of.at(name); });
    auto next = answers.begin();
    for_each_end([&](Segment& s, Local, int end) {
      if (s.neighbour_rank[end] >= 0) s.link[end] = *next++;
    });
  }

  /// Fills `beyond` by pointer doubling. Closed yarns do not finish.
  void measure() {
    for_each_end([&](Segment& s, Local number, int end) {
      s.beyond[end] = {{rank_, number, end}, s.name[end], s.lowest, 0, s.link[end].rank < 0};
    });
    const Global total = sum_over(mesh_.comm, Global(segments_.size()));
    const int rounds = 2 + std::bit_width(std::uint64_t(total));
    for (int round = 0; round < rounds && any_of(mesh_.comm, unfinished()); ++round)
      round == 0 ? first_look() : look_further();
  }

  bool unfinished() const {
    return std::any_of(segments_.begin(), segments_.end(),
                       [](const Segment& s) { return !s.beyond[0].finished || !s.beyond[1].finished; });
  }

  void first_look() {
    extend([](const Segment& s, int end) { return s.link[end]; },
           [this](const Place& entered) {
             const Segment& s = segments_[entered.segment];
             const int out = 1 - entered.end;
             return Beyond{{rank_, entered.segment, out}, s.name[out], s.lowest, 1, s.link[out].rank < 0};
           });
  }

  void look_further() {
    extend([](const Segment& s, int end) { return s.beyond[end].last; },
           [this](const Place& reached) { return segments_[reached.segment].beyond[reached.end]; });
  }

  /// Adds to every unfinished `beyond` what the segment at `place(segment, end)` answers.
  template<class PlaceOf, class Answer>
  void extend(PlaceOf&& place, Answer&& answer) {
    std::vector<Place> questions;
    std::vector<int> ranks;
    for_each_end([&](Segment& s, Local, int end) {
      if (s.beyond[end].finished) return;
      questions.push_back(place(s, end));
      ranks.push_back(questions.back().rank);
    });
    const auto answers = ask<Beyond>(questions, ranks, answer);
    auto next = answers.begin();
    for_each_end([&](Segment& s, Local, int end) {
      Beyond& b = s.beyond[end];
      if (b.finished) return;
      const Beyond& further = *next++;
      b = {further.last, further.last_name, std::min(b.lowest, further.lowest), b.count + further.count,
           further.finished};
    });
  }

  /// Cuts each closed yarn at the first vertex of its lowest edge, on both sides of the cut. True if there
  /// were any.
  bool cut_closed() {
    bool any = false;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const Segment& s = segments_[i];
      if (s.beyond[0].finished) continue;
      any = true;
      const Global lowest = std::min(s.lowest, s.beyond[0].lowest);
      for (Local e = yarns_.segments[i].begin; e < yarns_.segments[i].end; ++e)
        for (int side = 0; side < 2; ++side)
          if (is_cut(lowest, e, side)) next_[e][side] = -1;
    }
    return any_of(mesh_.comm, any);
  }

  /// Whether edge e ends on this side where the yarn with this lowest edge is to be cut.
  bool is_cut(Global lowest, Local e, int side) const {
    const Local f = next_[e][side];
    if (mesh_.edges.original[e] == lowest) return side == 0;
    return f >= 0 && mesh_.edges.original[f] == lowest &&
           mesh_.edge_vertices[f][0] == mesh_.edge_vertices[e][side];
  }

  /// Number, direction and owner of the yarn of each segment.
  void name_yarns() {
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const auto& beyond = segments_[i].beyond;
      YarnSegment& s = yarns_.segments[i];
      s.yarn = std::min({segments_[i].lowest, beyond[0].lowest, beyond[1].lowest});
      s.cut = beyond[0].count + beyond[1].count > 0;
      s.runs_forward = !s.cut || (beyond[0].last_name < beyond[1].last_name) == (s.yarn % 2 == 0);
      if (!s.cut || beyond[s.runs_forward ? 0 : 1].count == 0) ++yarns_.count;
    }
    yarns_.count = sum_over(mesh_.comm, yarns_.count);
  }

  void spread_knots() {
    struct Knot {
      Global yarn;
      Local position; ///< two for each segment before
    };
    std::vector<Knot> sent;
    std::vector<int> owners;
    for (std::size_t i = 0; i < segments_.size(); ++i) {
      const YarnSegment& s = yarns_.segments[i];
      if (!s.cut) continue;
      const int start_end = s.runs_forward ? 0 : 1;
      const Beyond& to_start = segments_[i].beyond[start_end];
      for (Local k = 0; k < std::min<Local>(s.size(), 2); ++k) {
        yarns_.knots.push_back((k == 0) == s.runs_forward ? s.begin : s.end - 1);
        yarns_.before_knot.push_back(k == 0 && to_start.count > 0 ? segments_[i].onward[start_end] : -1);
        sent.push_back({s.yarn, 2 * to_start.count + k});
        owners.push_back(to_start.last.rank);
      }
    }
    const auto held = exchange(mesh_.comm, sent, owners).items;
    std::vector<Local> order(held.size()), place(held.size());
    std::iota(order.begin(), order.end(), 0);
    std::sort(order.begin(), order.end(), [&](Local a, Local b) {
      return std::pair(held[a].yarn, held[a].position) < std::pair(held[b].yarn, held[b].position);
    });
    for (std::size_t k = 0; k < order.size(); ++k) {
      place[order[k]] = Local(k);
      yarns_.starts_yarn.push_back(k == 0 || held[order[k]].yarn != held[order[k - 1]].yarn);
    }
    yarns_.owned_knots = Local(held.size());
    std::vector<Local> index(sent.size());
    std::iota(index.begin(), index.end(), 0);
    yarns_.to_owner = Plan(mesh_.comm, owners, index, std::move(place));
  }

  const DistributedMesh& mesh_;
  int rank_;
  std::vector<std::array<Local, 2>> next_; ///< continuations, less those at which closed yarns are cut
  Yarns yarns_;
  std::vector<Segment> segments_;
};

} // namespace

Yarns find_yarns(const DistributedMesh& mesh) { return YarnFinder(mesh).find(); }

} // namespace taut
