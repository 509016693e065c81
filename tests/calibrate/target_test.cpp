#include <gmock/gmock.h>

#include "tests/calibrate/run_calibrate.hpp"

namespace foresight::target_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

const std::string kBoard = "chessboard:9x6:0.02";

TEST(TargetCommand, PrintsABoardAndTakesItsRulers) {
  const TempFolder folder;
  ASSERT_EQ(run_calibrate({"target", "--board", kBoard, "--out", folder / "b.pdf", "--measured", "99.5,99.5", "--json",
                           folder / "b.json"}),
            "0");
  EXPECT_TRUE(folder.read("b.pdf").starts_with("%PDF"));
  EXPECT_NEAR(json_of(folder, "b.json")["scale_x"], 0.995, 1e-12);
  EXPECT_EQ(json_of(folder, "b.json")["measured_board"], "chessboard:9x6:0.0199");
}

TEST(TargetCommand, WrongRulersLeaveNothingBehind) {
  const TempFolder folder;
  const auto refused = [&](const std::string& measured) {
    const std::string said = run_calibrate(
        {"target", "--board", kBoard, "--out", folder / "b.pdf", "--json", folder / "b.json", "--measured", measured});
    EXPECT_TRUE(std::filesystem::is_empty(folder.path())) << measured;
    return said;
  };
  EXPECT_THAT(refused("99.5"), AllOf(HasSubstr("--measured"), HasSubstr("'99.5' is not two lengths")));
  EXPECT_THAT(refused("99.5,wide"), HasSubstr("is not two lengths"));
  EXPECT_THAT(refused("99,101"), HasSubstr("--measured"));
  EXPECT_THAT(refused("3.9,3.9"), HasSubstr("--measured"));
}

}  // namespace
}  // namespace foresight::target_test
