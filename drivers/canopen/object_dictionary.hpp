// What objects a device has: index, sub-index, type, access, limits and values (CiA 301, 7.4).
#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string>

namespace foresight::canopen {

/// CiA 301, 7.4.7, table 44; the values are those of the standard.
enum class DataType : std::uint16_t {
  none = 0,
  boolean = 0x01,
  integer8 = 0x02,
  integer16 = 0x03,
  integer32 = 0x04,
  unsigned8 = 0x05,
  unsigned16 = 0x06,
  unsigned32 = 0x07,
  real32 = 0x08,
  visible_string = 0x09,
  octet_string = 0x0a,
  unicode_string = 0x0b,
  time_of_day = 0x0c,
  time_difference = 0x0d,
  domain = 0x0f,
  integer24 = 0x10,
  real64 = 0x11,
  integer40 = 0x12,
  integer48 = 0x13,
  integer56 = 0x14,
  integer64 = 0x15,
  unsigned24 = 0x16,
  unsigned40 = 0x18,
  unsigned48 = 0x19,
  unsigned56 = 0x1a,
  unsigned64 = 0x1b,
};
/// Bits of an integer type (1 .. 64); 0 for all others.
int integer_bits(DataType type);
bool is_signed(DataType type);

enum class Access : std::uint8_t { read_only, write_only, read_write, constant };

/// A default or configured value. `number` is set for integer types; a 64-bit unsigned value is kept as
/// its two's complement.
struct ObjectValue {
  std::string text;  ///< as in the file
  std::optional<std::int64_t> number;
  bool node_relative = false;  ///< written with $NODEID; `number` contains the node id already
};

/// One entry that can be read or written.
struct ObjectEntry {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::string name;
  DataType type = DataType::none;
  Access access = Access::read_only;
  bool mappable = false;                  ///< into a PDO
  std::optional<std::int64_t> low, high;  ///< integers only
  std::optional<ObjectValue> default_value;
  std::optional<ObjectValue> configured_value;  ///< ParameterValue of a DCF
  int line = 0;                                 ///< of its section in the file
};

/// A plain container, ordered by index and sub-index.
class ObjectDictionary {
 public:
  /// False where the entry exists already.
  bool add(ObjectEntry entry);
  /// nullptr where there is none; valid until the next add().
  const ObjectEntry* find(std::uint16_t index, std::uint8_t sub) const;
  bool has(std::uint16_t index) const;
  std::size_t size() const { return entries_.size(); }
  auto begin() const { return entries_.begin(); }
  auto end() const { return entries_.end(); }

 private:
  std::map<std::uint32_t, ObjectEntry> entries_;  // index << 8 | sub
};

/// "6041:00".
std::string object_name(std::uint16_t index, std::uint8_t sub);

}  // namespace foresight::canopen
