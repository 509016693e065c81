#include "apps/command_line/picture_size.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "common/error.hpp"

namespace foresight::picture_size_test {
namespace {

TEST(PictureSize, IsTwoWholeNumbersAndNothingElse) {
  EXPECT_EQ(parse_picture_size("640x480"), (std::array{640, 480}));
  EXPECT_EQ(parse_picture_size("-5x7"), (std::array{-5, 7})) << "for the command to refuse";
  for (const char* text : {"", "x", "640", "640x", "x480", "640x480x3", "640X480", " 640x480", "640x480 ", "6.4x4",
                           "+640x480", "99999999999x480", "640x99999999999999999999"})
    EXPECT_FALSE(parse_picture_size(text)) << text;
}

TEST(PictureSize, OfAnOptionLiesWithinItsBounds) {
  EXPECT_EQ(size_option("64x32", {64, 32}, {64, 32}), (std::array{64, 32}));
  for (const char* text : {"63x32", "65x32", "64x31", "64x33", "-64x32", "64"}) try {
      size_option(text, {64, 32}, {64, 32});
      ADD_FAILURE() << text;
    } catch (const InputError& error) {
      EXPECT_THAT(error.what(), testing::AllOf(testing::HasSubstr(text), testing::HasSubstr("from 64x32 to 64x32")));
    }
}

}  // namespace
}  // namespace foresight::picture_size_test
