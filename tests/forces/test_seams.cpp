// The force that sews: strings between vertices that may be on other ranks.
#include "src/forces/seam_force.hpp"
#include "tests/forces/differences.hpp"

using namespace taut;
using namespace taut::test;

namespace {

const std::vector<std::array<Global, 2>> seams{{12, 3}, {16, 0}, {20, 5}, {22, 5}, {23, 5}};

MeshSlab mesh_to_sew(MPI_Comm comm) {
  MeshSlab mesh = mixed_mesh(comm);
  for (Global v = 0; v < mesh.vertices.count; ++v) mesh.joint.push_back(mesh.vertices.first + v);
  for (const auto& [vertex, joint] : seams)
    if (mesh.vertices.contains(vertex)) mesh.joint[vertex - mesh.vertices.first] = joint;
  return mesh;
}

std::unique_ptr<Force> sew_in(const Bed& b, double seconds) {
  config::Sewing sewing;
  sewing.time = seconds;
  return std::make_unique<SeamForce>(b.cloth, b.pattern, sewing);
}

/// Strings of no length: in random states all pull with all their force.
std::unique_ptr<Force> closing(const Bed& b) { return sew_in(b, 1e-3); }
/// Strings as long as at the start.
std::unique_ptr<Force> beginning(const Bed& b) { return sew_in(b, 1e9); }

class Seams : public testing::Test {
protected:
  const Bed whole_{serial(mesh_to_sew)};

  /// Seams that are closed but for a hundredth of what counts as closed, where all else is anywhere.
  WholeState almost_closed() const {
    WholeState state = random_state(whole_, 0);
    const auto off = random_vectors(Global(seams.size()), 1e-6, 7);
    for (std::size_t k = 0; k < seams.size(); ++k)
      state.positions[seams[k][0]] = state.positions[seams[k][1]] + off[k];
    return state;
  }
};

} // namespace

TEST_F(Seams, PullAlongTheGradientOfTheirEnergy) {
  for (const MakeForce make : {closing, beginning}) expect_force_is_gradient(whole_, make);
}

TEST_F(Seams, PullNoMoreThanTheyMay) {
  const WholeState state = random_state(whole_, 0);
  const Column force = force_of(whole_, closing, state);
  const auto of = [&](Global v) { return force.segment<3>(3 * v).norm(); };
  EXPECT_NEAR(of(12), config::Sewing{}.force * seam_length_at(whole_.cloth, 12), 1e-12);
  EXPECT_EQ(of(1), 0.0);
}

TEST_F(Seams, StiffnessIsTheHessianWhereTheyHold) {
  const WholeState state = almost_closed();
  const Dense expected =
      derivative([&](const WholeState& s) { return Column(-force_of(whole_, closing, s)); }, state);
  const Dense found = step_of(whole_, closing, state, 1.0).matrix;
  // w = F/e in place of k where the difference steps out of e < F/k is not met: 1e-5 m against 4e-4 m.
  EXPECT_LT(relative_error(found, expected), difference_tolerance);
}

TEST_F(Seams, StiffnessIsAboveTheHessianWhereTheyPullWithAllTheirForce) {
  for (unsigned seed = 0; seed < states; ++seed) {
    const WholeState state = random_state(whole_, seed);
    const Dense rest = step_of(whole_, closing, state, 1.0).matrix - hessian_of(whole_, closing, state);
    const Column eigenvalues =
        Eigen::SelfAdjointEigenSolver<Dense>(0.5 * (rest + rest.transpose()), Eigen::EigenvaluesOnly)
            .eigenvalues();
    const double largest = eigenvalues[eigenvalues.size() - 1];
    EXPECT_GT(largest, 0.0);
    EXPECT_GT(eigenvalues[0], -difference_tolerance * largest);
  }
}

TEST_F(Seams, AreTheSameOnAnyPartition) {
  for (const MakeForce make : {closing, beginning}) {
    expect_same_on_any_partition(mesh_to_sew, whole_, make);
    expect_semi_definite(whole_, make);
  }
}

TEST_F(Seams, WidestIsFoundOnAnyPartition) {
  const WholeState state = random_state(whole_, 1);
  const OpenSeam expected = widest_seam(whole_.cloth, whole_.at(state), config::Sewing{});
  EXPECT_GT(expected.over_closed, 1);
  on_odd_partitions(mesh_to_sew, [&](DistributedMesh mesh) {
    const Bed bed(std::move(mesh));
    const OpenSeam found = widest_seam(bed.cloth, bed.at(state), config::Sewing{});
    EXPECT_EQ(found.vertex, expected.vertex);
    EXPECT_EQ(found.joint, expected.joint);
    EXPECT_EQ(found.distance, expected.distance);
  });
  EXPECT_EQ(widest_seam(whole_.cloth, whole_.at(almost_closed()), config::Sewing{}).over_closed < 1, true);
}

TEST_F(Seams, WhatCountsAsClosedGrowsUntilHalfWayToTheLimit) {
  config::Sewing sewing;
  State state = whole_.at(random_state(whole_, 1));
  const auto over_closed_at = [&](double time) {
    state.time = time;
    return widest_seam(whole_.cloth, state, sewing).over_closed;
  };
  const double at_first = over_closed_at(sewing.time),
               late = over_closed_at(0.5 * (sewing.time + sewing.limit));
  EXPECT_EQ(over_closed_at(0), at_first);
  EXPECT_NEAR(late * SeamForce::closed_late, at_first * SeamForce::closed, 1e-12 * at_first);
  EXPECT_EQ(over_closed_at(sewing.limit), late);
}
