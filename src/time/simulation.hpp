#pragma once
#include "src/constraints/strain_gauge.hpp"
#include "src/contact/solid_constraints.hpp"
#include "src/filters/velocity_filter.hpp"
#include "src/forces/stretch.hpp"
#include "src/state/resolve.hpp"
#include "src/time/implicit_euler.hpp"
#include "src/time/integrator.hpp"
#include "src/time/observer.hpp"
#include "src/time/step_size.hpp"
#include "src/time/xpbd.hpp"

#include <functional>

namespace taut {

enum class Ending { completed, interrupted, failed };

struct Outcome {
  Ending ending = Ending::completed;
  std::string reason; ///< why it is not completed

  bool completed() const { return ending == Ending::completed; }
};

/// A case in motion: prediction by the integrator, then the filters, then acceptance by measurement.
class Simulation {
public:
  /// Sets everything up; throws InputError for what is wrong with the case. Collective.
  Simulation(MPI_Comm comm, const Case& input);

  /// From the present state until the end time, until a step would have to be smaller than `time.min_step`,
  /// or until `stop`, asked between steps, says so on all ranks. Collective.
  Outcome run(std::span<Observer* const> observers, const std::function<bool()>& stop = never);

  /// Takes the place of another simulation of this case, between two of its steps. `state`: ghosts current.
  void restore(State state, const StepSize::Memory& steps, Global rejected_steps);

  /// Begins elsewhere than the case says; no step has been taken. `state`: ghosts current. Collective.
  void set_start(State state);

  /// One step from the present state, thrown away: the linear solvers are set up and have read all their
  /// options. Collective.
  void trial_step();

  const Cloth& cloth() const { return cloth_; }
  const Obstacles& obstacles() const { return obstacles_; }
  const State& state() const { return state_; }
  /// With all that the case leaves to the mesh.
  const config::Inextensibility& inextensibility() const { return resolved_.inextensibility; }
  /// Of every accepted step; none if nothing keeps one.
  std::optional<double> strain_limit() const { return resolved_.strain_limit; }
  double weight() const { return resolved_.weight; } ///< of the cloth, N
  const StrainGauge& gauge() const { return gauge_; }
  const Pins& pins() const { return pins_; }
  const Forces& forces() const { return forces_; }
  const StepSize& step_size() const { return step_size_; }
  Global rejected_steps() const { return rejected_steps_; }

private:
  struct Attempt {
    StepRecord record;
    std::string failure;     ///< empty if the step can be accepted
    bool too_costly = false; ///< as of FilterReport
  };
  static bool never() { return false; }
  Attempt attempt(double dt);
  StepStart start_of_step(double dt);
  void predict(const StepStart& start, Attempt& attempt);
  void filter(const StepStart& start, Attempt& attempt);
  bool all_finite(std::span<const Vec3> field) const;
  void add_pull_of_filters();
  double carried(double force_density) const;
  std::string fault_of(const Strain& strain) const;
  std::string fault_of_stretch() const;
  std::string place_of_fault(const StepRecord& record) const;
  bool limits_averages() const { return resolved_.inextensibility.constrain == config::Constrain::vertices; }
  void accept(double time, double dt);
  void measure(StepRecord& record) const;

  MPI_Comm comm_;
  Vec3 down_;
  Cloth cloth_;
  Obstacles obstacles_;
  Resolved resolved_;
  State state_;
  StrainGauge gauge_;
  Pins pins_;
  Pattern pattern_;
  std::optional<SolidConstraints> solids_; ///< with contact by penalty
  State altered_;                          ///< what a step with these starts from
  Forces forces_;
  std::vector<std::unique_ptr<VelocityFilter>> filters_;
  Integrator integrator_;
  ImplicitEuler predictor_;
  std::optional<Xpbd> xpbd_; ///< takes the place of prediction and filters
  StepSize step_size_;
  std::optional<double> max_stretch_change_;
  std::vector<Tangent> tangents_; ///< whose stretch is watched
  Global rejected_steps_ = 0;
  Candidate candidate_;
  Freedom freedom_;
  double start_depth_ = 0;
};

} // namespace taut
