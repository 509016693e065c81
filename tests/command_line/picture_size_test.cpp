#include "apps/command_line/picture_size.hpp"

#include <gtest/gtest.h>

namespace foresight::picture_size_test {
namespace {

TEST(PictureSize, IsTwoWholeNumbersAndNothingElse) {
  EXPECT_EQ(parse_picture_size("640x480"), (std::array{640, 480}));
  EXPECT_EQ(parse_picture_size("-5x7"), (std::array{-5, 7})) << "for the command to refuse";
  for (const char* text : {"", "x", "640", "640x", "x480", "640x480x3", "640X480", " 640x480", "640x480 ", "6.4x4",
                           "+640x480", "99999999999x480", "640x99999999999999999999"})
    EXPECT_FALSE(parse_picture_size(text)) << text;
}

}  // namespace
}  // namespace foresight::picture_size_test
