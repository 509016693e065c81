#include "drivers/canopen/pdo.hpp"

#include "common/error.hpp"
#include "drivers/canopen/sdo_access.hpp"
#include "drivers/canopen/wire.hpp"

namespace foresight::canopen {
namespace {

constexpr std::uint32_t kInvalid = 0x80000000, kNoRemote = 0x40000000, kCobIdBits = 0x1fffffff;

std::uint64_t mask(int bits) {
  return bits >= 64 ? ~std::uint64_t{0} : (std::uint64_t{1} << bits) - 1;
}

struct Objects {
  std::uint16_t communication, mapping;
};
Objects objects_of(PdoDirection direction, int number) {
  const auto offset = static_cast<std::uint16_t>(number - 1);
  return direction == PdoDirection::to_node
             ? Objects{static_cast<std::uint16_t>(0x1400 + offset), static_cast<std::uint16_t>(0x1600 + offset)}
             : Objects{static_cast<std::uint16_t>(0x1800 + offset), static_cast<std::uint16_t>(0x1A00 + offset)};
}

}  // namespace

Pdo::Pdo(PdoDirection direction, int number, int node, std::uint32_t cob_id, std::uint8_t transmission,
         std::vector<PdoEntry> entries)
    : direction_(direction),
      number_(number),
      node_(node),
      cob_id_(cob_id),
      transmission_(transmission),
      entries_(std::move(entries)) {
  int bits = 0;
  bool each_ok = true;
  for (const PdoEntry& entry : entries_) {
    offsets_.push_back(bits);
    bits += entry.bits;
    each_ok = each_ok && entry.bits >= 1 && entry.bits <= 64;
  }
  if (bits == 0 || bits > 64 || !each_ok)
    throw InputError(name(), std::to_string(bits) + " bits are mapped", "map 1 to 64 bits");
  size_ = static_cast<std::uint8_t>((bits + 7) / 8);
}

std::string Pdo::name() const {
  return (direction_ == PdoDirection::to_node ? "RPDO" : "TPDO") + std::to_string(number_);
}

bool Pdo::carried_by(const CanFrame& frame) const noexcept {
  return is_canopen(frame) && frame.id == cob_id_ && frame.size >= size_;
}

std::int64_t Pdo::get(const CanFrame& frame, std::size_t i) const noexcept {
  const PdoEntry& entry = entries_[i];
  const std::uint64_t value = load(frame.payload(), size_) >> offsets_[i] & mask(entry.bits);
  return entry.is_signed ? sign_extended(value, entry.bits) : static_cast<std::int64_t>(value);
}

void Pdo::put(CanFrame& frame, std::size_t i, std::int64_t value) const noexcept {
  const std::uint64_t field = mask(entries_[i].bits) << offsets_[i];
  const std::uint64_t others = load(frame.payload(), size_) & ~field;
  store({frame.data.data(), size_}, others | (static_cast<std::uint64_t>(value) << offsets_[i] & field));
}

CanFrame Pdo::empty_frame() const noexcept {
  return data_frame(cob_id_, size_);
}

void configure_pdo(SdoAccess& sdo, const Pdo& pdo) {
  const auto [communication, mapping] = objects_of(pdo.direction(), pdo.number());
  const auto old = static_cast<std::uint32_t>(sdo.read({communication, 1, 4}));
  // A node may insist on the bit that says whether it answers remote requests; it is left as it is.
  const std::uint32_t id = (old & kNoRemote) | pdo.cob_id();
  // The other bits may change only once it does not exist (7.5.2.36).
  sdo.write({communication, 1, 4}, kInvalid | std::int64_t{old});
  sdo.write_proven({communication, 2, 1}, pdo.transmission());
  sdo.write({mapping, 0, 1}, 0);
  for (std::size_t i = 0; i < pdo.entries().size(); ++i) {
    const PdoEntry& e = pdo.entries()[i];
    sdo.write({mapping, static_cast<std::uint8_t>(i + 1), 4},
              std::uint32_t{e.index} << 16 | std::uint32_t{e.sub} << 8 | e.bits);
  }
  sdo.write_proven({mapping, 0, 1}, static_cast<std::int64_t>(pdo.entries().size()));
  for (std::size_t i = 0; i < pdo.entries().size(); ++i) {
    const PdoEntry& e = pdo.entries()[i];
    sdo.expect({mapping, static_cast<std::uint8_t>(i + 1), 4},
               std::uint32_t{e.index} << 16 | std::uint32_t{e.sub} << 8 | e.bits);
  }
  sdo.write({communication, 1, 4}, id);
  sdo.expect({communication, 1, 4}, id, kInvalid | kCobIdBits);
}

void disable_pdo(SdoAccess& sdo, PdoDirection direction, int number) {
  const std::uint16_t communication = objects_of(direction, number).communication;
  const auto old = sdo.read_if_there({communication, 1, 4});
  if (!old || (static_cast<std::uint32_t>(*old) & kInvalid)) return;
  sdo.write({communication, 1, 4}, kInvalid | *old);
  sdo.expect({communication, 1, 4}, kInvalid, kInvalid);
}

}  // namespace foresight::canopen
