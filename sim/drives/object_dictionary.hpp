// The object dictionary of an emulated CANopen node (CiA 301, section 7.4).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace foresight::sim {

/// Index and sub-index in one number, ordered as the dictionary is.
constexpr std::uint32_t object_key(unsigned index, unsigned sub = 0) {
  return index << 8 | sub;
}

/// Codes of CiA 301, table 44.
enum class DataType : std::uint16_t {
  boolean = 1,
  int8 = 2,
  int16 = 3,
  int32 = 4,
  uint8 = 5,
  uint16 = 6,
  uint32 = 7,
  real32 = 8,
  visible_string = 9,
  octet_string = 10,
  unicode_string = 11,
  domain = 15,
  real64 = 17,
  int64 = 21,
  uint64 = 27,
};
/// Bytes of a value; 0 where the length is free.
std::size_t size_of(DataType type);
bool is_signed(DataType type);

/// CiA 306: rww may be mapped into a receive PDO, rwr into a transmit PDO, rw into both.
enum class Access : std::uint8_t { ro, wo, rw, rwr, rww, constant };
bool readable(Access access);
bool writable(Access access);

struct ObjectEntry {
  DataType type = DataType::uint32;
  Access access = Access::rw;
  bool mappable = false;
  std::optional<std::int64_t> low, high;  ///< limits of an integer
  std::vector<std::uint8_t> value;        ///< as on the wire
};

/// A plain value; it checks nothing. One thread.
class ObjectDictionary {
 public:
  std::map<std::uint32_t, ObjectEntry>& entries() { return entries_; }
  const std::map<std::uint32_t, ObjectEntry>& entries() const { return entries_; }
  const ObjectEntry* find(std::uint32_t key) const;
  ObjectEntry* find(std::uint32_t key);
  bool has_index(unsigned index) const;

  /// The integer there; `otherwise` where there is none.
  std::int64_t integer(std::uint32_t key, std::int64_t otherwise = 0) const;
  /// Cut to the size of the object; nothing happens where there is none.
  void set(std::uint32_t key, std::int64_t value);
  void set_text(std::uint32_t key, const std::string& text);
  /// A new object, or a new definition of an old one.
  void define(std::uint32_t key, DataType type, Access access, std::int64_t value, bool mappable = false);

 private:
  std::map<std::uint32_t, ObjectEntry> entries_;
};

/// Little-endian, of 1 to 8 bytes.
std::int64_t decode_integer(std::span<const std::uint8_t> bytes, bool with_sign);
void encode_integer(std::int64_t value, std::span<std::uint8_t> bytes);

}  // namespace foresight::sim
