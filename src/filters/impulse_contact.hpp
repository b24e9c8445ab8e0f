#pragma once
#include "src/contact/contact_scene.hpp"
#include "src/contact/thickness.hpp"
#include "src/filters/velocity_filter.hpp"

#include <map>
#include <optional>

namespace taut {

/// Contact by impulses, as [G07 section 4] hands it to a collision filter: first repulsions between features
/// nearer than the thickness, then impulses on pairs that would meet in the step [Bridson, Fedkiw, Anderson
/// 2002], at last all pairs that were about to meet together, as one impact zone [Harmon et al. 2008]. When
/// it has the last word, no pair meets on the straight way from the start of the step to its end; it knows
/// nothing of strain. All impulses are inelastic, with Coulomb's friction.
///
/// In a round all pairs push at the same time, each by its impulse over the number of pairs that push the
/// busiest of its vertices, so that the result depends neither on an order nor on the partition.
class ImpulseContact : public VelocityFilter {
public:
  /// `cloth` and `obstacles` must outlive the filter. Throws InputError for a thickness that the mesh cannot
  /// have. Collective.
  ImpulseContact(const Cloth& cloth, const Obstacles& obstacles, const Case& input);

  FilterReport apply(const State& start, double dt, const Freedom& freedom, Candidate& candidate) override;

private:
  /// Two features that are to part: direction . sum_i weights[i] u_i >= wanted, for displacements u.
  struct Impact {
    std::array<Local, 4> vertices;
    std::array<double, 4> weights;
    Vec3 direction;
    double inverse_effective_mass; ///< 1/kg
    double wanted;                 ///< m
    double friction;
    Vec3 spin; ///< m, of the body's surface
  };
  using Zone = std::map<ContactKey, Impact>;

  void begin(const State& start, double dt, const Freedom& freedom, const Candidate& candidate);
  void update_pairs();
  void take_displacements();
  std::optional<Impact> impact(const Pair& pair, const Approach& approach, double wanted) const;
  std::vector<Impact> too_near() const;
  std::vector<Impact> meetings(Zone& zone) const;
  Vec3 parting(const Impact& impact) const;
  void push_apart(std::span<const Impact> impacts);
  void part_all(const Zone& zone);
  void spread(std::span<const Impact> impacts, std::span<const double> sizes);

  ContactScene scene_;
  config::Contact contact_;
  Thickness thickness_;
  bool is_last_; ///< and so must leave nothing that meets

  // of the step in hand
  const Freedom* freedom_ = nullptr;
  std::vector<Vec3> displacement_; ///< m, a contact field
  std::vector<Vec3> push_;         ///< kg m, a contact field
  std::vector<Vec3> pushed_;       ///< kg m, of owned vertices, over the step
};

} // namespace taut
