// Fast Projection as a library.
#include "src/constraints/strain_gauge.hpp"
#include "src/filters/project.hpp"
#include "tests/support.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

using namespace taut;
using namespace taut::test;

namespace {

MeshSlab grid(MPI_Comm comm) { return make_grid(comm, {0.8, 0.6}, {9, 7}); }
MeshSlab dumbbell(MPI_Comm comm) { return make_line(comm, 0.5, 2); }

/// Values of local vertices by original number; what stands at ghosts is not to be read.
template<class T>
std::vector<T> owned_only(const IndexMap& map, const std::vector<T>& all, const T& at_ghosts) {
  std::vector<T> values = local(map, all);
  std::fill(values.begin() + map.owned, values.end(), at_ghosts);
  return values;
}

const Vec3 nowhere = Vec3::Constant(1e3);

std::vector<Vec3> moved_grid() {
  std::vector<Vec3> x = random_vectors(63, 0.03, 8);
  for (Global v = 0; v < 63; ++v) x[v] += Vec3(0.1 * double(v % 9), 0.1 * double(v / 9), 0);
  return x;
}

std::vector<double> uneven_masses() {
  std::vector<double> masses = random_numbers(63, 0.05, 3);
  for (double& m : masses) m += 0.1;
  return masses;
}

Column result(const DistributedMesh& mesh, const std::vector<double>& masses, const ProjectOptions& options) {
  const IndexMap& map = mesh.vertices;
  const auto x =
      project(mesh, owned_only(map, masses, -1.0), owned_only(map, moved_grid(), nowhere), options);
  std::vector<Vec3> current = x; // ghosts too
  mesh.vertex_halo.update(current);
  EXPECT_EQ(x, current);
  return gather<Vec3>(mesh.comm, map, x);
}

double strain_of(const Column& x) {
  const Cloth cloth = make_cloth(serial(grid), config::Material{});
  std::vector<Vec3> positions;
  for (const Global v : cloth.mesh.vertices.original) positions.emplace_back(x.segment<3>(3 * v));
  return measure_strain(cloth, positions).max;
}

/// The message of the error that `function` ends with.
template<class Error, class Function>
std::string message_of(const Function& function) {
  try {
    function();
  } catch (const Error& e) {
    return e.what();
  }
  return "no error";
}

} // namespace

TEST(Project, ReachesTheLimitAtAnyRankCountAndKeepsHeldVertices) {
  std::vector<double> masses = uneven_masses();
  masses[0] = masses[40] = held;
  for (const auto solver : {config::LinearSolver::cg, config::LinearSolver::mumps}) {
    const ProjectOptions options{.strain = 1e-6, .solver = solver};
    const Column alone = result(serial(grid), masses, options);
    EXPECT_LE(strain_of(alone), 1e-6);
    on_odd_partitions(grid, [&](const DistributedMesh& mesh) {
      const Column found = result(mesh, masses, options);
      EXPECT_LE(strain_of(found), 1e-6);
      EXPECT_LT((found - alone).cwiseAbs().maxCoeff(), 1e-6);
      for (const Global v : {0, 40}) EXPECT_EQ(Vec3(found.segment<3>(3 * v)), moved_grid()[v]);
    });
  }
}

TEST(Project, KeepsTheCentreOfMassOfAFreeCloth) {
  const std::vector<double> masses = uneven_masses();
  on_odd_partitions(grid, [&](const DistributedMesh& mesh) {
    const Column end = result(mesh, masses, {.strain = 1e-4});
    Vec3 moment = Vec3::Zero();
    for (Global v = 0; v < 63; ++v) moment += masses[v] * (end.segment<3>(3 * v) - moved_grid()[v]);
    EXPECT_LT(moment.norm(), 1e-14);
  });
}

// Two masses at the ends of a stretched edge are pulled together along it, each by the other's share.
TEST(Project, SharesTheWayByTheMasses) {
  on_odd_partitions(dumbbell, [](const DistributedMesh& mesh) {
    const IndexMap& map = mesh.vertices;
    const std::vector<Vec3> candidate{{1, 1, 0}, {1, 1, 1.5}};
    const auto x = project(mesh, owned_only(map, {1.0, 3.0}, -1.0), owned_only(map, candidate, nowhere),
                           {.strain = 1e-12});
    const Column end = gather<Vec3>(mesh.comm, map, x);
    EXPECT_LT((end.segment<3>(0) - Vec3(1, 1, 0.75)).norm(), 1e-10);
    EXPECT_LT((end.segment<3>(3) - Vec3(1, 1, 1.25)).norm(), 1e-10);
  });
}

TEST(Project, AProjectorCanBeUsedAgain) {
  const std::vector<double> masses = uneven_masses();
  on_odd_partitions(grid, [&](const DistributedMesh& mesh) {
    const IndexMap& map = mesh.vertices;
    Projector projector(mesh, local(map, masses), {.strain = 1e-5});
    const auto first = projector.project(local(map, moved_grid()));
    projector.project(local(map, random_vectors(63, 0.2, 9)));
    EXPECT_EQ(projector.project(local(map, moved_grid())), first);
  });
}

// All of it on all ranks, whichever rank is at fault.
TEST(Project, SaysWhatIsWrong) {
  const DistributedMesh mesh = distribute_by(world, dumbbell(world), {0, 0});
  const std::vector<double> masses(mesh.vertices.size(), 1.0);
  const std::vector<Vec3> rest = mesh.rest_positions;
  const auto input_error = [&](const std::vector<double>& m, const std::vector<Vec3>& x,
                               const ProjectOptions& options) {
    return message_of<InputError>([&] { project(mesh, m, x, options); });
  };
  std::vector<double> negative = masses, few = masses;
  std::vector<Vec3> lost = rest;
  if (rank_of(world) == 0) {
    negative[0] = 0;
    few.pop_back();
    lost[0][1] = NAN;
  }
  EXPECT_THAT(input_error(negative, rest, {}),
              testing::MatchesRegex("project: the mass of vertex [01] is 0; it must be above 0, or `held`"));
  EXPECT_EQ(input_error(few, rest, {}),
            "project: there are 1 masses on a rank with 2 local vertices; give one for each");
  EXPECT_EQ(input_error(masses, lost, {}), "project: the candidate holds a position that is not a number");
  EXPECT_EQ(input_error(masses, rest, {.strain = 0}), "project: options.strain must be above 0 and below 1");
  EXPECT_EQ(input_error(masses, rest, {.max_iterations = 0}),
            "project: options.max_iterations must be at least 1");
  EXPECT_EQ(input_error(masses, rest, {.compliance = -1}),
            "project: options.compliance must not be negative");
  EXPECT_EQ(input_error(masses, rest, {.dt = 0}), "project: options.dt must be above 0");

  std::vector<Vec3> far = rest;
  for (Local i = 0; i < mesh.vertices.size(); ++i) far[i] *= 10;
  const std::string failure =
      message_of<ProjectionError>([&] { project(mesh, masses, far, {.max_iterations = 1}); });
  EXPECT_THAT(failure, testing::StartsWith("fast projection left a strain of "));
}
