// What is heard, and when: cues of moments, their samples, and a machine without sound.
#include <gmock/gmock.h>

#include <cstdlib>
#include <set>

#include "seat/seat_sounds.hpp"
#include "seat/sound_cues.hpp"
#include "seat/speaker.hpp"
#include "seat/tones.hpp"

namespace foresight::sounds_test {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

Hearing driving() {
  Hearing out;
  out.held = out.engaged = true;
  return out;
}

TEST(SoundCues, HowThingsAreAtFirstIsNoEvent) {
  SoundCues cues;
  Hearing all = driving();
  all.stopped = true;
  all.carried = "brick";
  all.asking = "somebody";
  EXPECT_THAT(cues.at(all, 0), IsEmpty());
  EXPECT_THAT(cues.at(all, 10), IsEmpty());
}

TEST(SoundCues, LettingGoAndLosingTheRobotSoundDifferent) {
  SoundCues cues;
  cues.at({}, 0);
  EXPECT_THAT(cues.at(driving(), 1), ElementsAre(Cue::follows));
  Hearing lost = driving();
  lost.engaged = false;
  EXPECT_THAT(cues.at(lost, 2), ElementsAre(Cue::lost));
  EXPECT_THAT(cues.at({}, 3), IsEmpty());  // it was lost before
  cues.at(driving(), 4);
  EXPECT_THAT(cues.at({}, 5), ElementsAre(Cue::at_rest));
}

TEST(SoundCues, WhatIsUrgentComesFirstAndIsNeverLeftOut) {
  SoundCues cues;
  for (double t = 0; t < 0.1; t += 0.02) {
    cues.at(driving(), t);
    Hearing bad;
    bad.held = bad.stopped = true;
    bad.trusted = false;
    const auto heard = cues.at(bad, t + 0.01);
    ASSERT_GE(heard.size(), 2u);
    EXPECT_EQ(heard[0], Cue::stopped);
    EXPECT_EQ(heard[1], Cue::lost);
  }
}

TEST(SoundCues, ATouchThatFlickersIsHeardTwiceASecondAtMost) {
  SoundCues cues;
  cues.at({}, 0);
  int heard = 0;
  for (int i = 1; i <= 200; ++i) {
    Hearing now;
    if (i % 2) now.touching = "finger_left touches mat";
    heard += static_cast<int>(cues.at(now, 0.01 * i).size());
  }
  EXPECT_EQ(heard, 4);
}

TEST(SoundCues, AnotherThingThatTouchesIsAnotherEvent) {
  SoundCues cues;
  Hearing now;
  now.touching = "finger_left touches mat";
  cues.at({}, 0);
  EXPECT_THAT(cues.at(now, 1), ElementsAre(Cue::touches));
  now.touching = "wrist touches box";
  EXPECT_THAT(cues.at(now, 2), ElementsAre(Cue::touches));
  EXPECT_THAT(cues.at({}, 3), IsEmpty());
}

TEST(Tones, EachCueHasItsOwn) {
  std::set<std::vector<std::int16_t>> all;
  for (int cue = 0; cue < kCues; ++cue) all.insert(samples_of(tones_of(static_cast<Cue>(cue)), 0.5));
  EXPECT_EQ(all.size(), static_cast<std::size_t>(kCues));
}

TEST(Tones, SwellAndFadeWithinTheVolume) {
  for (int cue = 0; cue < kCues; ++cue) {
    const auto samples = samples_of(tones_of(static_cast<Cue>(cue)), 0.25);
    ASSERT_FALSE(samples.empty());
    EXPECT_EQ(samples.front(), 0);
    int last = 0, largest = 0;
    for (const int sample : samples) {
      EXPECT_LE(std::abs(sample), 8192);
      EXPECT_LE(std::abs(sample - last), 1300);  // of 1 kHz at a quarter of full scale: no click
      last = sample;
      largest = std::max(largest, std::abs(sample));
    }
    EXPECT_GE(largest, 7000);
    EXPECT_LE(std::abs(samples.back()), 20);
  }
}

TEST(Tones, HaveThePitchThatIsAsked) {
  const Tone tone[] = {{440, 1}};
  const auto samples = samples_of(tone, 1);
  int crossings = 0;
  for (std::size_t i = 1; i < samples.size(); ++i) crossings += (samples[i - 1] < 0) != (samples[i] < 0);
  EXPECT_NEAR(crossings, 880, 2);
}

class Driver {
 public:
  explicit Driver(const char* name) { setenv("SDL_AUDIODRIVER", name, 1); }
  ~Driver() { unsetenv("SDL_AUDIODRIVER"); }
};

TEST(Speaker, WithoutADeviceItIsSilentAndSaysWhy) {
  const Driver driver("there_is_no_such_driver");
  Speaker speaker;
  EXPECT_THAT(speaker.silent_because(), testing::HasSubstr("no sound"));
  speaker.play(Cue::lost);
  EXPECT_EQ(speaker.waiting_s(), 0);
}

TEST(Speaker, PlaysOneAfterTheOtherButNotWhatWouldComeLate) {
  const Driver driver("dummy");
  Speaker speaker;
  ASSERT_EQ(speaker.silent_because(), "");
  for (int i = 0; i < 20; ++i) speaker.play(Cue::stopped);
  EXPECT_GT(speaker.waiting_s(), 0.5);
  EXPECT_LT(speaker.waiting_s(), 2.5);
  speaker.mute(true);
  EXPECT_EQ(speaker.waiting_s(), 0);
  speaker.play(Cue::stopped);
  EXPECT_EQ(speaker.waiting_s(), 0);
}

TEST(SeatSounds, BegunWithoutThemTheKeyTurnsThemOnAndOff) {
  const Driver driver("dummy");
  SeatSounds sounds(false);
  ASSERT_EQ(sounds.lines().size(), 1u);
  EXPECT_EQ(sounds.lines()[0].words, "off");
  EXPECT_EQ(sounds.lines()[0].cure, "on (F10)");
  sounds.hear({}, {}, true, 0);
  sounds.toggle();
  EXPECT_THAT(sounds.lines(), IsEmpty());
  sounds.toggle();
  ASSERT_EQ(sounds.lines().size(), 1u);
  EXPECT_EQ(sounds.lines()[0].words, "off");
}

TEST(SeatSounds, TurnedOnWithoutADeviceTheySayWhyNothingIsHeard) {
  const Driver driver("there_is_no_such_driver");
  SeatSounds sounds(false);
  sounds.toggle();
  ASSERT_EQ(sounds.lines().size(), 1u);
  EXPECT_THAT(sounds.lines()[0].words, testing::HasSubstr("no sound"));
}

}  // namespace
}  // namespace foresight::sounds_test
