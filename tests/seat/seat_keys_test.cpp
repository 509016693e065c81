// What a key of the window does is told, and is one thing.
#include "seat/seat_keys.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <map>
#include <set>
#include <string>
#include <utility>

#include "input/keyboard_mouse.hpp"
#include "input/open_tracker.hpp"

namespace foresight::seat_keys_test {
namespace {

TEST(SeatKeys, NoKeyHasTwoMeanings) {
  std::map<int, std::string> used;
  for (const KeyBinding& binding : key_bindings())
    EXPECT_TRUE(used.emplace(binding.code, binding.printed).second) << binding.printed;
  for (const SeatKeyBinding& binding : seat_keys())
    EXPECT_TRUE(used.emplace(binding.code, binding.printed).second) << binding.printed;
}

/// The one for a hand that drives by the mouse, or by a device.
bool is_told(const std::string& key, const std::string& device = "") {
  const auto words = key_words(keys_of(device));
  return std::ranges::any_of(words, [&](const auto& row) { return row.first.find(key) != std::string::npos; });
}

TEST(SeatKeys, TheMouseAndTheDeviceInUseAreToldToo) {
  for (const char* of_mouse : {"left button", "right button", "wheel"}) EXPECT_TRUE(is_told(of_mouse)) << of_mouse;
  EXPECT_FALSE(is_told("right shoulder"));
  for (const char* device : {"gamepad", "gamepad:1"}) EXPECT_TRUE(is_told("right shoulder", device));
  EXPECT_TRUE(is_told("cap", "spacemouse"));
  EXPECT_EQ(key_words(keys_of("a.csv")).size(), key_words().size());
}

TEST(SeatKeys, OfWhatTheRigLacksAreNotTold) {
  const auto told = [](const DrivenParts& parts) {
    std::string all;
    for (const auto& [keys, does] : key_words({}, parts)) all += does + "\n";
    return all;
  };
  EXPECT_THAT(told({}), testing::AllOf(testing::HasSubstr("the camera"), testing::HasSubstr("gripper closes")));
  EXPECT_THAT(told({.gripper = false, .head = false}),
              testing::Not(testing::AnyOf(testing::HasSubstr("the camera"), testing::HasSubstr("gripper"))));
}

TEST(SeatKeys, EachIsTold) {
  std::set<std::string> told;
  for (const auto& [keys, does] : key_words()) {
    std::string word;
    for (const char c : keys + " ") {
      const bool ends = c == ' ' || c == ',' || c == ';';
      if (!ends) word += c;
      if (ends && !word.empty()) told.insert(std::exchange(word, ""));
    }
  }
  for (const SeatKeyBinding& binding : seat_keys()) EXPECT_TRUE(told.contains(binding.printed)) << binding.printed;
}

}  // namespace
}  // namespace foresight::seat_keys_test
