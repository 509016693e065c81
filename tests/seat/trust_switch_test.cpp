// The view gives way to the newest image, and comes back, by schedules of what was measured and predicted.
#include "seat/trust_switch.hpp"

#include <gmock/gmock.h>

#include <random>

namespace foresight::trust_switch_test {
namespace {

using namespace std::chrono_literals;

OperatorTime at(Duration time) {
  return OperatorTime{} + time;
}

/// Every 100 ms one of these; what it does after each: '.' shows the view, 'd' the newest image.
std::string shown_for(TrustSwitch& trust, const std::vector<double>& db) {
  std::string out;
  Duration now = 0ms;
  for (const double value : db) {
    trust.judged(at(now), "");
    trust.compared(at(now), value);
    out += trust.falls_back() ? 'd' : '.';
    now += 100ms;
  }
  return out;
}

TEST(TrustSwitch, FallsBackWhereTheViewIsPoorAndReturnsOnceItIsWell) {
  TrustSwitch trust;
  EXPECT_EQ(shown_for(trust, {30, 30, 15, 15, 15, 15, 15, 15, 21, 21, 30, 30, 30, 30, 30, 30, 30, 30, 30, 30, 30, 30}),
            "......dddddddddddddd..");
  EXPECT_EQ(trust.why(), "");
}

TEST(TrustSwitch, OnePoorPictureIsNoReason) {
  TrustSwitch trust;
  EXPECT_EQ(shown_for(trust, {30, 10, 30, 30, 10, 10, 30, 10, 10, 10, 30}), "...........");
}

// Around the threshold it stays with what it has: a view that changes with each image is worse than either.
TEST(TrustSwitch, DoesNotFlicker) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> about(18.5, 21.9);
  std::vector<double> db;
  for (int i = 0; i < 3000; ++i) db.push_back(about(random));
  TrustSwitch trust;
  const std::string shown = shown_for(trust, db);
  int changes = 0;
  for (std::size_t i = 1; i < shown.size(); ++i) changes += shown[i] != shown[i - 1];
  EXPECT_LE(changes, 1);
}

TEST(TrustSwitch, GivesWayAtOnceWhereNothingCanBePredictedAndSaysWhy) {
  TrustSwitch trust;
  trust.judged(at(0ms), "");
  EXPECT_FALSE(trust.falls_back());
  trust.judged(at(33ms), "nothing was heard for 1.2 s");
  EXPECT_TRUE(trust.falls_back());
  EXPECT_EQ(trust.why(), "nothing was heard for 1.2 s");
  trust.judged(at(66ms), "");
  EXPECT_TRUE(trust.falls_back()) << "not yet";
  trust.judged(at(400ms), "");
  EXPECT_TRUE(trust.falls_back());
  EXPECT_THAT(trust.why(), testing::StartsWith("just now: nothing was heard for 1.2 s; it can be predicted again"));
  trust.judged(at(600ms), "");
  EXPECT_FALSE(trust.falls_back());
  EXPECT_EQ(trust.why(), "");
}

TEST(TrustSwitch, TellsTheFidelityThatIsTooLow) {
  TrustSwitch trust;
  for (int i = 0; i < 8; ++i) {
    trust.judged(at(i * 100ms), "");
    trust.compared(at(i * 100ms), 14.2);
  }
  EXPECT_TRUE(trust.falls_back());
  EXPECT_THAT(trust.why(), testing::HasSubstr("14 dB"));
  EXPECT_THAT(trust.why(), testing::HasSubstr("below 20"));
}

}  // namespace
}  // namespace foresight::trust_switch_test
