#include "apps/robot/terminal_keys.hpp"

#include <gtest/gtest.h>

namespace foresight::terminal_keys_test {
namespace {

TEST(TerminalKeys, LettersAreKeysAndArrowsAreSigns) {
  TerminalKeys keys;
  EXPECT_EQ(keys.of("e3q"), "e3q");
  EXPECT_EQ(keys.of("\x1b[A\x1b[B\x1b[C\x1b[D"), "+-+-");
  EXPECT_EQ(keys.of("\x1bOA\x1bOB"), "+-") << "as terminals send them to programs that ask for application keys";
}

TEST(TerminalKeys, WhatIsWithinASequenceIsNoKey) {
  TerminalKeys keys;
  EXPECT_EQ(keys.of("\x1b[3~e"), "e") << "Delete chooses no joint";
  EXPECT_EQ(keys.of("\x1b[15~\x1bOP\x1b[Hr"), "r") << "F5, F1, Home";
  EXPECT_EQ(keys.of("\x1b[[Ar"), "r") << "F1 on a console";
  EXPECT_EQ(keys.of("\x1b[1;5A"), "") << "with Ctrl";
  EXPECT_EQ(keys.of("\x1b"
                    "ed"),
            "d")
      << "Alt and e";
}

TEST(TerminalKeys, ASequenceMayBeCutAnywhere) {
  const std::string sequence = "\x1b[3~";
  for (std::size_t first = 1; first < sequence.size(); ++first) {
    TerminalKeys keys;
    EXPECT_EQ(keys.of(sequence.substr(0, first)), "");
    EXPECT_EQ(keys.of(sequence.substr(first) + "y"), "y") << "cut after " << first;
  }
}

TEST(TerminalKeys, AnEscapeAloneTakesNothingAway) {
  TerminalKeys keys;
  EXPECT_EQ(keys.of("\x1b"), "");
  EXPECT_EQ(keys.of(""), "");
  EXPECT_EQ(keys.of("e"), "e");
}

TEST(TerminalKeys, ASpaceIsOneWhereverItComes) {
  for (const std::string before : {"", "\x1b", "\x1b[", "\x1b[3", "\x1bO"}) {
    TerminalKeys keys;
    EXPECT_EQ(keys.of(before + " e"), " e");
  }
}

}  // namespace
}  // namespace foresight::terminal_keys_test
