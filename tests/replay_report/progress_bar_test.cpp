#include "apps/replay_report/progress_bar.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace foresight::progress_bar_test {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::EndsWith;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;
using testing::StartsWith;

const ProgressBar::Instant kStart{100s};

TEST(ProgressBar, RedrawsOneLineOnATerminal) {
  ProgressBar bar("replay", "images", 50, kStart, {.terminal = true, .columns = 80});
  EXPECT_THAT(bar.update(0, kStart), AllOf(StartsWith("\r"), HasSubstr("[...."), Not(HasSubstr("\n"))));
  EXPECT_THAT(bar.update(1, kStart + 50ms), IsEmpty()) << "too soon";
  const std::string half = bar.update(25, kStart + 5s);
  EXPECT_THAT(half, AllOf(HasSubstr("25/50 images"), HasSubstr("5.0/s"), HasSubstr("5 s left"), HasSubstr("#.")));
  EXPECT_EQ(std::count(half.begin(), half.end(), '#'), std::count(half.begin(), half.end(), '.') - 1) << "5.0";
  EXPECT_EQ(bar.finish(50, kStart + 10s), "\r\x1b[Kreplay: 50 images in 10 s, 5.0/s\n");
}

TEST(ProgressBar, NeverFillsTheLastColumn) {
  for (const int columns : {1, 5, 20, 40, 79, 80, 200}) {
    ProgressBar bar("replay", "images", 3000, kStart, {.terminal = true, .columns = columns});
    const std::string text = bar.update(1234, kStart + 60s);
    EXPECT_LT(text.size() - std::string("\r\x1b[K").size(), std::max<std::size_t>(2, columns)) << text;
  }
}

TEST(ProgressBar, AppendsALineEveryFewSecondsElsewhere) {
  ProgressBar bar("replay", "images", 3000, kStart, {.terminal = false});
  int lines = 0;
  for (int i = 1; i <= 300; ++i) {
    const std::string text = bar.update(static_cast<std::size_t>(i), kStart + i * 100ms);
    if (text.empty()) continue;
    ++lines;
    EXPECT_THAT(text, AllOf(StartsWith("replay  "), EndsWith("\n"), Not(HasSubstr("\x1b")), HasSubstr("10/s")));
  }
  EXPECT_EQ(lines, 6) << "30 s, a line every 5 s";
  EXPECT_EQ(bar.finish(300, kStart + 30s), "replay: 300 of 3000 images in 30 s, 10/s\n");
}

TEST(ProgressBar, WorksWithoutATotalAndWithoutTime) {
  ProgressBar bar("read", "files", 0, kStart, {.terminal = true});
  EXPECT_THAT(bar.update(3, kStart), HasSubstr("3 files"));
  EXPECT_EQ(bar.finish(0, kStart), "\r\x1b[Kread: 0 files in 0 s\n");
}

TEST(ReadableDuration, PicksTheUnit) {
  EXPECT_EQ(readable_duration(0s), "0 s");
  EXPECT_EQ(readable_duration(7900ms), "8 s");
  EXPECT_EQ(readable_duration(125s), "2 min 05 s");
  EXPECT_EQ(readable_duration(3720s), "1 h 02 min");
}

}  // namespace
}  // namespace foresight::progress_bar_test
