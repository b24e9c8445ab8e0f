// What is fastened: strings between vertices that may be on other ranks, and to bodies that move.
#include "src/contact/attachments.hpp"
#include "tests/forces/differences.hpp"

#include <Eigen/Geometry>

using namespace taut;
using namespace taut::test;

namespace {

const std::vector<Tie> ties{{{12, 3}, 0}, {{16, 1}, 0}, {{20, 5}, 1}};
const std::vector<Global> held{2, 7, 11};

MeshSlab mesh_with_ties(MPI_Comm comm) {
  MeshSlab mesh = mixed_mesh(comm);
  for (const Tie& tie : ties) mesh.ties.push_back(tie.vertices);
  return mesh;
}

/// A box that turns and moves.
Case moving_case() {
  Case input;
  config::Obstacle box;
  box.box = {Vec3(0, 0, -1), Vec3(1, 1, -0.5)};
  box.motion = {{0.1, Vec3(0.2, 0, 0), {}}, {1, Vec3(0.2, 0.3, 0), {Vec3(1, 2, 3), 0.5, Vec3(0.1, 0, 0)}}};
  input.obstacles = {box};
  input.attachments.resize(3);
  input.attachments[0].length = 0.01;
  input.attachments[1].force = 3;
  input.attachments[2].label = "hem";
  input.attachments[2].obstacle = "0";
  return input;
}

struct Scene {
  Case input = moving_case();
  Obstacles obstacles{MPI_COMM_SELF, input};
};

/// In random states all pull with all their force.
std::unique_ptr<Force> fastened(const Bed& b) {
  static const Scene scene;
  Bed& bed = const_cast<Bed&>(b); // a bed has no ties and no labels of its own
  bed.cloth.ties = ties;
  bed.cloth.pieces[0].parts.labels["hem"] = held;
  return std::make_unique<Attachments>(bed.cloth, scene.obstacles, bed.pattern, scene.input,
                                       bed.cloth.mesh.rest_positions);
}

const Bed& whole() {
  static const Bed bed{serial(mesh_with_ties)};
  return bed;
}

} // namespace

TEST(Attachments, PullAlongTheGradientOfTheirEnergy) {
  for (unsigned seed = 0; seed < states; ++seed) {
    WholeState state = random_state(whole(), seed);
    const auto energy = [&](const WholeState& s) {
      State late = whole().at(s);
      late.time += 1; // add_to asks for the end of a step of a second
      return Column(Column::Constant(1, fastened(whole())->energy(late)));
    };
    const Column expected = -derivative(energy, state).transpose();
    EXPECT_LT(relative_error(force_of(whole(), fastened, state), expected), difference_tolerance);
  }
}

TEST(Attachments, PullNoMoreThanTheyMay) {
  const Column force = force_of(whole(), fastened, random_state(whole(), 0));
  const auto of = [&](Global v) { return force.segment<3>(3 * v).norm(); };
  EXPECT_NEAR(of(12), 10, 1e-12);
  EXPECT_NEAR(of(20), 3, 1e-12);
  EXPECT_NEAR(of(7), 10, 1e-12);
  EXPECT_EQ(of(0), 0.0);
}

TEST(Attachments, AreTheSameOnAnyPartition) {
  expect_same_on_any_partition(mesh_with_ties, whole(), fastened);
  expect_semi_definite(whole(), fastened);
}

TEST(Attachments, LetGo) {
  Scene scene;
  for (config::Attachment& a : scene.input.attachments) a.release = 0.2; // before the state
  fastened(whole());                                                     // gives the bed ties and labels
  Attachments open(whole().cloth, scene.obstacles, whole().pattern, scene.input,
                   whole().cloth.mesh.rest_positions);
  StepSystem system(whole().pattern, whole().cloth.mesh.vertices.size());
  system.start(0.1);
  const State state = whole().at(random_state(whole(), 0));
  open.add_to(system, state);
  for (const Vec3& f : system.rhs()) EXPECT_EQ(f.norm(), 0.0);
  EXPECT_EQ(open.energy(state), 0.0);
}

TEST(Attachments, FollowABody) {
  const Scene scene;
  const Vec3 place(0.4, 0.3, -0.45);
  const auto anchor = scene.obstacles.anchor(0, place);
  EXPECT_LT((scene.obstacles.follow(anchor, 0) - place).norm(), 1e-12);
  const Vec3 corner(1, 1, -0.5), at_start = scene.obstacles.moved(0, corner, 0);
  EXPECT_LT((scene.obstacles.follow(scene.obstacles.anchor(0, at_start), 0.7) -
             scene.obstacles.moved(0, corner, 0.7))
                .norm(),
            1e-12);
}
