#include "calibration/target/view_names.hpp"

#include <gtest/gtest.h>

namespace foresight::view_names_test {
namespace {

void expect(const char* path, std::optional<PairSide> side, const char* view) {
  const SidedName name = split_side(path);
  EXPECT_EQ(name.side, side) << path;
  EXPECT_EQ(name.view, view) << path;
}

TEST(ViewNames, BothFilesOfAPairHaveOneName) {
  expect("left01.jpg", PairSide::left, "01");
  expect("right01.jpg", PairSide::right, "01");
  expect("Left_01.JPG", PairSide::left, "01");
  expect("01-right.png", PairSide::right, "01");
  expect("cal_left_07.png", PairSide::left, "cal_07");
  expect("cal_right_07.png", PairSide::right, "cal_07");
  expect("left/0001.png", PairSide::left, "0001");
  expect("right/0001.png", PairSide::right, "0001");
  expect("set/cam0/17.png", PairSide::left, "set/17");
  expect("set/cam1/17.png", PairSide::right, "set/17");
  expect("cam1_17.png", PairSide::right, "17");
  expect("12_l.png", PairSide::left, "12");
  expect("12_r.png", PairSide::right, "12");
  expect("r_12.png", PairSide::right, "12");
}

TEST(ViewNames, NamesOfOneCameraStayWhole) {
  expect("image_12.png", std::nullopt, "image_12");
  expect("cam01/12.png", std::nullopt, "cam01/12");
  expect("roll_lr2.png", std::nullopt, "roll_lr2");
}

TEST(ViewNames, ASideAloneIsTheName) {
  expect("left.jpg", PairSide::left, "left");
}

}  // namespace
}  // namespace foresight::view_names_test
