#include "sim/drives/object_dictionary.hpp"

#include <algorithm>

namespace foresight::sim {

std::size_t size_of(DataType type) {
  switch (type) {
    case DataType::boolean:
    case DataType::int8:
    case DataType::uint8: return 1;
    case DataType::int16:
    case DataType::uint16: return 2;
    case DataType::int32:
    case DataType::uint32:
    case DataType::real32: return 4;
    case DataType::int64:
    case DataType::uint64:
    case DataType::real64: return 8;
    default: return 0;
  }
}

bool is_signed(DataType type) {
  return type == DataType::int8 || type == DataType::int16 || type == DataType::int32 || type == DataType::int64;
}

bool readable(Access access) {
  return access != Access::wo;
}

bool writable(Access access) {
  return access != Access::ro && access != Access::constant;
}

const ObjectEntry* ObjectDictionary::find(std::uint32_t key) const {
  const auto found = entries_.find(key);
  return found == entries_.end() ? nullptr : &found->second;
}

ObjectEntry* ObjectDictionary::find(std::uint32_t key) {
  const auto found = entries_.find(key);
  return found == entries_.end() ? nullptr : &found->second;
}

bool ObjectDictionary::has_index(unsigned index) const {
  const auto found = entries_.lower_bound(object_key(index));
  return found != entries_.end() && found->first >> 8 == index;
}

std::int64_t ObjectDictionary::integer(std::uint32_t key, std::int64_t otherwise) const {
  const ObjectEntry* const entry = find(key);
  if (entry == nullptr || entry->value.empty() || entry->value.size() > 8) return otherwise;
  return decode_integer(entry->value, is_signed(entry->type));
}

void ObjectDictionary::set(std::uint32_t key, std::int64_t value) {
  ObjectEntry* const entry = find(key);
  if (entry != nullptr && entry->value.size() <= 8) encode_integer(value, entry->value);
}

void ObjectDictionary::set_text(std::uint32_t key, const std::string& text) {
  if (ObjectEntry* const entry = find(key)) entry->value.assign(text.begin(), text.end());
}

void ObjectDictionary::define(std::uint32_t key, DataType type, Access access, std::int64_t value, bool mappable) {
  ObjectEntry entry{type, access, mappable, std::nullopt, std::nullopt, std::vector<std::uint8_t>(size_of(type))};
  encode_integer(value, entry.value);
  entries_[key] = std::move(entry);
}

std::int64_t decode_integer(std::span<const std::uint8_t> bytes, bool with_sign) {
  std::uint64_t value = 0;
  for (std::size_t i = 0; i < bytes.size(); ++i) value |= std::uint64_t{bytes[i]} << (8 * i);
  const unsigned unused = 64 - 8 * static_cast<unsigned>(bytes.size());
  if (bytes.empty() || !with_sign) return static_cast<std::int64_t>(value);
  return static_cast<std::int64_t>(value << unused) >> unused;
}

void encode_integer(std::int64_t value, std::span<std::uint8_t> bytes) {
  for (std::size_t i = 0; i < bytes.size(); ++i)
    bytes[i] = static_cast<std::uint8_t>(static_cast<std::uint64_t>(value) >> (8 * i));
}

}  // namespace foresight::sim
