#pragma once
#include "partition/types.hpp"

#include <algorithm>
#include <span>
#include <unordered_map>
#include <vector>

namespace taut {

/// In which directions the local vertices may move in a step [BW98 section 5.1]: the projector S_i is I for a
/// free vertex, 0 for one that is held, I - p p^T for one kept in a plane with the normal p, and q q^T for
/// one kept on a line along q. What lies in the other directions is prescribed.
class Freedom {
public:
  Freedom() = default;
  explicit Freedom(std::size_t vertices) : kind_(vertices, free) {}

  /// Vertices free (0) or held (not 0).
  explicit Freedom(std::span<const char> held) {
    for (const char h : held) kind_.push_back(h ? held_fast : free);
  }

  std::size_t size() const { return kind_.size(); }

  void free_all() {
    std::fill(kind_.begin(), kind_.end(), free);
    projectors_.clear();
  }
  void hold(Local v) { kind_[v] = held_fast; }
  /// Only along `axis`, of length one.
  void keep_on_line(Local v, const Vec3& axis) { restrict_to(v, axis * axis.transpose()); }
  /// Only across `normal`, of length one.
  void keep_in_plane(Local v, const Vec3& normal) {
    restrict_to(v, Mat3::Identity() - normal * normal.transpose());
  }

  bool all_free() const {
    return std::all_of(kind_.begin(), kind_.end(), [](char k) { return k == free; });
  }
  /// Whether a vertex may move in some directions but not in all.
  bool has_sliding() const { return !projectors_.empty(); }
  bool is_free(Local v) const { return kind_[v] == free; }
  bool is_held(Local v) const { return kind_[v] == held_fast; }

  /// Not 0 for every vertex that is not free in all directions.
  std::span<const char> held() const { return kind_; }

  /// S_i x.
  Vec3 allowed(Local v, const Vec3& x) const {
    return kind_[v] == free ? x : kind_[v] == held_fast ? Vec3(Vec3::Zero()) : Vec3(projectors_.at(v) * x);
  }
  /// (I - S_i) x.
  Vec3 denied(Local v, const Vec3& x) const {
    return kind_[v] == free ? Vec3(Vec3::Zero()) : Vec3(x - allowed(v, x));
  }
  Mat3 projector(Local v) const {
    return kind_[v] == free        ? Mat3(Mat3::Identity())
           : kind_[v] == held_fast ? Mat3(Mat3::Zero())
                                   : projectors_.at(v);
  }

private:
  static constexpr char free = 0, held_fast = 1, restricted = 2;

  void restrict_to(Local v, const Mat3& projector) {
    kind_[v] = restricted;
    projectors_[v] = projector;
  }

  std::vector<char> kind_;
  std::unordered_map<Local, Mat3> projectors_; ///< of restricted vertices
};

} // namespace taut
