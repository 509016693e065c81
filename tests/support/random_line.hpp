// A line that is made up at random: what a network does to packets, in true time.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <optional>
#include <random>
#include <vector>

namespace foresight {

/// One direction. Times in seconds, shares 0 .. 1.
struct RandomLineOptions {
  double base_s = 0.02;
  double jitter_s = 0;         ///< mean of an exponential delay added to each packet
  double congested_share = 0;  ///< of the time: then up to `congestion_s` more, for 0.5 to 5 s
  double congestion_s = 0.1;
  double loss = 0;            ///< of single packets
  double burst_share = 0;     ///< of the time in which all are lost, for 20 to 300 ms
  double outage_share = 0;    ///< of the time in which none gets through, for 0.3 to 10 s
  bool outage_keeps = false;  ///< what is sent in an outage waits for its end, instead of being lost
  double duplicated = 0;
  double late = 0;  ///< share that comes up to `late_s` later
  double late_s = 0.5;
  bool in_order = false;
  double step_every_s = 0;  ///< the base changes by up to `step_s`, about this often; 0: never
  double step_s = 0;
};

/// Carries values of any kind. What a packet meets depends on the seed and the order of sending alone.
template <typename T>
class RandomLine {
 public:
  RandomLine(RandomLineOptions options, std::uint64_t seed) : options_(options), random_(seed) {}

  /// From now on delays and losses come from elsewhere, such as a recorded line: when what is sent now arrives, if at
  /// all. Duplicates, late packets and losses of the options are added.
  void carry_by(std::function<std::optional<std::int64_t>(std::int64_t)> arrival) { arrival_ = std::move(arrival); }

  void send(std::int64_t now_ns, const T& value) {
    const double now = 1e-9 * static_cast<double>(now_ns);
    advance(now);
    const bool lost = chance(options_.loss) || now < burst_until_ || (now < outage_until_ && !options_.outage_keeps);
    if (lost) return;
    put(now_ns, value);
    if (chance(options_.duplicated)) put(now_ns, value);
  }
  /// What has arrived by `now_ns`, in the order of arrival.
  std::vector<T> take(std::int64_t now_ns) {
    std::vector<T> out;
    const auto later = [](const Packet& a, const Packet& b) {
      return a.at != b.at ? a.at > b.at : a.number > b.number;
    };
    while (!packets_.empty() && packets_.front().at <= now_ns) {
      std::pop_heap(packets_.begin(), packets_.end(), later);
      out.push_back(std::move(packets_.back().value));
      packets_.pop_back();
    }
    return out;
  }
  bool up(std::int64_t now_ns) {
    advance(1e-9 * static_cast<double>(now_ns));
    return !(1e-9 * static_cast<double>(now_ns) < std::max(outage_until_, burst_until_));
  }

 private:
  struct Packet {
    std::int64_t at = 0;
    std::uint64_t number = 0;
    T value;
  };
  double uniform(double a, double b) { return std::uniform_real_distribution(a, b)(random_); }
  bool chance(double share) { return share > 0 && uniform(0, 1) < share; }
  /// Whether a state begins that lasts `mean` on average and takes `share` of the time.
  bool begins(double share, double mean, double dt) {
    return share > 0 && uniform(0, 1) < dt * share / (mean * (1 - share));
  }
  void advance(double now) {
    const double dt = std::max(0.0, now - seen_);
    seen_ = std::max(seen_, now);
    if (dt == 0) return;
    if (now >= outage_until_ && begins(options_.outage_share, 2.5, dt))
      outage_until_ = now + std::min(10.0, 0.3 + std::exponential_distribution(1 / 2.2)(random_));
    if (now >= burst_until_ && begins(options_.burst_share, 0.16, dt)) burst_until_ = now + uniform(0.02, 0.3);
    if (now >= congested_until_ && begins(options_.congested_share, 2.75, dt)) {
      congested_until_ = now + uniform(0.5, 5);
      queue_ = uniform(0, options_.congestion_s);
    }
    if (options_.step_every_s > 0 && chance(dt / options_.step_every_s)) step_ = uniform(0, options_.step_s);
  }
  void put(std::int64_t now_ns, const T& value) {
    if (arrival_) {
      const auto at = arrival_(now_ns);
      if (at) keep(*at + (chance(options_.late) ? std::llround(1e9 * uniform(0, options_.late_s)) : 0), value);
      return;
    }
    const double now = 1e-9 * static_cast<double>(now_ns);
    double delay = options_.base_s + step_;
    if (options_.jitter_s > 0) delay += std::exponential_distribution(1 / options_.jitter_s)(random_);
    if (now < congested_until_) delay += queue_ * uniform(0.7, 1);
    if (chance(options_.late)) delay += uniform(0, options_.late_s);
    auto at = static_cast<std::int64_t>(1e9 * (std::max(now, now < outage_until_ ? outage_until_ : now) + delay));
    if (options_.in_order) at = last_ = std::max(last_, at);
    keep(at, value);
  }
  void keep(std::int64_t at, const T& value) {
    packets_.push_back({at, ++number_, value});
    std::push_heap(packets_.begin(), packets_.end(),
                   [](const Packet& a, const Packet& b) { return a.at != b.at ? a.at > b.at : a.number > b.number; });
  }

  RandomLineOptions options_;
  std::mt19937_64 random_;
  double seen_ = 0, outage_until_ = 0, burst_until_ = 0, congested_until_ = 0, queue_ = 0, step_ = 0;
  std::int64_t last_ = 0;
  std::uint64_t number_ = 0;
  std::function<std::optional<std::int64_t>(std::int64_t)> arrival_;
  std::vector<Packet> packets_;  // a heap, the first to arrive in front
};

}  // namespace foresight
