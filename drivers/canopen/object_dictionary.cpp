#include "drivers/canopen/object_dictionary.hpp"

#include <fmt/core.h>

namespace foresight::canopen {
namespace {

std::uint32_t object_key(std::uint16_t index, std::uint8_t sub) {
  return std::uint32_t{index} << 8 | sub;
}

}  // namespace

int integer_bits(DataType type) {
  switch (type) {
    case DataType::boolean: return 1;
    case DataType::integer8:
    case DataType::unsigned8: return 8;
    case DataType::integer16:
    case DataType::unsigned16: return 16;
    case DataType::integer24:
    case DataType::unsigned24: return 24;
    case DataType::integer32:
    case DataType::unsigned32: return 32;
    case DataType::integer40:
    case DataType::unsigned40: return 40;
    case DataType::integer48:
    case DataType::unsigned48: return 48;
    case DataType::integer56:
    case DataType::unsigned56: return 56;
    case DataType::integer64:
    case DataType::unsigned64: return 64;
    default: return 0;
  }
}

bool is_signed(DataType type) {
  switch (type) {
    case DataType::integer8:
    case DataType::integer16:
    case DataType::integer24:
    case DataType::integer32:
    case DataType::integer40:
    case DataType::integer48:
    case DataType::integer56:
    case DataType::integer64: return true;
    default: return false;
  }
}

bool ObjectDictionary::add(ObjectEntry entry) {
  const std::uint32_t at = object_key(entry.index, entry.sub);
  return entries_.emplace(at, std::move(entry)).second;
}

const ObjectEntry* ObjectDictionary::find(std::uint16_t index, std::uint8_t sub) const {
  const auto found = entries_.find(object_key(index, sub));
  return found == entries_.end() ? nullptr : &found->second;
}

bool ObjectDictionary::has(std::uint16_t index) const {
  const auto first = entries_.lower_bound(object_key(index, 0));
  return first != entries_.end() && first->second.index == index;
}

std::string object_name(std::uint16_t index, std::uint8_t sub) {
  return fmt::format("{:04X}:{:02X}", index, sub);
}

}  // namespace foresight::canopen
