#include "sim/drives/heartbeats.hpp"

namespace foresight::sim {

void HeartbeatConsumers::load(const ObjectDictionary& dictionary) {
  watches_.clear();
  for (unsigned sub = 1; sub < 0x80; ++sub) {
    const std::int64_t entry = dictionary.integer(object_key(0x1016, sub));
    const std::uint32_t node = static_cast<std::uint32_t>(entry >> 16) & 0xff;
    const std::chrono::milliseconds limit(entry & 0xffff);
    if (node >= 1 && node <= 127 && limit.count() > 0) watches_.push_back({0x700 + node, limit, false, false, {}});
  }
}

void HeartbeatConsumers::receive(const CanFrame& frame, RobotTime now) {
  for (Watch& watch : watches_) {
    if (frame.id != watch.id || frame.size != 1 || frame.remote) continue;
    if (watch.seen && (frame.data[0] & 0x7f) == 0) watch.booted = true;
    watch.seen = true;
    watch.last = now;
  }
}

bool HeartbeatConsumers::lost(RobotTime now) {
  for (Watch& watch : watches_) {
    if (!watch.seen || (!watch.booted && now - watch.last <= watch.limit)) continue;
    watch.seen = watch.booted = false;
    return true;
  }
  return false;
}

}  // namespace foresight::sim
