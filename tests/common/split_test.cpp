#include "common/split.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace foresight::split_test {
namespace {

using testing::ElementsAre;

TEST(Split, PartsMayBeEmptyAndNoneIsLost) {
  EXPECT_THAT(split("9x6", 'x'), ElementsAre("9", "6"));
  EXPECT_THAT(split("elbow=1,,pan=2,", ','), ElementsAre("elbow=1", "", "pan=2", ""));
  EXPECT_THAT(split("", ','), ElementsAre(""));
  EXPECT_THAT(split("one", ':'), ElementsAre("one"));
}

}  // namespace
}  // namespace foresight::split_test
