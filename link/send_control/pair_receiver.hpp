// The operator's end of the line: pieces to pairs, pairs to pictures, and what to tell the sender. Pure logic.
#pragma once

#include <deque>
#include <map>
#include <memory>

#include "link/coding/pair_coder.hpp"
#include "link/send_control/packets.hpp"

namespace foresight {

/// A picture that came over the line, exactly as the other side's encoder has it.
struct ReceivedPair {
  std::uint32_t number = 0;
  std::size_t bytes = 0;  ///< of the coded pair
  StereoPicture picture;
  std::vector<std::uint8_t> notes{};  ///< CodedPair::notes
  bool newest = true;  ///< none that was captured later came before it; others only keep their lane going
};

/// Of one session of one sender: after a restart of the other side, begin with a new one. One thread.
class PairReceiver {
 public:
  explicit PairReceiver(std::unique_ptr<PairDecoder> decoder) : decoder_(std::move(decoder)) {}

  /// Takes any bytes; returns the pictures that can be shown now, mostly none. Of pieces that came before, of other
  /// packets and of damaged ones, nothing happens.
  std::vector<ReceivedPair> take(std::span<const std::uint8_t> packet, RobotTime now);
  /// The same in two steps, for who acknowledges before decoding takes its time. True: decode() may have something.
  bool receive(std::span<const std::uint8_t> packet, RobotTime now);
  std::vector<ReceivedPair> decode();

  /// What to send back: due kBetween after the last one, or at once where a pair was completed. Empty where nothing
  /// came since. `now` never goes back.
  Packet acknowledge(RobotTime now);
  /// When `acknowledge` has something; nothing where it has not.
  std::optional<RobotTime> acknowledgement_due() const { return due_; }

  static constexpr Duration kBetween = std::chrono::milliseconds(8);

 private:
  struct Assembly {
    std::vector<std::uint8_t> bytes;
    std::vector<bool> has;
    std::size_t missing = 0;
    std::map<std::uint16_t, std::vector<std::uint8_t>> spares;  // fewer than are missing
  };
  bool note(std::uint32_t sequence, RobotTime now);
  bool add(const Piece& piece);
  static void restore(Assembly& assembly);
  std::vector<ReceivedPair> decode_ready();
  bool never_comes(std::uint32_t pair) const;
  void keep_bounds();

  std::unique_ptr<PairDecoder> decoder_;
  std::map<std::uint32_t, Assembly> assemblies_;
  std::map<std::uint32_t, CodedPair> waiting_;  // whole, but what they build on is not here
  std::size_t assembled_bytes_ = 0;
  std::deque<std::uint32_t> done_;     // pairs that need no pieces any more
  std::deque<std::uint32_t> decoded_;  // of these, the ones that became pictures
  std::uint32_t undecodable_ = 0;
  std::optional<RobotTime> newest_captured_;

  std::uint32_t newest_ = 0;
  std::bitset<Acknowledgement::kBefore> before_;
  std::deque<Acknowledgement::Arrival> arrivals_;
  std::size_t told_ = 0;  // of arrivals_, those that an acknowledgement told before
  std::optional<RobotTime> due_, last_acknowledged_;
};

}  // namespace foresight
