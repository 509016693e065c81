// The proof that nothing on the line moves the robot by accident.
#include <fmt/core.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <filesystem>
#include <vector>

#include "link/control/control_words.hpp"
#include "tests/control/session_world.hpp"
#include "tests/support/folders.hpp"

namespace foresight::control_sessions_test {
namespace {

/// The recorded lines, where they are at hand.
std::vector<SessionLine> recorded_lines() {
  std::vector<SessionLine> out;
  const std::filesystem::path folder = data_folder() / "line_traces";
  if (data_folder().empty() || !std::filesystem::exists(folder)) return out;
  const auto read = [&](const char* name) { return read_line_traces(folder / name); };
  out.push_back({read("TMobile-LTE-short.up").up, read("TMobile-LTE-short.down").up});
  out.push_back({read("Verizon-LTE-short.up").up, read("Verizon-LTE-short.down").up});
  out.push_back({read("ATT-LTE-driving.up").up, nullptr});
  const LineTraces starlink = read("starlink.csv");
  out.push_back({starlink.up, starlink.down});
  return out;
}

// FORESIGHT_LONG=1: all thousand. The first of them are the same. Where there are recorded lines, every other session
// is on one of them.
TEST(ControlSessionsTest, NothingMovesLateOrWithoutConsent) {
  const std::uint64_t sessions = std::getenv("FORESIGHT_LONG") != nullptr ? 1000 : 200;
  const std::vector<SessionLine> lines = recorded_lines();
  if (lines.empty()) fmt::print("no recorded lines: FORESIGHT_DATA is not set; all lines are made up\n");
  SessionCounts all;
  std::uint64_t moved = 0;
  for (std::uint64_t seed = 1; seed <= sessions; ++seed) {
    const bool recorded = seed % 2 == 0 && !lines.empty();
    const SessionCounts one = run_session(seed, recorded ? lines[seed / 2 % lines.size()] : SessionLine{});
    EXPECT_EQ(one.unsafe(), 0u) << fmt::format(
        "session {}: {} cycles after an expiry, {} motions without consent, {} cycles back, {} beyond limits, {} too "
        "late "
        "at rest",
        seed, one.executed_late, one.without_consent, one.went_back, one.limits_exceeded, one.rest_late);
    moved += one.motions > 0;
    all += one;
  }
  const auto dropped = [&all](SetPointFault fault) { return all.dropped[static_cast<std::size_t>(fault)]; };
  fmt::print(
      "{} sessions: {:.0f} s of motion in {} motions of {} presses, {} faults, {} set-points, of which {} were not in "
      "order, "
      "{} expired, {} without consent; {} messages played again; handed over {} times; at rest {:.0f} ms after the "
      "last "
      "expiry at most, of which {:.0f} ms are the stop from full speed\n",
      sessions, 0.004 * static_cast<double>(all.cycles_moving), all.motions, all.presses, all.faults, all.set_points,
      dropped(SetPointFault::out_of_order), dropped(SetPointFault::expired), dropped(SetPointFault::no_consent),
      all.replayed, all.handed_over, 1e3 * all.longest_to_rest_s, 1e3 * session_stop_s());
  // It was tried: what never moves is safe, too.
  EXPECT_GE(moved, sessions * 3 / 4);
  EXPECT_GE(all.motions, 2 * sessions);
  for (const SetPointFault fault : {SetPointFault::out_of_order, SetPointFault::from_the_future, SetPointFault::expired,
                                    SetPointFault::no_consent, SetPointFault::robot_is_busy})
    EXPECT_GT(dropped(fault), 0u) << words_for(fault).name;
  EXPECT_GT(all.replayed, 0u);
  EXPECT_GT(all.handed_over, 0u);
}

}  // namespace
}  // namespace foresight::control_sessions_test
