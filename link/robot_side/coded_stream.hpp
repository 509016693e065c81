// Pairs to one reader over a thin line: coded as it can take them, in pieces, as long as it reports.
//
//   newest pair --offer--> [waits] --begin, as the line wants one--> coder --finish--> sender --pieces--> reader
//                                                                      ^                 |                  |
//                                                                      '- arrived, gone -'<---- reports ----'
//
// Coding takes as long as ten packets' time on the line: whoever has a thread for it lets reports be taken and lost
// pieces be sent again meanwhile. What those say of pairs reaches the coder when it is done.
//
// Predicted pictures build on what that one reader has, so there is one at a time: the first that reports. Another one
// takes its place once it has been silent for kYields. Others may look on (a recorder): for them, pairs now and then
// build on none.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "common/clock.hpp"
#include "link/messages/foresight_messages.hpp"
#include "link/send_control/pair_sender.hpp"
#include "scene/coding_loss.hpp"

namespace foresight::link {

/// Codes a stream's pairs, and sees them as its reader will.
struct StreamCoder {
  std::unique_ptr<PairEncoder> encoder = make_pair_encoder(Coding::h264);
  std::unique_ptr<PairDecoder> decoder = make_pair_decoder();
  std::vector<std::uint8_t> left_lost{}, loss_shares{};  ///< of the last pair (PairNotes)
  LossCount lost{};
};

/// A pair on its way through the coder. The coder is the stream's: one pair at a time is there.
class PairToCode {
 public:
  /// Any thread. Throws what PairEncoder::encode() does.
  void code(const Clock& clock);

 private:
  friend class CodedStream;
  std::uint32_t stream_ = 0;
  std::shared_ptr<StreamCoder> coder_;
  PairWish wish_;
  StereoFrame frame_;
  StereoPicture picture_;
  std::optional<CodedPair> coded_;
};

/// Pure logic but for the time that coding takes, which `clock` tells; one thread at a time.
class CodedStream {
 public:
  static constexpr Duration kYields = std::chrono::seconds(1);
  /// So long after the last report a stream ends: an outage is no reason to begin anew.
  static constexpr Duration kForgets = std::chrono::seconds(10);
  /// While others look on, pairs build on nothing from before so often: they cannot ask for what they miss. Who has
  /// just come gets one at once, and one more after kAgain, as it may not have been listening yet.
  static constexpr Duration kAnewEvery = std::chrono::seconds(10), kAgain = std::chrono::seconds(1);

  /// `session`: StereoFrame::session. `clock` must outlive this.
  CodedStream(std::uint64_t session, const Clock& clock, const PairSender::Options& options = {})
      : session_(session), clock_(clock), options_(options) {}

  void take(const StereoReport& report);
  bool has_reader() const { return stream_.has_value(); }

  /// The newest pair; one that still waits is not wanted any more. `frame`: without data.
  void offer(StereoFrame frame, StereoPicture picture);
  /// How many read the pieces now, the one who reports included.
  void watched_by(std::size_t readers);

  /// The pair that the line wants now, if one waits: to be coded, and then to be given to finish(), whatever became of
  /// it. Until then there is no other one.
  std::optional<PairToCode> begin();
  void finish(PairToCode pair);
  /// What is to be sent now: before begin(), as it counts as on the way when the next pair is judged, and after
  /// finish().
  std::vector<StereoPiece> packets();
  /// When packets() may have something without a report or a pair.
  std::optional<RobotTime> due() const;

  struct Counts {
    std::uint64_t coded = 0;     ///< pairs handed to the line
    std::uint64_t replaced = 0;  ///< by newer ones, before the line wanted one
    std::uint64_t bytes = 0;     ///< of pieces
    std::uint64_t refused = 0;   ///< reports of others than the reader
    double bytes_per_s = 0;      ///< that the line carries; 0: not known
    double loss = 0;             ///< share of packets
  };
  Counts counts() const;

 private:
  /// To the coder or, while that is busy, kept for it.
  struct Fates final : PairFates {
    struct Fate {
      std::uint32_t pair;
      bool arrived;
    };
    void arrived(std::uint32_t pair) override { tell({pair, true}); }
    void gone(std::uint32_t pair) override { tell({pair, false}); }
    void tell(Fate fate);
    void coder_is_done();

    std::shared_ptr<StreamCoder> coder = std::make_shared<StreamCoder>();
    bool busy = false;
    std::vector<Fate> kept{};
  };
  struct Stream {
    std::uint32_t number;
    std::uint64_t reader;
    RobotTime heard;
    PairSender sender;
    Fates fates{};
    // For who looks on, pairs that build on nothing.
    std::optional<RobotTime> last_anew{}, anew_due{};
    bool again = false;  // another one is due after kAgain
  };
  struct Waiting {
    StereoFrame frame;
    StereoPicture picture;
  };
  void begin_stream(std::uint64_t reader, RobotTime now);
  void begin_anew_if_due(Stream& stream, RobotTime now) const;

  const std::uint64_t session_;
  const Clock& clock_;
  const PairSender::Options options_;
  std::optional<Stream> stream_;
  std::optional<Waiting> waiting_;
  std::uint32_t streams_ = 0;
  std::size_t readers_ = 0;
  Counts counts_;
};

}  // namespace foresight::link
