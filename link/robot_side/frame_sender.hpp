// Live pairs onto the line: for the operator, and copies for ROS 2's tools.
//
//   coding jpeg   one message each on /foresight/frames, for every reader
//   coding h264   pieces on /foresight/pieces, for the one reader that reports (CodedStream)
#pragma once

#include <mutex>
#include <string>
#include <thread>

#include "common/latest_value.hpp"
#include "link/dds/endpoints.hpp"
#include "link/robot_side/coded_stream.hpp"
#include "link/robot_side/line_share.hpp"
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
  std::uint64_t replaced = 0;  ///< by newer ones, before the coder or the line was free
  std::uint64_t failed = 0;    ///< that could not be coded
  std::uint64_t bytes = 0;     ///< of the pairs sent
  bool watched = true;         ///< of h264: somebody reports
  double bytes_per_s = 0;      ///< of h264: what the line is taken to carry; 0: not known
};

/// What of LinkConfig concerns pairs; `capacity` is told what of h264 is known of the line, and outlives the sender.
struct FrameSenderOptions {
  LinkCoding coding = LinkCoding::jpeg;
  int jpeg_quality = 85;
  double rate_hz = 30;  ///< at most
  LineCapacity* capacity = nullptr;
};

/// Always the newest pair: a coder or a line that is slow costs pairs, not age, and nobody waits for a reader.
/// Copies are made only while somebody reads them. start() gives it a thread, and the coder of h264 one of its own, so
/// that reports are taken and lost pieces sent again while it is busy; step() does the same in the caller's.
class FrameSender {
 public:
  /// `lenses` may be null. `participant`, `wall` and `clock` must outlive this.
  FrameSender(Participant& participant, SenderName name, const StereoLenses* lenses, std::shared_ptr<FrameQueue> frames,
              const FrameSenderOptions& options, WallClock& wall, const Clock& clock);
  ~FrameSender() { stop(); }

  void start();
  void stop() noexcept;
  /// Sends the newest pair if one is there, waiting for it `timeout` at most; of h264 also what the line wants again.
  void step(Duration timeout) noexcept;

  FrameCounts counts() const noexcept;

 private:
  /// Of h264.
  struct Thin {
    Thin(Participant& participant, std::uint64_t session, const Clock& clock);
    Reader reports;
    std::mutex mutex;  // stream, pieces
    CodedStream stream;
    Writer pieces;
    LatestValue<PairToCode> to_code;  // one at most: there is no other one until it is finished
    std::jthread coder;
  };
  std::optional<LiveFramePtr> next(Duration timeout) noexcept;
  void send(const LiveFrame& frame);
  void send_jpeg(StereoFrame& message, const LiveFrame& frame);
  void serve_line();
  void code(PairToCode pair) noexcept;
  void send_pieces();
  void send_copies(const LiveFrame& frame, const StereoFrame& message);
  void count_failure() noexcept;

  const SenderName name_;
  const std::optional<StereoLenses> lenses_;
  const std::string revision_;
  std::shared_ptr<FrameQueue> frames_;
  const int quality_;
  LineCapacity* const capacity_;
  const Duration period_;
  WallClock& wall_;
  const Clock& clock_;
  RobotTime last_{INT64_MIN};  // capture of the last pair sent

  std::optional<Writer> pairs_;  // of jpeg
  std::optional<Thin> thin_;     // of h264
  Writer transforms_;
  std::array<Writer, 2> images_, infos_;
  mutable std::mutex mutex_;  // counts_; taken after Thin's
  FrameCounts counts_;
  std::jthread thread_;
};

}  // namespace foresight::link
