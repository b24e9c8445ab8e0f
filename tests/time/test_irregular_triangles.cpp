// Averaged warp and weft on triangles of any shape, over times long enough for what goes wrong a little each
// step.
#include "tests/folder.hpp"
#include "tests/simulate.hpp"

#include <fmt/format.h>

#include <fstream>

using namespace taut;
using namespace taut::test;

namespace {

constexpr int side = 12; // vertices
constexpr double edge = 0.5 / (side - 1);

/// A square of triangles whose inner vertices are moved by up to a third of an edge, as OBJ.
std::string irregular_mesh() {
  const std::vector<Vec3> moves = random_vectors(side * side, edge / 3, 1);
  std::string text;
  for (int k = 0; k < side * side; ++k) {
    const int i = k % side, j = k / side;
    const bool is_inner = i > 0 && i < side - 1 && j > 0 && j < side - 1;
    const Vec3 x = Vec3(i * edge, j * edge, 0) + (is_inner ? moves[std::size_t(k)] : Vec3(Vec3::Zero()));
    text += fmt::format("v {:.9f} {:.9f} 0\n", x[0], x[1]);
  }
  for (int k = 0; k < side * (side - 1); ++k)
    if (const int a = k + 1; a % side != 0) // OBJ counts from 1
      text += fmt::format("f {0} {1} {3}\nf {0} {3} {2}\n", a, a + 1, a + side, a + side + 1);
  return text;
}

/// Root mean square of the sides' force densities, after each step.
class Tension : public Observer {
public:
  explicit Tension(const DistributedMesh& mesh) : mesh_(mesh) {}
  void after_step(const State& state, const StepRecord& record) override {
    double sum = 0;
    for (Local e = 0; e < mesh_.edges.owned; ++e) sum += std::pow(state.multipliers.force_density[e], 2);
    rms.push_back(std::sqrt(sum_over(mesh_.comm, sum) / double(mesh_.edges.total)));
    kinetic.push_back(record.energies.kinetic);
  }

  std::vector<double> rms, kinetic; ///< N/m, J

private:
  const DistributedMesh& mesh_;
};

} // namespace

// On such a triangle one side works against the stress that the others bear.
TEST(IrregularTriangles, HangAtRestUnderTensionThatStays) {
  const Folder folder;
  if (rank_of(world) == 0) std::ofstream(folder / "mesh.obj") << irregular_mesh();
  MPI_Barrier(world);
  for (const double step : {0.01, 0.005}) {
    const Case input =
        case_of(fmt::format("cloth:\n"
                            "  mesh: {}\n"
                            "  material: {{density: 0.2, bending: 1e-5, shear: 10, damping: {{mass: 2}}}}\n"
                            "pins: [{{vertices: [132]}}, {{vertices: [143]}}]\n"
                            "time: {{end: 8, frame_rate: 1, max_step: {}}}\n"
                            "inextensibility: {{method: fast_projection}}\n",
                            (folder / "mesh.obj").string(), step));
    Simulation simulation(world, input);
    Tension tension(simulation.cloth().mesh);
    run_to_the_end(simulation, tension);
    const std::size_t steps = tension.rms.size();
    EXPECT_EQ(simulation.rejected_steps(), 0);
    EXPECT_NEAR(tension.rms.back(), tension.rms[steps * 3 / 4], 0.001 * tension.rms.back()) << step;
    EXPECT_LT(tension.kinetic.back(), 1e-8) << step; // the cloth weighs 0.5 N
  }
}
