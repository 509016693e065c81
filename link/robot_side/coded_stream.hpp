// Pairs to one reader over a thin line: coded as it can take them, in pieces, as long as it reports.
//
//   newest pair --offer--> [waits] --as the line wants one--> encoder --> sender --pieces--> reader
//                                                                  ^                          |
//                                                                  '------- reports ----------'
//
// Predicted pictures build on what that one reader has, so there is one at a time: the first that reports. Another one
// takes its place once it has been silent for kYields.
#pragma once

#include <optional>

#include "common/clock.hpp"
#include "link/messages/foresight_messages.hpp"
#include "link/send_control/pair_sender.hpp"

namespace foresight::link {

/// Pure logic but for the time that coding takes, which `clock` tells; one thread.
class CodedStream {
 public:
  static constexpr Duration kYields = std::chrono::seconds(1);
  /// So long after the last report a stream ends: an outage is no reason to begin anew.
  static constexpr Duration kForgets = std::chrono::seconds(10);

  /// `session`: StereoFrame::session. `clock` must outlive this.
  CodedStream(std::uint64_t session, const Clock& clock, const PairSender::Options& options = {})
      : session_(session), clock_(clock), options_(options) {}

  void take(const StereoReport& report);
  bool has_reader() const { return stream_.has_value(); }

  /// The newest pair; one that still waits is not wanted any more. `frame`: without data.
  void offer(StereoFrame frame, StereoPicture picture);
  /// What is to be sent now. Throws what PairEncoder::encode() does for the pair that waited, which is gone then.
  std::vector<StereoPiece> step();
  /// When step() may have something without a report or a pair.
  std::optional<RobotTime> due() const;

  struct Counts {
    std::uint64_t coded = 0;     ///< pairs handed to the line
    std::uint64_t replaced = 0;  ///< by newer ones, before the line wanted one
    std::uint64_t bytes = 0;     ///< of pieces
    std::uint64_t refused = 0;   ///< reports of others than the reader
    double bytes_per_s = 0;      ///< that the line is taken to carry; 0: nobody reads
    double loss = 0;             ///< share of packets
  };
  Counts counts() const;

 private:
  struct Stream {
    std::uint32_t number;
    std::uint64_t reader;
    RobotTime heard;
    std::unique_ptr<PairEncoder> encoder = make_pair_encoder(Coding::h264);
    PairSender sender;
  };
  struct Waiting {
    StereoFrame frame;
    StereoPicture picture;
  };
  void begin(std::uint64_t reader, RobotTime now);
  void code(Stream& stream);
  void take_packets(Stream& stream, std::vector<StereoPiece>& out);

  const std::uint64_t session_;
  const Clock& clock_;
  const PairSender::Options options_;
  std::optional<Stream> stream_;
  std::optional<Waiting> waiting_;
  std::uint32_t streams_ = 0;
  Counts counts_;
};

}  // namespace foresight::link
