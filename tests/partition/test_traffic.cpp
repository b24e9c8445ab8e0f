// What is counted is what was said.
#include "partition/distributed_mesh.hpp"
#include "partition/grid.hpp"
#include "partition/traffic.hpp"
#include "tests/meshes.hpp"

#include <gtest/gtest.h>
#include <petscvec.h>

#include <ctime>

using namespace taut;
using namespace taut::test;

namespace {

/// What `function` adds to the counts of the phase `velocity`.
template<class Function>
PhaseTraffic traffic_of(Function&& function) {
  count_traffic();
  constexpr auto phase = std::size_t(Phase::velocity);
  const PhaseTraffic before = traffic()[phase];
  {
    const PhaseScope scope(Phase::velocity);
    function();
  }
  PhaseTraffic added = traffic()[phase];
  added.entered -= before.entered;
  added.seconds -= before.seconds;
  added.work -= before.work;
  added.messages -= before.messages;
  added.bytes -= before.bytes;
  added.reductions -= before.reductions;
  added.collectives -= before.collectives;
  added.halo_updates -= before.halo_updates;
  added.halo_messages -= before.halo_messages;
  added.halo_bytes -= before.halo_bytes;
  return added;
}

int ranks() { return size_of(world); }
int next() { return (rank_of(world) + 1) % ranks(); }
int previous() { return (rank_of(world) + ranks() - 1) % ranks(); }

} // namespace

TEST(Traffic, OfAHaloIsItsGhosts) {
  const MeshSlab slab = make_grid(world, {1, 1}, {21, 17});
  const Topology topology = find_topology(world, slab);
  const DistributedMesh mesh =
      distribute(world, slab, topology, partition(world, slab, topology, Partitioner::metis));
  std::vector<Vec3> field(mesh.vertices.size());
  const PhaseTraffic once = traffic_of([&] { mesh.vertex_halo.update(field); });
  EXPECT_EQ(once.halo_updates, 1);
  EXPECT_EQ(once.messages, once.halo_messages);
  EXPECT_EQ(once.bytes, Global(sizeof(Vec3) * mesh.vertex_halo.plan().sent()));
  EXPECT_EQ(sum_over(world, once.messages), sum_over(world, Global(mesh.vertex_halo.plan().neighbours())));
  EXPECT_EQ(sum_over(world, once.bytes),
            Global(sizeof(Vec3)) * sum_over(world, Global(mesh.vertices.ghosts())));
  EXPECT_EQ(once.entered, 1);
  const PhaseTraffic thrice = traffic_of([&] {
    for (int k = 0; k < 3; ++k) mesh.vertex_halo.update(field);
  });
  EXPECT_EQ(thrice.halo_bytes, 3 * once.halo_bytes);
}

TEST(Traffic, OfReductionsIsTheirNumber) {
  const PhaseTraffic counted = traffic_of([] {
    sum_over(world, 1.0);
    any_of(world, true);
    MPI_Barrier(world);
    sum_over(MPI_COMM_SELF, 1.0); // nobody else hears of it
  });
  EXPECT_EQ(counted.reductions, ranks() > 1 ? 2 : 0);
  EXPECT_EQ(counted.collectives, ranks() > 1 ? 1 : 0);
  EXPECT_EQ(counted.messages, 0);
}

TEST(Traffic, OfPetscIsCountedToo) {
  Vec v = nullptr;
  ASSERT_EQ(VecCreateMPI(world, 10, PETSC_DETERMINE, &v), 0);
  ASSERT_EQ(VecSet(v, 2.0), 0);
  const PhaseTraffic counted = traffic_of([&] {
    PetscScalar square = 0;
    ASSERT_EQ(VecDot(v, v, &square), 0);
    EXPECT_DOUBLE_EQ(square, 40.0 * ranks());
  });
  EXPECT_EQ(counted.reductions, ranks() > 1 ? 1 : 0);
  ASSERT_EQ(VecDestroy(&v), 0);
}

TEST(Traffic, OfMessagesThatAreSentAgain) {
  double out = 1, in = 0;
  const PhaseTraffic counted = traffic_of([&] {
    MPI_Request requests[2];
    MPI_Recv_init(&in, 1, MPI_DOUBLE, previous(), 7, world, &requests[0]);
    MPI_Send_init(&out, 1, MPI_DOUBLE, next(), 7, world, &requests[1]);
    for (int k = 0; k < 4; ++k) {
      MPI_Startall(2, requests);
      // NOLINTNEXTLINE(clang-analyzer-optin.mpi.MPI-Checker): it knows no requests that are started again
      MPI_Waitall(2, requests, MPI_STATUSES_IGNORE);
    }
    for (MPI_Request& r : requests) MPI_Request_free(&r);
  });
  EXPECT_EQ(counted.messages, ranks() > 1 ? 4 : 0); // what goes to the sender itself is none
  EXPECT_EQ(counted.bytes, ranks() > 1 ? 4 * 8 : 0);
}

TEST(Traffic, OfAPhaseWithinAPhaseIsItsOwn) {
  const auto contact = [] { return traffic()[std::size_t(Phase::contact)]; };
  count_traffic();
  const PhaseTraffic before = contact();
  const PhaseTraffic outer = traffic_of([] {
    sum_over(world, 1.0);
    const PhaseScope inner(Phase::contact);
    sum_over(world, 1.0);
  });
  EXPECT_EQ(outer.reductions, ranks() > 1 ? 1 : 0);
  EXPECT_EQ(contact().reductions - before.reductions, ranks() > 1 ? 1 : 0);
  EXPECT_EQ(contact().entered - before.entered, 1);
  EXPECT_GT(contact().seconds, before.seconds);
}

TEST(Traffic, WaitingIsNoWork) {
  constexpr double burnt = 0.1; // s of the processor, by rank 0; the others do nothing but wait for it
  const PhaseTraffic counted = traffic_of([] {
    const std::clock_t end = std::clock() + std::clock_t(2 * burnt * CLOCKS_PER_SEC);
    while (rank_of(world) == 0 && std::clock() < end) {
    }
    MPI_Barrier(world);
  });
  if (rank_of(world) == 0)
    EXPECT_GT(counted.work, burnt);
  else
    EXPECT_LT(counted.work, burnt);
}
