#include "texture_gpu/lamp/lamp_words.hpp"

#include <gmock/gmock.h>

namespace foresight::lamp_words_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr RobotTime kFrom{2'500'000'000};

TEST(LampWords, SayWhereItIsAndWhatHasTold) {
  LampAnswer answer{.lamp = Lamp{{0.3, -0.5, 1.25}, 0.1, {3, 3, 3}}, .explained = 0.62};
  EXPECT_THAT(lamp_in_words(answer, kFrom), AllOf(HasSubstr("(0.30, -0.50, 1.25) m"), HasSubstr("in single images"),
                                                  HasSubstr("from 2.500 s on"), Not(HasSubstr("62 %"))));
  answer.told_by_what_moves = true;
  EXPECT_THAT(lamp_in_words(answer, kFrom), AllOf(HasSubstr("of what moves"), HasSubstr("62 %")));
}

TEST(LampWords, SayWhyShadowsAreNotForetold) {
  EXPECT_THAT(lamp_in_words({.lamp = {}, .several = true, .dark = 70}, kFrom),
              AllOf(HasSubstr("another lamp"), HasSubstr("shown where they were")));
  EXPECT_THAT(lamp_in_words({.lamp = {}, .dark = 70, .explained = 0.3, .elsewhere = 0.25}, kFrom),
              AllOf(HasSubstr("could not be told"), HasSubstr("70 points"), HasSubstr("30 %"), HasSubstr("25 %")));
}

TEST(LampWords, SayNothingWhereNothingHasTold) {
  EXPECT_EQ(lamp_in_words({}, kFrom), "");
}

}  // namespace
}  // namespace foresight::lamp_words_test
