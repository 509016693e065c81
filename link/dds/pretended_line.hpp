// A line that is made up (link/line), between a program and its network: what real lines do, to be tried on a table.
//
//   writer --> out --> network --> in --> reader       the robot's program sends "up" and gets what comes "down",
//                                                      an operator's the other way round
//
// A sample crosses as datagrams of Ethernet's size, and is there when the last one is. Of a reliable topic a datagram
// that gets lost goes again at once, and comes a round trip later for each time; of others the sample is lost.
#pragma once

#include <condition_variable>
#include <functional>
#include <map>
#include <mutex>
#include <optional>
#include <thread>

#include "common/clock.hpp"
#include "link/line/delay_line.hpp"

namespace foresight::link {

/// Any thread.
class PretendedLine {
 public:
  enum class Side : std::uint8_t { robot, operating };

  struct Counts {
    std::uint64_t crossed = 0, lost = 0;  ///< samples, both ways
    std::uint64_t dropped = 0;            ///< of the lost, those that found kMostWaiting bytes before them
  };
  static constexpr std::size_t kMostWaiting = 256U << 20;  ///< bytes that go out; a bottleneck's queue may be endless

  /// It begins now. `clock` must outlive this.
  PretendedLine(const LineSpec& spec, Side side, const Clock& clock);
  ~PretendedLine();

  /// Calls `deliver` once a sample of `bytes` that leaves now has crossed: in step(), or in the thread of start().
  /// Never where it is lost. `repaired`: of a reliable topic.
  void send(std::size_t bytes, bool repaired, std::function<void()> deliver);
  /// When a sample that came in now is there; nothing: it is lost.
  std::optional<RobotTime> receive(std::size_t bytes, bool repaired);

  void start();
  void step();
  RobotTime now() const { return clock_.now(); }
  Counts counts() const;

 private:
  struct Waiting {
    std::size_t bytes;
    std::function<void()> deliver;
  };
  std::optional<RobotTime> cross(DelayLine& way, std::size_t bytes, bool repaired);
  void run(const std::stop_token& stop);

  const Clock& clock_;
  const Duration again_;      // a round trip of what was lost
  mutable std::mutex mutex_;  // all below
  DelayLine out_, in_;
  std::condition_variable_any earlier_;
  std::multimap<RobotTime, Waiting> waiting_;
  std::size_t waiting_bytes_ = 0;
  Counts counts_;
  std::jthread thread_;
};

}  // namespace foresight::link
