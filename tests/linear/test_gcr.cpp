// The generalised conjugate residual method against dense algebra.
#include "src/linear/gcr.hpp"
#include "tests/support.hpp"

#include <gtest/gtest.h>

using namespace taut;
using namespace taut::test;

namespace {

constexpr Global unknowns = 24;

/// Neither symmetric nor definite.
Dense matrix() {
  const auto numbers = random_numbers(unknowns * unknowns, 1, 3);
  Dense a = Eigen::Map<const Dense>(numbers.data(), unknowns, unknowns);
  a.diagonal().head(unknowns / 2).array() += 6;
  a.diagonal().tail(unknowns / 2).array() -= 6;
  return a;
}

/// This rank's part of a vector that all know.
struct Mine {
  Slab slab = slab_of(unknowns, size_of(world), rank_of(world));

  std::vector<double> of(const Column& whole) const {
    const auto part = whole.segment(slab.first, slab.count);
    return {part.begin(), part.end()};
  }
  Column whole(std::span<const double> part) const {
    Column result = Column::Zero(unknowns);
    std::copy(part.begin(), part.end(), result.data() + slab.first);
    sum_in_place(world, {result.data(), std::size_t(unknowns)});
    return result;
  }
};

} // namespace

TEST(Gcr, SolvesWithAPreconditionerThatChanges) {
  const Dense a = matrix();
  const Column b = Column::Ones(unknowns);
  const Mine mine;
  std::vector<double> x = mine.of(Column::Zero(unknowns)), r = mine.of(b);
  Gcr gcr(world, r.size());
  gcr.start(std::vector<double>(r.size(), 1.0));
  int iterations = 0;
  for (; iterations < unknowns && mine.whole(r).norm() > 1e-6; ++iterations) {
    Column z = mine.whole(r).cwiseQuotient(a.diagonal());
    if (iterations % 2 == 1) z *= -3;
    std::vector<double> direction = mine.of(z), product = mine.of(a * z);
    EXPECT_NE(gcr.step(direction, product, x, r), 0);
  }
  EXPECT_LT(iterations, unknowns);
  EXPECT_LT((a * mine.whole(x) - b).norm(), 2e-6); // what it says is left is left
}

// After k steps no combination of the k directions leaves less, in the norm of the weights.
TEST(Gcr, LeavesTheLeastOfAllCombinations) {
  const Dense a = matrix();
  const Column b = Column::LinSpaced(unknowns, -1, 2), weights = Column::LinSpaced(unknowns, 0.1, 3);
  const Mine mine;
  std::vector<double> x = mine.of(Column::Zero(unknowns)), r = mine.of(b);
  Gcr gcr(world, r.size());
  gcr.start(mine.of(weights));
  Dense products(unknowns, 5);
  for (int k = 0; k < 5; ++k) {
    const auto numbers = random_numbers(unknowns, 1, unsigned(20 + k));
    const Column z = Eigen::Map<const Column>(numbers.data(), unknowns);
    products.col(k) = a * z;
    std::vector<double> direction = mine.of(z), product = mine.of(products.col(k));
    gcr.step(direction, product, x, r);
  }
  const Column root = weights.cwiseSqrt();
  const Dense weighted = root.asDiagonal() * products;
  const Column best = b - products * weighted.colPivHouseholderQr().solve(Column(root.cwiseProduct(b)));
  EXPECT_LT((mine.whole(r) - best).norm(), 1e-6 * b.norm());
}

TEST(Gcr, SaysWhereADirectionBringsNothing) {
  const Dense a = matrix();
  const Mine mine;
  std::vector<double> x = mine.of(Column::Zero(unknowns)), r = mine.of(Column::Ones(unknowns));
  Gcr gcr(world, r.size());
  gcr.start(std::vector<double>(r.size(), 1.0));
  const Column z = Column::LinSpaced(unknowns, 1, 2);
  for (const bool first : {true, false}) {
    std::vector<double> direction = mine.of(z), product = mine.of(a * z);
    EXPECT_EQ(gcr.step(direction, product, x, r) != 0, first);
  }
}

// A quarter turn leaves no residual smaller by any part of its product, and what follows it solves the
// system.
TEST(Gcr, GoesOnFromTheProductWhereItStalls) {
  const Dense turn = (Dense(2, 2) << 0, 1, -1, 0).finished();
  const auto of_rank = [](const Column& whole) {
    return rank_of(world) == 0 ? std::vector<double>{whole[0], whole[1]} : std::vector<double>{};
  };
  std::vector<double> x = of_rank(Column::Zero(2)), r = of_rank(Column::Unit(2, 0));
  Gcr gcr(world, r.size());
  gcr.start(std::vector<double>(r.size(), 1.0));
  Column source = Column::Unit(2, 0);
  for (const bool stalls : {true, false}) {
    std::vector<double> direction = of_rank(source), product = of_rank(turn * source);
    gcr.step(direction, product, x, r);
    EXPECT_EQ(gcr.stalled() > 0, stalls);
    source = turn * source;
  }
  for (const double left : r) EXPECT_NEAR(left, 0, 1e-7);
}
