#pragma once
#include "src/config/choices.hpp"

#include <optional>
#include <vector>

/// How a case is advanced in time and written, see case.hpp.
namespace taut::config {

struct Time {
  double end = 1;                             ///< s
  double frame_rate = 30;                     ///< Hz
  std::optional<double> until_rest{};         ///< m/s; absent: until `end`
  double max_step = 0.01;                     ///< s
  double min_step = 1e-6;                     ///< s
  std::optional<double> max_stretch_change{}; ///< absent: any
  Integrator integrator = Integrator::implicit_euler;
  bool operator==(const Time&) const = default;
};

struct Velocity {
  LinearSolver solver = LinearSolver::cg;
  std::optional<double> tolerance; ///< absent: see ImplicitEuler
  int max_iterations = 1000;
  ConstraintSolver constraints = ConstraintSolver::projected;
  bool operator==(const Velocity&) const = default;
};

/// Of methods shake and rattle.
struct Shake {
  ShakeMatrix matrix = ShakeMatrix::newton;
  bool operator==(const Shake&) const = default;
};

/// Of methods jacobi and gauss_seidel.
struct Limiting {
  int max_sweeps = 5000;
  bool must_reach_limit = true;
  bool operator==(const Limiting&) const = default;
};

struct Xpbd {
  int substeps = 20;
  bool operator==(const Xpbd&) const = default;
};

struct Springs {
  double stiffness = 1000; ///< N
  bool operator==(const Springs&) const = default;
};

struct Inextensibility {
  InextensibilityMethod method = InextensibilityMethod::fast_projection;
  std::optional<Constrain> constrain; ///< absent: see constrain_of
  double strain = 0.01;
  double faces = 5;                   ///< of single triangles under averages, in strains
  std::optional<LinearSolver> solver; ///< absent: see resolve
  int max_iterations = 20;
  double residual = 0.3; ///< of newton
  bool carried_tension = true;
  std::optional<double> compliance;  ///< 1/N; absent: see EdgeConstraints
  bool may_bound_compliance = false; ///< no key: set where the default is put in, see compliance_bounds
  std::optional<Shake> shake;        ///< the blocks of single methods; absent: their defaults
  std::optional<Limiting> limiting;
  std::optional<Xpbd> xpbd;
  std::optional<Springs> springs;
  bool operator==(const Inextensibility&) const = default;
};

struct Partition {
  PartitionMethod method = PartitionMethod::metis;
  bool operator==(const Partition&) const = default;
};

/// When to write what a run can be resumed from; 0 is never. The end of a run always is.
struct Checkpoint {
  int every_steps = 0;
  double every_time = 0;            ///< s, simulated
  std::optional<double> every_wall; ///< s, on the clock; absent: as is cheap
  bool operator==(const Checkpoint&) const = default;
};

struct Output {
  std::vector<Field> fields{Field::position, Field::velocity, Field::owner_rank, Field::strain,
                            Field::tension,  Field::reaction, Field::contact,    Field::yarn};
  std::vector<FrameFormat> formats{FrameFormat::xdmf};
  bool operator==(const Output&) const = default;
};

} // namespace taut::config
