// A robot, up to two operators and the lines between them, in stepped true time, with everything that goes wrong.
//
// What is judged is what the robot does, cycle by cycle, against what the people did: each press of a switch, each
// set-point and each state that reached somebody is noted outside of the programs.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>

#include "link/line/trace.hpp"

namespace foresight {

/// What was counted in one session or in many.
struct SessionCounts {
  // None of these may happen.
  std::uint64_t executed_late = 0;    ///< cycles that follow a set-point after its expiry
  std::uint64_t without_consent = 0;  ///< motions that no fresh press began
  std::uint64_t went_back = 0;        ///< cycles that follow an older set-point than one before
  std::uint64_t limits_exceeded = 0;  ///< cycles beyond position, velocity, acceleration or jerk
  std::uint64_t rest_late = 0;        ///< cycles that move later than 150 ms and the way to rest after the last expiry
  // These show that something was tried.
  std::uint64_t motions = 0, cycles_moving = 0, set_points = 0, presses = 0, handed_over = 0, faults = 0, replayed = 0;
  double longest_to_rest_s = 0;             ///< from the last expiry on
  std::array<std::uint64_t, 11> dropped{};  ///< by SetPointFault
  std::uint64_t unsafe() const { return executed_late + without_consent + went_back + limits_exceeded + rest_late; }
  SessionCounts& operator+=(const SessionCounts& other);
};

/// A recorded line, from somewhere in the middle of it on; null: made up.
struct SessionLine {
  std::shared_ptr<const Trace> up, down;  ///< robot to operator, and back; where one is absent, made up
};
/// Thirty seconds of true time, all of it drawn from the seed.
SessionCounts run_session(std::uint64_t seed, const SessionLine& line = {});
/// How long the robot of these sessions takes to stop from full speed, by its limits.
double session_stop_s();

}  // namespace foresight
