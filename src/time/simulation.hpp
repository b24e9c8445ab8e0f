#pragma once
#include "src/state/start.hpp"
#include "src/time/acceptance.hpp"
#include "src/time/observer.hpp"
#include "src/time/relaxed.hpp"
#include "src/time/step_size.hpp"
#include "src/time/stepper.hpp"
#include "src/time/stepper_parts.hpp"

#include <functional>

namespace taut {

enum class Ending { completed, interrupted, failed };

struct Outcome {
  Ending ending = Ending::completed;
  std::string reason; ///< why it is not completed

  bool completed() const { return ending == Ending::completed; }
};

/// A case in motion: a stepper proposes, measurement accepts, observers watch.
class Simulation {
public:
  /// Sets everything up; throws InputError for what is wrong with the case. Collective.
  Simulation(MPI_Comm comm, const Case& input, const Cut& cut = cut_at_start);

  /// From the present state until the end time, until a step would have to be smaller than `time.min_step`,
  /// until `stop`, asked between steps, says so on all ranks, or until `finished`, asked after each frame,
  /// does. Collective.
  Outcome run(std::span<Observer* const> observers, const std::function<bool()>& stop = never,
              const std::function<bool()>& finished = never);

  /// Takes the place of another simulation of this case, between two of its steps. `state`: ghosts current.
  void restore(State state, const StepSize::Memory& steps, Global rejected_steps);

  /// Begins elsewhere than the case says; no step has been taken. `state`: ghosts current. Collective.
  void set_start(State state);

  /// Takes a start that is strained beyond its limits back within them, by steps that begin at rest: they
  /// move the cloth, and no time passes. What is strained by more than `most_strain_of_start` is left as it
  /// is. Collective.
  Relaxed relax();
  double strain_over_limit() const; ///< the largest, of single triangles over theirs too; 0 without limit
  /// Of what a user gives: more tells of wrong units. Garments, which are sewn or carried to where they
  /// begin, have single edges that are gathered, or collapsed where outlines were cut off by a coarse mesh.
  double most_strain_of_start() const;

  /// One step from the present state, thrown away: the linear solvers are set up and have read all their
  /// options. Returns what it took. Collective.
  StepReport trial_step();

  const Cloth& cloth() const { return cloth_; }
  const Obstacles& obstacles() const { return obstacles_; }
  const State& state() const { return state_; }
  /// With all that the case leaves to the mesh.
  const config::Inextensibility& inextensibility() const { return resolved_.inextensibility; }
  /// Of every accepted step; none if nothing keeps one.
  std::optional<double> strain_limit() const { return acceptance_.strain_limit(); }
  std::optional<double> faces_limit() const { return resolved_.faces_limit; } ///< of single triangles
  double weight() const { return resolved_.weight; }                          ///< of the cloth, N
  const StrainGauge& gauge() const { return acceptance_.gauge(); }
  const Pins& pins() const { return pins_; }
  const Forces& forces() const { return forces_; }
  const StepSize& step_size() const { return step_size_; }
  Global rejected_steps() const { return rejected_steps_; }

private:
  struct Attempt {
    StepReport report;
    Strain strain;
  };
  static bool never() { return false; }
  Attempt attempt(double dt);
  std::string place_of_fault(const Strain& strain, double dt) const;
  void accept(double time, double dt);
  void grow_bodies();
  void measure(StepRecord& record) const;

  Vec3 down_;
  Cloth cloth_;
  Obstacles obstacles_;
  Resolved resolved_;
  State state_;
  Acceptance acceptance_;
  Pins pins_;
  Pattern pattern_;
  Forces forces_;
  std::unique_ptr<Stepper> stepper_;
  StepSize step_size_;
  Global rejected_steps_ = 0;
  Candidate candidate_;
};

} // namespace taut
