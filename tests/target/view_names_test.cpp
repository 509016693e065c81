#include "calibration/target/view_names.hpp"

#include <gtest/gtest.h>

namespace foresight {
namespace {

void expect(const char* path, std::optional<Side> side, const char* view) {
  const SidedName name = split_side(path);
  EXPECT_EQ(name.side, side) << path;
  EXPECT_EQ(name.view, view) << path;
}

TEST(ViewNames, BothFilesOfAPairHaveOneName) {
  expect("left01.jpg", Side::left, "01");
  expect("right01.jpg", Side::right, "01");
  expect("Left_01.JPG", Side::left, "01");
  expect("01-right.png", Side::right, "01");
  expect("cal_left_07.png", Side::left, "cal_07");
  expect("cal_right_07.png", Side::right, "cal_07");
  expect("left/0001.png", Side::left, "0001");
  expect("right/0001.png", Side::right, "0001");
  expect("set/cam0/17.png", Side::left, "set/17");
  expect("set/cam1/17.png", Side::right, "set/17");
  expect("cam1_17.png", Side::right, "17");
  expect("12_l.png", Side::left, "12");
  expect("12_r.png", Side::right, "12");
  expect("r_12.png", Side::right, "12");
}

TEST(ViewNames, NamesOfOneCameraStayWhole) {
  expect("image_12.png", std::nullopt, "image_12");
  expect("cam01/12.png", std::nullopt, "cam01/12");
  expect("roll_lr2.png", std::nullopt, "roll_lr2");
}

TEST(ViewNames, ASideAloneIsTheName) {
  expect("left.jpg", Side::left, "left");
}

}  // namespace
}  // namespace foresight
