#include "drivers/camera/stereo_pairing.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

namespace foresight {

std::optional<StereoPair> StereoPairing::add(Side side, ColourImage image, RobotTime now) noexcept {
  const auto own = static_cast<std::size_t>(side), other = 1 - own;
  if (!started_) started_ = now;
  Stream& stream = streams_[own];
  stream.arrived = now;
  if (!trusted(stream, own, image, now)) return std::nullopt;

  Stream& partner = streams_[other];
  std::size_t best = partner.count;
  Duration smallest = options_.tolerance;
  for (std::size_t i = 0; i < partner.count; ++i) {
    const Duration difference = std::chrono::abs(image.time - partner.waiting[i].time);
    if (difference > smallest) continue;
    smallest = difference;
    best = i;
  }
  if (best == partner.count) {
    if (stream.count == kWaiting) drop_oldest(own, 1, true);
    stream.waiting[stream.count++] = std::move(image);
    return std::nullopt;
  }
  StereoPair pair;
  drop_oldest(other, best, true);
  ColourImage& found = partner.waiting[0];
  pair.left = std::move(side == Side::left ? image : found);
  pair.right = std::move(side == Side::left ? found : image);
  drop_oldest(other, 1, false);
  drop_oldest(own, stream.count, true);
  ++counters_.pairs;
  return pair;
}

bool StereoPairing::trusted(Stream& stream, std::size_t index, const ColourImage& image, RobotTime now) noexcept {
  const bool plausible = image.time > stream.captured && std::chrono::abs(now - image.time) <= options_.largest_age;
  if (!plausible) {
    ++counters_.jumps[index];
    stream.distrust = options_.trusted_after;
    // Later images are compared with this one only where it may be true: one wild time must not condemn all others.
    if (std::chrono::abs(now - image.time) <= options_.largest_age) stream.captured = image.time;
    drop_oldest(index, stream.count, true);
    return false;
  }
  stream.captured = image.time;
  if (stream.distrust == 0) return true;
  --stream.distrust;
  ++counters_.jumps[index];
  return false;
}

void StereoPairing::drop_oldest(std::size_t index, std::size_t n, bool unpaired) noexcept {
  Stream& stream = streams_[index];
  if (unpaired) counters_.unpaired[index] += n;
  for (std::size_t i = 0; i < stream.count; ++i) {
    ColourImage kept = i + n < stream.count ? std::move(stream.waiting[i + n]) : ColourImage{};
    stream.waiting[i] = std::move(kept);
  }
  stream.count -= n;
}

const char* StereoPairing::reason(RobotTime now) const noexcept {
  if (!started_) return "no image yet";
  const auto frozen = [&](const Stream& stream) {
    return now - stream.arrived.value_or(*started_) > options_.frozen_after;
  };
  const bool left = frozen(streams_[0]), right = frozen(streams_[1]);
  if (left && right) return "both cameras are frozen";
  if (left) return "the left camera is frozen";
  if (right) return "the right camera is frozen";
  if (streams_[0].distrust > 0) return "the left camera's capture times jump";
  if (streams_[1].distrust > 0) return "the right camera's capture times jump";
  return "";
}

}  // namespace foresight
