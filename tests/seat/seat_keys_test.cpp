// What a key of the window does is told, and is one thing.
#include "seat/seat_keys.hpp"

#include <gtest/gtest.h>

#include <map>
#include <set>
#include <string>
#include <utility>

#include "input/keyboard_mouse.hpp"

namespace foresight::seat_keys_test {
namespace {

TEST(SeatKeys, NoKeyHasTwoMeanings) {
  std::map<int, std::string> used;
  for (const KeyBinding& binding : key_bindings())
    EXPECT_TRUE(used.emplace(binding.code, binding.printed).second) << binding.printed;
  for (const SeatKeyBinding& binding : seat_keys())
    EXPECT_TRUE(used.emplace(binding.code, binding.printed).second) << binding.printed;
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
