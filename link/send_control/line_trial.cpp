#include "link/send_control/line_trial.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <set>

#include "common/cpu_time.hpp"
#include "link/send_control/wire_count.hpp"

namespace foresight {
namespace {

constexpr std::size_t kProbeBytes = 64;
constexpr Duration kMillisecond = std::chrono::milliseconds(1);
constexpr Duration kShortestStep = std::chrono::microseconds(1);

double squared_error(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat luma_a = a, luma_b = b;
  if (a.channels() == 3) {
    cv::cvtColor(a, luma_a, cv::COLOR_BGR2GRAY);
    cv::cvtColor(b, luma_b, cv::COLOR_BGR2GRAY);
  }
  return cv::norm(luma_a, luma_b, cv::NORM_L2SQR);
}

std::size_t fingerprint(const StereoPicture& picture) {
  std::size_t out = 0;
  for (const cv::Mat& eye : {picture.left, picture.right}) {
    const cv::Mat whole = eye.isContinuous() ? eye : eye.clone();
    const std::string_view bytes(reinterpret_cast<const char*>(whole.data), whole.total() * whole.elemSize());
    out = out * 31 + std::hash<std::string_view>{}(bytes);
  }
  return out;
}

class Trial {
 public:
  Trial(const LineTrialOptions& options, const std::function<StereoPicture(RobotTime)>& picture)
      : options_(options),
        picture_(picture),
        up_(options.line.up, RobotTime{}, options.line.seed),
        down_(options.line.down, RobotTime{}, options.line.seed + 1),
        encoder_(options.encoder ? options.encoder() : make_pair_encoder(options.coding)),
        sender_(options.sender),
        receiver_(options.decoder ? options.decoder() : make_pair_decoder()),
        mirror_(options.decoder ? options.decoder() : make_pair_decoder()) {}

  void run(const std::function<void()>& poll) {
    const RobotTime end = RobotTime{} + options_.length;
    for (RobotTime now{}; now < end; now = next_event(now)) {
      if (poll) poll();
      step(now);
    }
  }

  LineTrialResult result;
  const DelayLine& up() const { return up_.line(); }

 private:
  Duration period() const { return seconds(1 / options_.pairs_per_s); }

  void step(RobotTime now) {
    while (std::optional<Packet> packet = up_.receive(now)) show(*packet, now);
    if (const Packet packet = receiver_.acknowledge(now); !packet.empty()) {
      result.down_bytes += packet.size();
      down_.send(now, packet);
    }
    while (std::optional<Packet> packet = down_.receive(now)) {
      wire_.comes(*packet, now);
      sender_.take(*packet, now, *encoder_);
    }
    if (now >= next_capture_) {
      newest_ = next_capture_;
      next_capture_ = next_capture_ + period();
    }
    // Lost pieces go first; their packets count as on the way when the next pair is judged.
    send(now);
    if (newest_ && sender_.wants_pair(now)) {
      hand_over(now);
      send(now);
    }
  }

  void send(RobotTime now) {
    for (const Packet& packet : sender_.packets(now, *encoder_)) {
      result.up_bytes += packet.size();
      const auto parsed = parse_packet(packet);
      if (const auto* piece = std::get_if<Piece>(&parsed)) {
        ++result.packets;
        result.copies += !sent_.insert({piece->pair, piece->index}).second;
        result.spares += piece->is_spare();
      }
      const std::size_t before = up_.on_the_way();
      up_.send(now, packet);
      if (up_.on_the_way() > before) wire_.leaves(packet);
    }
  }

  void hand_over(RobotTime now) {
    result.early += wire_.unacknowledged() > wire_.acknowledged_within(sender_.transmissions().of_late(), now);
    const StereoPicture picture = picture_(*newest_);
    newest_.reset();
    const double begin = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
    const CodedPair pair = encoder_->encode(picture, sender_.wish(now));
    result.encode_ms.push_back(1e3 * (cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - begin));
    sender_.hand_over(pair, now);
    if (options_.compare) made_[pair.number] = fingerprint(mirror_->decode(pair).value());
  }

  void show(const Packet& packet, RobotTime now) {
    const double begin = cpu_seconds(CLOCK_THREAD_CPUTIME_ID);
    const std::vector<ReceivedPair> pairs = receiver_.take(packet, now);
    if (pairs.empty()) return;
    result.decode_ms.push_back(1e3 * (cpu_seconds(CLOCK_THREAD_CPUTIME_ID) - begin));
    for (const ReceivedPair& pair : pairs) {
      result.damaged += options_.compare && made_.at(pair.number) != fingerprint(pair.picture);
      if (!pair.newest) {
        ++result.kept_lanes;
        continue;
      }
      const double psnr = luma_psnr_db(picture_(pair.picture.captured), pair.picture);
      result.pairs.push_back({pair.picture.captured, now, pair.bytes, psnr});
    }
  }

  RobotTime next_event(RobotTime now) const {
    RobotTime next = next_capture_;
    for (const std::optional<RobotTime>& event :
         {up_.next(), down_.next(), sender_.due(), receiver_.acknowledgement_due()})
      if (event) next = std::min(next, *event);
    return std::max(next, now + kShortestStep);
  }

  const LineTrialOptions& options_;
  const std::function<StereoPicture(RobotTime)>& picture_;
  PacketLine up_, down_;
  std::unique_ptr<PairEncoder> encoder_;
  PairSender sender_;
  WireCount wire_;  // at the sender's end
  PairReceiver receiver_;
  std::unique_ptr<PairDecoder> mirror_;        // beside the encoder, over no line
  std::map<std::uint32_t, std::size_t> made_;  // by number, what that showed
  RobotTime next_capture_{};
  std::optional<RobotTime> newest_;                         // captured and not handed over
  std::set<std::pair<std::uint32_t, std::uint16_t>> sent_;  // pair and index
};

/// Of each millisecond, when the newest small packet that came by then was sent over the idle line.
std::vector<std::optional<RobotTime>> newest_probes(const DelayLine& line, Duration length) {
  std::vector<std::optional<RobotTime>> out(static_cast<std::size_t>(length / kMillisecond) + 1);
  for (RobotTime sent{}; sent < RobotTime{} + length; sent = sent + kMillisecond) {
    const std::optional<RobotTime> arrival = line.idle_arrival(sent, kProbeBytes);
    if (!arrival) continue;
    const auto at = static_cast<std::size_t>((arrival->ns + kMillisecond.count() - 1) / kMillisecond.count());
    if (at < out.size()) out[at] = sent;  // the last one is the newest
  }
  for (std::size_t i = 1; i < out.size(); ++i)
    if (!out[i] || (out[i - 1] && *out[i] < *out[i - 1])) out[i] = out[i - 1];
  return out;
}

void measure_ages(LineTrialResult& result, const DelayLine& line, const LineTrialOptions& options) {
  if (result.pairs.empty()) return;
  const auto probes = newest_probes(line, options.length);
  const auto first = static_cast<std::size_t>(result.pairs.front().decoded.ns / kMillisecond.count()) + 1;
  std::size_t shown = 0;
  for (std::size_t ms = first; ms < probes.size(); ++ms) {
    const RobotTime now{static_cast<std::int64_t>(ms) * kMillisecond.count()};
    while (shown + 1 < result.pairs.size() && result.pairs[shown + 1].decoded <= now) ++shown;
    if (!probes[ms]) continue;
    result.age_beyond_ms.push_back(1e3 * to_seconds(*probes[ms] - result.pairs[shown].captured));
    const Duration there = Duration{now.ns} - options.line.up.delay;
    result.in_gap.push_back(std::any_of(result.gaps.begin(), result.gaps.end(),
                                        [&](const Gap& gap) { return gap.begin <= there && there <= gap.end; }));
  }
}

void measure_recovery(LineTrialResult& result, const DelayLine& line, Duration length) {
  for (const Gap& gap : result.gaps) {
    RobotTime carried = RobotTime{} + gap.end;
    while (carried - RobotTime{} < length && line.capacity(RobotTime{} + gap.end, carried) < kGapBytes)
      carried = carried + kMillisecond;
    const auto fresh = std::find_if(result.pairs.begin(), result.pairs.end(),
                                    [&](const TrialPair& pair) { return pair.captured >= RobotTime{} + gap.end; });
    // A gap near the end of the trial tells nothing.
    const RobotTime decoded = fresh == result.pairs.end() ? RobotTime{} + length : fresh->decoded;
    if (fresh == result.pairs.end() && length - (carried - RobotTime{}) < kGap) continue;
    result.recovery_ms.push_back(std::max(0.0, 1e3 * to_seconds(decoded - carried)));
  }
}

}  // namespace

double luma_psnr_db(const StereoPicture& a, const StereoPicture& b) {
  double error = squared_error(a.left, b.left);
  auto pixels = static_cast<double>(a.left.total());
  if (!a.right.empty()) {
    error += squared_error(a.right, b.right);
    pixels += static_cast<double>(a.right.total());
  }
  return error > 0 ? std::min(99.0, 10 * std::log10(255 * 255 * pixels / error)) : 99.0;
}

LineTrialResult run_line_trial(const LineTrialOptions& options, const std::function<StereoPicture(RobotTime)>& picture,
                               const std::function<void()>& poll) {
  Trial trial(options, picture);
  trial.run(poll);
  LineTrialResult result = std::move(trial.result);
  result.gaps = gaps_of(options.line.up, kGap, options.length);
  measure_ages(result, trial.up(), options);
  measure_recovery(result, trial.up(), options.length);
  return result;
}

}  // namespace foresight
