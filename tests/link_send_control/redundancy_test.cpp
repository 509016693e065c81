#include "link/send_control/redundancy.hpp"

#include <gtest/gtest.h>

#include <random>

namespace foresight::redundancy_test {
namespace {

constexpr double kFar_s = 0.5, kNear_s = 0.01;

/// Pairs that go over a line that loses packets.
class Line {
 public:
  /// `pairs` of `pieces` and what is spared with them: how many of them miss more than was spared.
  int send(Redundancy& redundancy, int pairs, std::size_t pieces, double loss) {
    int missed = 0;
    for (int i = 0; i < pairs; ++i) {
      const std::size_t spares = redundancy.spares(pieces, kFar_s);
      redundancy.sent(++number_, pieces + spares);
      std::size_t lost = 0;
      for (std::size_t piece = 0; piece < pieces + spares; ++piece) {
        const bool came = std::uniform_real_distribution<>()(random_) >= loss;
        came ? redundancy.came(number_) : redundancy.lost(number_);
        lost += !came;
      }
      missed += lost > spares;
    }
    return missed;
  }

 private:
  std::mt19937 random_{3};
  std::uint32_t number_ = 0;
};

TEST(Redundancy, SparesNothingWhereNothingIsLost) {
  Redundancy redundancy;
  Line line;
  EXPECT_EQ(redundancy.spares(10, kFar_s), 0U);
  line.send(redundancy, 200, 10, 0);
  EXPECT_EQ(redundancy.spares(10, kFar_s), 0U);
}

TEST(Redundancy, FewPairsMissMoreThanIsSpared) {
  for (const double loss : {0.01, 0.03, 0.08, 0.15}) {
    Redundancy redundancy;
    Line line;
    line.send(redundancy, 200, 10, loss);
    EXPECT_LT(line.send(redundancy, 1000, 10, loss), 60) << loss;
    EXPECT_GE(redundancy.spares(10, kFar_s), 1U) << loss;
    EXPECT_LE(redundancy.spares(10, kFar_s), 5U) << loss;
  }
}

TEST(Redundancy, IsNotPaidForWhereARoundTripCostsLess) {
  Redundancy redundancy;
  Line().send(redundancy, 200, 10, 0.05);
  EXPECT_GE(redundancy.spares(10, kFar_s), 1U);
  EXPECT_EQ(redundancy.spares(10, kNear_s), 0U);
}

TEST(Redundancy, DoesNotTryToOutlastAnOutage) {
  Redundancy redundancy;
  Line line;
  line.send(redundancy, 90, 10, 0);
  line.send(redundancy, 5, 10, 1);
  EXPECT_EQ(redundancy.spares(10, kFar_s), 0U) << "nothing but twice the bytes would have saved them";
}

TEST(Redundancy, ForgetsAsTheLineGetsBetter) {
  Redundancy redundancy;
  Line line;
  line.send(redundancy, 100, 10, 0.08);
  ASSERT_GE(redundancy.spares(10, kFar_s), 1U);
  line.send(redundancy, 100, 10, 0);
  EXPECT_EQ(redundancy.spares(10, kFar_s), 0U);
}

TEST(Redundancy, LeavesPairsAloneThatHaveMorePiecesThanCanBeCoded) {
  Redundancy redundancy;
  Line().send(redundancy, 100, 10, 0.1);
  EXPECT_GE(redundancy.spares(100, kFar_s), 10U);
  EXPECT_EQ(redundancy.spares(256, kFar_s), 0U);
  EXPECT_EQ(redundancy.spares(14'000, kFar_s), 0U);
}

}  // namespace
}  // namespace foresight::redundancy_test
