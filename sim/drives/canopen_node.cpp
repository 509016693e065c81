#include "sim/drives/canopen_node.hpp"

#include <algorithm>

namespace foresight::sim {
namespace {

constexpr Duration kBootTime = std::chrono::milliseconds(10);
constexpr unsigned kErrorHistory = 0x1003, kHeartbeatTime = 0x1017;
constexpr std::uint32_t kErrorRegister = object_key(0x1001), kSyncId = object_key(0x1005),
                        kEmergencyId = object_key(0x1014), kErrorBehaviour = object_key(0x1029, 1);

}  // namespace

CanopenNode::CanopenNode(const NodeConfig& config, ObjectDictionary dictionary, Send send)
    : DriveNode(config),
      objects_(std::move(dictionary)),
      send_(std::move(send)),
      sdo_({[this](std::uint32_t key, std::vector<std::uint8_t>& value) { return read(key, value); },
            [this](std::uint32_t key, const std::vector<std::uint8_t>& value, bool exact) {
              return write(key, value, exact);
            }}),
      pdos_(objects_,
            {[this](std::uint32_t key, std::span<const std::uint8_t> value) { write_mapped(key, value); },
             [this](const CanFrame& frame) { send_(frame); }, [this](std::uint16_t code) { emergency(code, 0x10); }}) {
  objects_.set(object_key(0x1018, 1), config.vendor);
  objects_.set(object_key(0x1018, 2), config.product);
  objects_.set(object_key(0x1018, 3), config.revision);
  objects_.set(object_key(0x1018, 4), config.serial);
  if (objects_.integer(object_key(0x1000)) == 0) objects_.set(object_key(0x1000), 0x00020192);
  defaults_ = objects_;
  reload();
}

void CanopenNode::reload() {
  pdos_.load();
  consumers_.load(objects_);
}

void CanopenNode::send(std::uint32_t id, std::span<const std::uint8_t> bytes) {
  CanFrame frame;
  frame.id = id;
  frame.size = static_cast<std::uint8_t>(bytes.size());
  std::copy(bytes.begin(), bytes.end(), frame.data.begin());
  send_(frame);
}

void CanopenNode::receive(const CanFrame& frame, RobotTime now) {
  now_ = now;
  if (frame.error || frame.extended || frame.fd || !alive()) return;
  const std::uint32_t node = static_cast<std::uint32_t>(config_.node);
  if (frame.id == 0) {
    if (frame.size == 2 && !frame.remote && (frame.data[1] == 0 || frame.data[1] == node)) command(frame.data[0], now);
    return;
  }
  consumers_.receive(frame, now);
  if (nmt_ == NmtState::stopped) return;
  if (frame.id == 0x600 + node && !frame.remote) {
    if (const auto answer = sdo_.answer(frame.payload(), now)) send(0x580 + node, *answer);
    return;
  }
  if (nmt_ != NmtState::operational) return;
  if (frame.id == static_cast<std::uint32_t>(objects_.integer(kSyncId, 0x80) & 0x7ff)) {
    refresh();
    pdos_.sync(now);
    synchronised(now);
  } else {
    pdos_.receive(frame);
  }
}

void CanopenNode::command(std::uint8_t command, RobotTime now) {
  switch (command) {
    case 0x01:
      if (nmt_ == NmtState::operational) return;
      enter(NmtState::operational);
      refresh();
      pdos_.start(now);
      return;
    case 0x02:
      if (nmt_ == NmtState::operational) connection_lost();
      enter(NmtState::stopped);
      return;
    case 0x80: enter(NmtState::pre_operational); return;
    case 0x81: restart(now); return;
    case 0x82:
      connection_lost();
      for (const auto& [key, entry] : defaults_.entries())
        if (key >> 8 >= 0x1000 && key >> 8 < 0x2000) objects_.entries()[key] = entry;
      reload();
      sdo_.reset();
      nmt_ = NmtState::initialising;
      boot_at_ = now + kBootTime;
      return;
    default: return;
  }
}

void CanopenNode::enter(NmtState state) {
  if (nmt_ == NmtState::initialising) return;
  sdo_.reset();
  nmt_ = state;
}

void CanopenNode::restart(RobotTime now) {
  objects_ = defaults_;
  reload();
  sdo_.reset();
  nmt_ = NmtState::initialising;
  boot_at_ = now + kBootTime;
  restarted();
}

void CanopenNode::boot(RobotTime now) {
  nmt_ = NmtState::pre_operational;
  const std::uint8_t boot_up = 0;
  send(0x700 + static_cast<std::uint32_t>(config_.node), {&boot_up, 1});
  heartbeat_at_ = now + std::chrono::milliseconds(objects_.integer(object_key(kHeartbeatTime)));
}

void CanopenNode::produce_heartbeat(RobotTime now) {
  const std::chrono::milliseconds period(objects_.integer(object_key(kHeartbeatTime)));
  if (period.count() == 0 || now < heartbeat_at_) return;
  const std::uint8_t state = static_cast<std::uint8_t>(nmt_);
  send(0x700 + static_cast<std::uint32_t>(config_.node), {&state, 1});
  heartbeat_at_ = now + period;
}

void CanopenNode::watch_masters(RobotTime now) {
  if (!consumers_.lost(now)) return;
  emergency(0x8130, 0x10);
  connection_lost();
  // Object 1029h:01: 0 leaves operational, 1 stays, 2 stops.
  const std::int64_t behaviour = objects_.integer(kErrorBehaviour);
  if (behaviour == 2)
    enter(NmtState::stopped);
  else if (behaviour == 0 && nmt_ == NmtState::operational)
    enter(NmtState::pre_operational);
}

void CanopenNode::step(RobotTime now, double dt) {
  now_ = now;
  if (!alive() && now >= boot_at_) boot(now);
  if (alive()) watch_masters(now);
  run(now, dt);
  if (!alive()) return;
  refresh();
  if (const auto aborted = sdo_.expire(now)) send(0x580 + static_cast<std::uint32_t>(config_.node), *aborted);
  if (nmt_ == NmtState::operational) pdos_.step(now);
  produce_heartbeat(now);
}

SdoAbort CanopenNode::read(std::uint32_t key, std::vector<std::uint8_t>& value) {
  const ObjectEntry* const entry = objects_.find(key);
  if (entry == nullptr) return objects_.has_index(key >> 8) ? SdoAbort::no_such_sub_index : SdoAbort::no_such_object;
  if (!readable(entry->access)) return SdoAbort::write_only;
  refresh();
  value = entry->value;
  return SdoAbort::none;
}

SdoAbort CanopenNode::check_range(std::uint32_t key, const ObjectEntry& entry, std::int64_t value) {
  if (entry.high && value > *entry.high) return SdoAbort::value_too_high;
  if (entry.low && value < *entry.low) return SdoAbort::value_too_low;
  if (key == object_key(kErrorHistory)) return value == 0 ? SdoAbort::none : SdoAbort::value_range;
  if (PdoSet::owns(key)) return pdos_.check(key, value);
  return check(key, value);
}

SdoAbort CanopenNode::write(std::uint32_t key, std::vector<std::uint8_t> value, bool exact) {
  ObjectEntry* const entry = objects_.find(key);
  if (entry == nullptr) return objects_.has_index(key >> 8) ? SdoAbort::no_such_sub_index : SdoAbort::no_such_object;
  if (!writable(entry->access)) return SdoAbort::read_only;
  const std::size_t size = size_of(entry->type);
  if (size != 0) {
    if (!exact && value.size() > size) value.resize(size);
    if (value.size() > size) return SdoAbort::too_long;
    if (value.size() < size) return SdoAbort::too_short;
    const SdoAbort code = check_range(key, *entry, decode_integer(value, is_signed(entry->type)));
    if (code != SdoAbort::none) return code;
  }
  entry->value = std::move(value);
  store(key, false);
  return SdoAbort::none;
}

// What a PDO brings in is dropped without a word where it is out of range.
void CanopenNode::write_mapped(std::uint32_t key, std::span<const std::uint8_t> value) {
  ObjectEntry* const entry = objects_.find(key);
  if (entry == nullptr || entry->value.size() != value.size()) return;
  if (check_range(key, *entry, decode_integer(value, is_signed(entry->type))) != SdoAbort::none) return;
  std::copy(value.begin(), value.end(), entry->value.begin());
  store(key, true);
}

void CanopenNode::store(std::uint32_t key, bool by_pdo) {
  if (PdoSet::owns(key)) pdos_.load();
  if (key >> 8 == 0x1016) consumers_.load(objects_);
  if (key >> 8 == kHeartbeatTime) heartbeat_at_ = now_;
  written(key, by_pdo);
}

void CanopenNode::emergency(std::uint16_t code, std::uint8_t bits) {
  const std::int64_t errors = objects_.integer(kErrorRegister) | bits | 1;
  objects_.set(kErrorRegister, errors);
  std::int64_t count = 0;
  while (objects_.find(object_key(kErrorHistory, static_cast<unsigned>(count) + 1)) != nullptr) ++count;
  for (std::int64_t sub = count; sub > 1; --sub)
    objects_.set(object_key(kErrorHistory, static_cast<unsigned>(sub)),
                 objects_.integer(object_key(kErrorHistory, static_cast<unsigned>(sub) - 1)));
  objects_.set(object_key(kErrorHistory, 1), code);
  objects_.set(object_key(kErrorHistory), std::min(count, objects_.integer(object_key(kErrorHistory)) + 1));
  const std::int64_t id = objects_.integer(kEmergencyId, 0x80 + config_.node);
  if ((id & 0x80000000) != 0 || !alive() || nmt_ == NmtState::stopped) return;
  const std::array<std::uint8_t, 8> bytes{static_cast<std::uint8_t>(code), static_cast<std::uint8_t>(code >> 8),
                                          static_cast<std::uint8_t>(errors)};
  send(static_cast<std::uint32_t>(id & 0x7ff), bytes);
}

void CanopenNode::clear_errors() {
  objects_.set(kErrorRegister, 0);
  const std::int64_t id = objects_.integer(kEmergencyId, 0x80 + config_.node);
  if ((id & 0x80000000) != 0 || !alive() || nmt_ == NmtState::stopped) return;
  send(static_cast<std::uint32_t>(id & 0x7ff), std::array<std::uint8_t, 8>{});
}

}  // namespace foresight::sim
