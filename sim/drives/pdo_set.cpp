#include "sim/drives/pdo_set.hpp"

#include <algorithm>

namespace foresight::sim {
namespace {

constexpr std::int64_t kInvalid = 0x80000000, kExtended = 0x20000000, kIdentifier = 0x1FFFFFFF;
constexpr unsigned kLastSynchronous = 240;

unsigned communication_of(unsigned mapping) {
  return mapping - 0x200;
}
bool is_mapping(unsigned index) {
  return (index & 0x200) != 0;
}
bool is_transmit(unsigned index) {
  return index >= 0x1800;
}
// Objects 0001h .. 0007h stand for so many bits of nothing.
bool is_dummy(std::uint32_t key) {
  return key >> 8 >= 1 && key >> 8 <= 7 && (key & 0xff) == 0;
}

SdoAbort check_identifier(std::int64_t value, std::int64_t before) {
  if ((value & kExtended) != 0 || (value & kIdentifier) > 0x7ff) return SdoAbort::value_range;
  const std::int64_t id = value & 0x7ff;
  // Identifiers of NMT, SYNC, SDO and error control are not to be had (CiA 301, table 38).
  const bool reserved = id <= 0x80 || (id >= 0x101 && id <= 0x180) || (id >= 0x581 && id <= 0x5ff) ||
                        (id >= 0x601 && id <= 0x67f) || (id >= 0x6e0 && id <= 0x6ff) || id >= 0x701;
  if ((value & kInvalid) == 0 && reserved) return SdoAbort::value_range;
  const bool both_valid = (value & kInvalid) == 0 && (before & kInvalid) == 0;
  return both_valid && id != (before & 0x7ff) ? SdoAbort::device_state : SdoAbort::none;
}

}  // namespace

SdoAbort PdoSet::check_entry(std::int64_t value, bool transmit) const {
  if (value == 0) return SdoAbort::none;
  const std::uint32_t key = static_cast<std::uint32_t>(value) >> 8;
  if (is_dummy(key)) return transmit ? SdoAbort::not_mappable : SdoAbort::none;
  const ObjectEntry* const entry = dictionary_.find(key);
  if (entry == nullptr) return dictionary_.has_index(key >> 8) ? SdoAbort::no_such_sub_index : SdoAbort::no_such_object;
  const bool direction = transmit ? readable(entry->access) && entry->access != Access::rww
                                  : writable(entry->access) && entry->access != Access::rwr;
  const bool fits = (value & 0xff) == static_cast<std::int64_t>(8 * size_of(entry->type)) && (value & 0xff) != 0;
  return entry->mappable && direction && fits ? SdoAbort::none : SdoAbort::not_mappable;
}

SdoAbort PdoSet::check_count(unsigned mapping, std::int64_t count, bool transmit) const {
  if (count > 8) return SdoAbort::value_too_high;
  std::int64_t bits = 0;
  for (unsigned sub = 1; sub <= count; ++sub) {
    const std::int64_t entry = dictionary_.integer(object_key(mapping, sub));
    if (entry == 0) return SdoAbort::no_such_object;
    if (const SdoAbort code = check_entry(entry, transmit); code != SdoAbort::none) return code;
    bits += entry & 0xff;
  }
  return bits > 64 ? SdoAbort::pdo_too_long : SdoAbort::none;
}

SdoAbort PdoSet::check(std::uint32_t key, std::int64_t value) const {
  const unsigned index = key >> 8, sub = key & 0xff;
  if (is_mapping(index)) {
    if ((dictionary_.integer(object_key(communication_of(index), 1)) & kInvalid) == 0) return SdoAbort::device_state;
    if (sub == 0) return check_count(index, value, is_transmit(index));
    if (dictionary_.integer(object_key(index)) != 0) return SdoAbort::device_state;
    return check_entry(value, is_transmit(index));
  }
  if (sub == 1) return check_identifier(value, dictionary_.integer(key));
  if (sub == 2 && value > kLastSynchronous && value < 254) return SdoAbort::value_range;
  const bool valid = (dictionary_.integer(object_key(index, 1)) & kInvalid) == 0;
  return sub == 3 && valid ? SdoAbort::device_state : SdoAbort::none;
}

PdoSet::Pdo PdoSet::load_one(unsigned communication, unsigned mapping, bool transmit) const {
  Pdo out;
  const std::int64_t identifier = dictionary_.integer(object_key(communication, 1), kInvalid);
  out.valid = (identifier & (kInvalid | kExtended)) == 0;
  out.id = static_cast<std::uint32_t>(identifier & 0x7ff);
  out.type = static_cast<unsigned>(dictionary_.integer(object_key(communication, 2), 255));
  out.inhibit = dictionary_.integer(object_key(communication, 3)) * std::chrono::microseconds(100);
  out.event = std::chrono::milliseconds(dictionary_.integer(object_key(communication, 5)));
  const std::int64_t count = dictionary_.integer(object_key(mapping));
  if (check_count(mapping, count, transmit) != SdoAbort::none) return out;  // a file that contradicts itself
  for (unsigned sub = 1; sub <= count; ++sub) {
    const auto entry = static_cast<std::uint32_t>(dictionary_.integer(object_key(mapping, sub)));
    out.mapping.push_back({entry >> 8, (entry & 0xff) / 8});
    out.size += (entry & 0xff) / 8;
  }
  return out;
}

void PdoSet::load() {
  receive_.clear();
  transmit_.clear();
  for (unsigned index = 0x1400; index < 0x1C00; ++index)
    if (!is_mapping(index) && dictionary_.has_index(index))
      (is_transmit(index) ? transmit_ : receive_).push_back(load_one(index, index + 0x200, is_transmit(index)));
}

void PdoSet::start(RobotTime now) {
  for (Pdo& pdo : receive_) pdo.waiting.reset();
  for (Pdo& pdo : transmit_) {
    pdo.syncs = 0;
    pdo.last.clear();
    pdo.due = true;
    pdo.sent.reset();
  }
  step(now);
}

bool PdoSet::receive(const CanFrame& frame) {
  for (Pdo& pdo : receive_) {
    if (!pdo.valid || pdo.id != frame.id) continue;
    if (frame.remote) return true;
    if (pdo.type > kLastSynchronous)
      apply(pdo, frame);
    else
      pdo.waiting = frame;
    return true;
  }
  return false;
}

void PdoSet::apply(Pdo& pdo, const CanFrame& frame) {
  if (frame.size < pdo.size) return hooks_.emergency(0x8210);
  std::size_t at = 0;
  for (const Mapped& mapped : pdo.mapping) {
    if (!is_dummy(mapped.key)) hooks_.write(mapped.key, std::span(frame.data).subspan(at, mapped.size));
    at += mapped.size;
  }
}

std::vector<std::uint8_t> PdoSet::pack(const Pdo& pdo) const {
  std::vector<std::uint8_t> out;
  for (const Mapped& mapped : pdo.mapping) {
    const std::vector<std::uint8_t>& value = dictionary_.find(mapped.key)->value;
    out.insert(out.end(), value.begin(), value.end());
  }
  return out;
}

void PdoSet::transmit(Pdo& pdo, RobotTime now) {
  pdo.last = pack(pdo);
  pdo.sent = now;
  pdo.due = false;
  CanFrame frame;
  frame.id = pdo.id;
  frame.size = static_cast<std::uint8_t>(pdo.last.size());
  std::copy(pdo.last.begin(), pdo.last.end(), frame.data.begin());
  hooks_.send(frame);
}

void PdoSet::sync(RobotTime now) {
  for (Pdo& pdo : receive_) {
    if (!pdo.waiting) continue;
    const CanFrame frame = *pdo.waiting;
    pdo.waiting.reset();
    apply(pdo, frame);
  }
  for (Pdo& pdo : transmit_) {
    if (!pdo.valid || pdo.mapping.empty() || pdo.type > kLastSynchronous) continue;
    const bool turn = pdo.type == 0 ? pdo.last != pack(pdo) : ++pdo.syncs >= pdo.type;
    if (!turn) continue;
    pdo.syncs = 0;
    transmit(pdo, now);
  }
}

void PdoSet::step(RobotTime now) {
  for (Pdo& pdo : transmit_) {
    if (!pdo.valid || pdo.mapping.empty() || pdo.type <= kLastSynchronous) continue;
    if (pdo.event.count() > 0 && pdo.sent && now - *pdo.sent >= pdo.event) pdo.due = true;
    if (!pdo.due && pdo.last == pack(pdo)) continue;
    if (pdo.sent && now - *pdo.sent < pdo.inhibit) continue;
    transmit(pdo, now);
  }
}

}  // namespace foresight::sim
