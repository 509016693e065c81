#include "scene/run_units.hpp"

#include <fmt/core.h>

#include "tests/scene/test_run.hpp"

namespace foresight::run_units_test {
namespace {

/// A triangle of `size` a metre ahead of a camera that goes `step` to the right from image to image, from `start` on,
/// in what its maker took for metres.
std::string doubt(double size, double step, double start = 0) {
  const TestRun run;
  run.write("scene.ply",
            kTriangle.substr(0, kTriangle.find("0 0 1\n")) + fmt::format("0 0 1\n{0} 0 1\n0 {0} 1\n3 0 1 2\n", size));
  std::string poses;
  for (int i = 0; i < 3; ++i) poses += fmt::format("1700000000.{} {} 0 0 0 0 0 1\n", i, start + i * step);
  run.write("trajectory.txt", poses);
  return doubt_of_units(RunFolder::open(run.path(), {})).value_or("none");
}

TEST(RunUnits, MetresAreNotDoubted) {
  EXPECT_EQ(doubt(0.3, 0.5), "none");
  EXPECT_EQ(doubt(4, 0.5), "none");
  EXPECT_EQ(doubt(0.02, 0.1), "none") << "a part that is near";
  EXPECT_EQ(doubt(0.3, 0.5, 30), "none") << "far away, and seen";
  EXPECT_EQ(doubt(200, 0), "none") << "a hall, and a camera that stands";
  EXPECT_EQ(doubt(2000, 10), "none") << "a landscape, and a camera that goes through it";
}

TEST(RunUnits, AModelInMillimetresIsTold) {
  EXPECT_THAT(doubt(4000, 0.5), testing::AllOf(testing::HasSubstr("'scene' of the model is 4000 m large"),
                                               testing::HasSubstr("scale its mesh by 0.001")));
  EXPECT_THAT(doubt(300, 0), testing::HasSubstr("millimetres"));
}

TEST(RunUnits, AModelThatIsOnlyAPointIsTold) {
  EXPECT_THAT(doubt(0.003, 0.5), testing::HasSubstr("no part of the model takes more than some pixels"));
  EXPECT_THAT(doubt(2, 300, 1500), testing::HasSubstr("'scene' is 2.83 m large, and 1498 m away at least"));
}

}  // namespace
}  // namespace foresight::run_units_test
