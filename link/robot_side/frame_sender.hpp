// Live pairs onto the line: one message each, and copies for ROS 2's tools.
#pragma once

#include <atomic>
#include <mutex>
#include <string>
#include <thread>

#include "link/dds/endpoints.hpp"
#include "link/robot_side/pair_coder.hpp"
#include "link/robot_side/robot_messages.hpp"
#include "link/robot_side/wall_clock.hpp"
#include "scene/stereo_lenses.hpp"

namespace foresight::link {

/// What a sender says of itself in each message.
struct SenderName {
  std::uint64_t session = 0;        ///< chosen at random at its start
  std::vector<std::string> joints;  ///< names, in the rig's order
};

struct FrameCounts {
  std::uint64_t sent = 0;      ///< pairs
  std::uint64_t replaced = 0;  ///< by newer ones, before the coder was free
  std::uint64_t failed = 0;    ///< that could not be coded
  std::uint64_t bytes = 0;     ///< of the pairs sent
};

/// Always the newest pair, `rate_hz` at most: a coder that is slow costs pairs, not age, and nobody waits for a reader.
/// Copies are made only while somebody reads them. start() gives it a thread; step() does the same in the caller's.
class FrameSender {
 public:
  /// `lenses` may be null. `participant`, `wall` and `clock` must outlive this.
  FrameSender(Participant& participant, SenderName name, const StereoLenses* lenses, std::shared_ptr<FrameQueue> frames,
              PairCoder coder, double rate_hz, WallClock& wall, const Clock& clock);
  ~FrameSender() { stop(); }

  void start();
  void stop() noexcept;
  /// Sends the newest pair if one is there, waiting for it `timeout` at most.
  void step(Duration timeout) noexcept;

  FrameCounts counts() const noexcept;

 private:
  void send(const LiveFrame& frame);
  void send_copies(const LiveFrame& frame, const StereoFrame& message, RosTime right);

  const SenderName name_;
  const std::optional<StereoLenses> lenses_;
  const std::string revision_;
  std::shared_ptr<FrameQueue> frames_;
  const PairCoder coder_;
  const Duration period_;
  WallClock& wall_;
  const Clock& clock_;
  RobotTime last_{INT64_MIN};  // capture of the last pair sent
  Bytes buffer_;

  Writer pairs_, transforms_;
  std::array<Writer, 2> images_, infos_;
  mutable std::mutex mutex_;  // counts_
  FrameCounts counts_;
  std::jthread thread_;
};

}  // namespace foresight::link
