#include "texture_gpu/lamp/lamp_words.hpp"

#include <gmock/gmock.h>

namespace foresight::lamp_words_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// Of an image each half second, the first at 2.5 s.
std::string words_after(const std::vector<LampAnswer>& answers) {
  LampHistory history;
  RobotTime image{2'500'000'000};
  for (const LampAnswer& answer : answers) {
    history.add(answer, image);
    image = image + std::chrono::milliseconds(500);
  }
  return history.in_words();
}

const LampAnswer kKnown{.lamp = Lamp{{0.3, -0.5, 1.25}, 0.1, {3, 3, 3}}, .explained = 0.62};
const LampAnswer kUnknown{.lamp = {}, .dark = 70, .explained = 0.3, .elsewhere = 0.25};

TEST(LampWords, SayWhereItIsAndWhatHasTold) {
  LampAnswer answer = kKnown;
  EXPECT_THAT(words_after({answer, answer}), AllOf(HasSubstr("(0.30, -0.50, 1.25) m"), HasSubstr("in single images"),
                                                   HasSubstr("from 2.500 s on"), Not(HasSubstr("62 %"))));
  answer.told_by_what_moves = true;
  EXPECT_THAT(words_after({kUnknown, answer}), AllOf(HasSubstr("of what moves"), HasSubstr("62 %"),
                                                     HasSubstr("from 3.000 s on"), Not(HasSubstr("believed"))));
}

TEST(LampWords, SayWhyShadowsAreNotForetold) {
  EXPECT_THAT(words_after({{.lamp = {}, .several = true, .dark = 70}}),
              AllOf(HasSubstr("another lamp"), HasSubstr("shown where they were")));
  EXPECT_THAT(words_after({kUnknown}),
              AllOf(HasSubstr("could not be told"), HasSubstr("70 points"), HasSubstr("30 %"), HasSubstr("25 %")));
}

// Images that one was believed for are not passed over in silence.
TEST(LampWords, SayForWhichImagesALampWasBelieved) {
  EXPECT_THAT(words_after({kUnknown, kKnown, kKnown, kUnknown}),
              AllOf(HasSubstr("could not be told"), HasSubstr("with 2 images from 3.000 to 3.500 s")));
  EXPECT_THAT(words_after({kKnown, {}, {}}), HasSubstr("with 1 image from 2.500 to 2.500 s"));
  EXPECT_THAT(words_after({kKnown, kUnknown, kKnown, kUnknown, kKnown}),
              AllOf(HasSubstr("is at (0.30"), HasSubstr("images from 4.500 s on"),
                    HasSubstr("with 2 images from 2.500 to 3.500 s")));
}

TEST(LampWords, SayNothingWhereNothingHasTold) {
  EXPECT_EQ(words_after({}), "");
  EXPECT_EQ(words_after({{}, {}}), "");
}

}  // namespace
}  // namespace foresight::lamp_words_test
