// Both ends of the image stream and a line between them, in stepped time: what a line makes of the pictures' age and
// quality. The same options give the same result, bit for bit; the time that coding takes is measured beside.
#pragma once

#include <functional>

#include "link/line/gaps.hpp"
#include "link/line/packet_line.hpp"
#include "link/send_control/pair_receiver.hpp"
#include "link/send_control/pair_sender.hpp"

namespace foresight {

struct LineTrialOptions {
  LineSpec line;
  Duration length = std::chrono::seconds(60);
  double pairs_per_s = 30;  ///< of the camera
  Coding coding = Coding::h264;
  /// Instead of those of `coding`, where they are set: a model of a coder makes a trial as long as a real line's cheap.
  std::function<std::unique_ptr<PairEncoder>()> encoder{};
  std::function<std::unique_ptr<PairDecoder>()> decoder{};
  PairSender::Options sender{};
  bool compare = true;  ///< decode every pair beside the encoder, too, and compare what was shown with that
};

/// A pair that was decoded.
struct TrialPair {
  RobotTime captured, decoded;
  std::size_t bytes = 0;
  double psnr_db = 0;  ///< of the luma of all pixels of both eyes, against what the camera gave
};

struct LineTrialResult {
  std::vector<TrialPair> pairs;  ///< the newest ones only, in the order of their decoding
  std::size_t damaged = 0;       ///< pictures that are not bit for bit what the encoder made: 0
  std::size_t kept_lanes = 0;    ///< decoded, but overtaken by a newer one
  /// For each millisecond from the first picture on: the newest picture's age, less the age that the newest of small
  /// packets, one sent each millisecond over the same line with nothing else on it, would have.
  std::vector<double> age_beyond_ms;
  std::vector<bool> in_gap;  ///< of each of these: the line has stood still for kGap or more
  std::vector<Gap> gaps;
  /// Of each gap: from when the line could have carried kGapBytes after it until a pair captured after it was decoded.
  std::vector<double> recovery_ms;
  std::size_t up_bytes = 0, down_bytes = 0;         ///< sent, without headers of the network
  std::size_t packets = 0, spares = 0, copies = 0;  ///< of pieces; spare ones among them; sent again
  /// Hand-overs with more unacknowledged than was acknowledged of late (Transmissions::of_late), as WireCount counts
  /// it: 0.
  std::size_t early = 0;
  std::vector<double> encode_ms, decode_ms;  ///< CPU time per pair
};
inline constexpr Duration kGap = std::chrono::seconds(1);
inline constexpr double kGapBytes = 30'000;

/// `picture` gives what the camera sees at an instant, the same each time; they count from 0. `poll` is called now and
/// then. Throws what `picture`, `poll` and the coders throw.
LineTrialResult run_line_trial(const LineTrialOptions& options, const std::function<StereoPicture(RobotTime)>& picture,
                               const std::function<void()>& poll = {});

/// Peak signal-to-noise ratio of the luma of both eyes; 99 where they are equal.
double luma_psnr_db(const StereoPicture& a, const StereoPicture& b);

}  // namespace foresight
