// From what comes over the line to whole pairs, of either coding, and what to report of it.
//
//   StereoFrame "jpeg" --checked--> two JPEGs decoded --------------------------.
//   StereoPiece --checked--> PairReceiver: whole, exact --> notes checked -------+--> LineFrame, newer than all before
//                                  '--> acknowledgements --> StereoReport
#pragma once

#include <functional>
#include <memory>

#include "common/clock.hpp"
#include "link/messages/checks.hpp"
#include "link/operator_side/line_frame.hpp"
#include "link/send_control/pair_receiver.hpp"

namespace foresight::link {

struct IntakeCounts {
  std::uint64_t pairs = 0;     ///< handed out
  std::uint64_t bytes = 0;     ///< of messages of pairs, copies included
  std::uint64_t refused = 0;   ///< pairs that are not as they should be
  std::uint64_t late = 0;      ///< whole, but a newer one had come
  std::uint64_t others = 0;    ///< pieces for another reader
  std::uint64_t packets = 0;   ///< pieces and questions that came, each once
  std::uint64_t expected = 0;  ///< of these, that were sent since the first that came
  std::string refusal;         ///< what was wrong with the last pair that was refused; "" before
  bool refuses = false;        ///< the last pair that came was refused
};

/// Pure logic but for the time that decoding takes, which `clock` tells; one thread.
class PairIntake {
 public:
  static constexpr Duration kReportEvery = std::chrono::milliseconds(250);  ///< where nothing else is to be told
  /// Another start of the robot's program, or another robot, is believed once this one has been silent for so long.
  static constexpr Duration kBelieves = std::chrono::seconds(1);

  /// `reader`: a random number, not 0. `expected`: names and sizes that frames have to have; its instant is not used.
  /// `clock`: ours; must outlive this.
  PairIntake(std::uint64_t reader, Expected expected, const Clock& clock);

  /// A message that decodes (from_cdr), of `bytes`. The pair, where it can be used and is the newest.
  LineFramePtr take(const StereoFrame& message, std::size_t bytes, const RobotClockTracker& robot);
  /// `whole`: called before a pair is decoded, which takes milliseconds that an acknowledgement should not wait.
  LineFramePtr take(const StereoPiece& piece, const RobotClockTracker& robot, const std::function<void()>& whole = {});

  /// What to send now; nothing where nothing is due.
  std::optional<StereoReport> report();
  OperatorTime report_due() const;

  const IntakeCounts& counts() const { return counts_; }

 private:
  OperatorTime now() const { return OperatorTime{clock_.now().ns}; }
  bool believes(std::uint64_t session);
  void begin_stream(std::uint32_t stream);
  void count_packet(std::span<const std::uint8_t> packet);
  std::string wrong_with(const StereoFrame& message, const RobotClockTracker& robot) const;
  LineFramePtr refuse(std::string why);
  std::shared_ptr<LineFrame> hand_out(const StereoFrame& message, StereoPicture picture, std::size_t bytes,
                                      OperatorTime arrived, const RobotClockTracker& robot);
  LineFramePtr frame_of(const foresight::ReceivedPair& pair, OperatorTime arrived, const RobotClockTracker& robot);

  const std::uint64_t reader_;
  const Expected expected_;
  const Clock& clock_;
  std::uint64_t session_ = 0;  // of the robot's program; 0: none heard of yet
  OperatorTime heard_;
  std::uint32_t stream_ = 0;
  std::optional<PairReceiver> receiver_;
  std::optional<std::uint32_t> first_packet_;  // of the stream
  std::uint64_t expected_before_ = 0;          // of earlier streams
  std::uint64_t newest_ = 0;                   // number of the last pair
  std::optional<OperatorTime> reported_;
  IntakeCounts counts_;
};

}  // namespace foresight::link
