#pragma once
#include "src/contact/obstacles.hpp"
#include "src/forces/force.hpp"
#include "src/forces/string_law.hpp"

namespace taut {

/// What is fastened: strings between vertices of the cloth (buttons, stitches), and between a vertex and the
/// place where it started on a body that moves. Each becomes as short as the case wants it, smoothly in a
/// time, and pulls by StringLaw: with all its force where it is `held` too long. So no attachment strains
/// cloth by more than its force does, and the limit of strain is kept as elsewhere.
class Attachments : public Force {
public:
  static constexpr double held = 1e-3; ///< m

  /// `start` are the places of local vertices at the start; all else must outlive the force. Throws
  /// InputError for a label that is not there. Not collective.
  Attachments(const Cloth& cloth, const Obstacles& obstacles, const Pattern& pattern, const Case& input,
              std::span<const Vec3> start);

  std::string_view name() const override { return "attachments"; }
  double energy(const State& state) const override;
  void add_to(StepSystem& system, const State& state) override; ///< at the end of the step

private:
  struct Tie {
    std::size_t attachment;
    std::array<Local, 2> ends;
    double length; ///< m, at the start
    Pattern::Slots<2> slots;
  };
  struct Hold {
    std::size_t attachment;
    std::array<Local, 1> vertex;
    Obstacles::Anchor anchor;
    Pattern::Slots<1> slots;
  };
  void add_ties(const Pattern& pattern, std::span<const Vec3> start);
  void add_holds(const Pattern& pattern, std::size_t k, const std::string& key, int body,
                 std::span<const Vec3> start);
  bool is_open(std::size_t attachment, double time) const;
  double length_at(const Tie& tie, double time) const;

  const Cloth& cloth_;
  const Obstacles& obstacles_;
  std::vector<config::Attachment> attachments_;
  std::vector<StringLaw> laws_; ///< of each
  std::vector<Tie> ties_;
  std::vector<Hold> holds_;
};

} // namespace taut
