#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "apps/command_line/command_line.hpp"

namespace foresight::read_command_line_test {
namespace {

struct Given {
  std::optional<int> ended;
  std::vector<double> start;
  std::string told;
};

Given given(std::vector<std::string> words) {
  words.insert(words.begin(), {"foresight", "move"});
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  Given out;
  testing::internal::CaptureStderr();
  out.ended = read_command_line(static_cast<int>(pointers.size()), pointers.data(), "help", "1", [&](Command& root) {
                root.add_subcommand("move", "help")->add_option("--start", out.start, "help")->expected(1, 9);
              }).ended;
  out.told = testing::internal::GetCapturedStderr();
  return out;
}

TEST(ReadCommandLine, NegativeNumbersNeedNoDigitBeforeThePoint) {
  const Given moved = given({"--start", "0", "-.6", "-1.4", ".5"});
  EXPECT_FALSE(moved.ended) << moved.told;
  EXPECT_THAT(moved.start, testing::ElementsAre(0, -0.6, -1.4, 0.5));
}

TEST(ReadCommandLine, NamesWordsThatBelongNowhereAsTheyWereTyped) {
  const Given lost = given({"--start", "1", "-x", "2", "3"});
  EXPECT_EQ(lost.ended, 2);
  EXPECT_THAT(lost.told, testing::HasSubstr("not expected: -x, 2, 3; see `foresight move --help`"));
}

}  // namespace
}  // namespace foresight::read_command_line_test
