#include "sim/drives/generic_402.hpp"

#include <optional>

namespace foresight::sim {
namespace {

using enum DataType;
using enum Access;

struct Row {
  unsigned index, sub;
  DataType type;
  Access access;
  std::int64_t value;
  bool mappable = false;
  std::optional<std::int64_t> low = std::nullopt, high = std::nullopt;
};

// clang-format off
const Row kRows[] = {
  {0x1000, 0, uint32, ro, 0x00020192},  // servo drive, profile 402
  {0x1001, 0, uint8, ro, 0, true},
  {0x1005, 0, uint32, rw, 0x80},
  {0x1017, 0, uint16, rw, 0},
  {0x1018, 0, uint8, ro, 4}, {0x1018, 1, uint32, ro, 0}, {0x1018, 2, uint32, ro, 0},
  {0x1018, 3, uint32, ro, 0}, {0x1018, 4, uint32, ro, 0},
  {0x1029, 0, uint8, ro, 1}, {0x1029, 1, uint8, rw, 0, false, 0, 2},
  {0x1200, 0, uint8, ro, 2},
  {0x6007, 0, int16, rw, 1, false, 0, 3},        // abort connection option: fault
  {0x603F, 0, uint16, ro, 0, true},              // error code
  {0x6040, 0, uint16, rw, 0, true},              // controlword
  {0x6041, 0, uint16, ro, 0, true},              // statusword
  {0x605A, 0, int16, rw, 2, false, 0, 7},        // quick stop option
  {0x605B, 0, int16, rw, 0, false, 0, 1},        // shutdown option
  {0x605C, 0, int16, rw, 1, false, 0, 1},        // disable operation option
  {0x605D, 0, int16, rw, 1, false, 1, 3},        // halt option
  {0x605E, 0, int16, rw, 2, false, 0, 3},        // fault reaction option
  {0x6060, 0, int8, rw, 0, true},                // mode of operation
  {0x6061, 0, int8, ro, 0, true},                // mode of operation display
  {0x6062, 0, int32, ro, 0, true},               // position demand
  {0x6064, 0, int32, ro, 0, true},               // position actual
  {0x6065, 0, uint32, rw, 0},                    // following error window
  {0x6067, 0, uint32, rw, 0},                    // position window
  {0x606C, 0, int32, ro, 0, true},               // velocity actual
  {0x6072, 0, uint16, rw, 1000, true},           // max torque, 1/1000
  {0x6077, 0, int16, ro, 0, true},               // torque actual, 1/1000
  {0x607A, 0, int32, rw, 0, true},               // target position
  {0x607C, 0, int32, rw, 0},                     // home offset
  {0x607D, 0, uint8, ro, 2}, {0x607D, 1, int32, rw, 0}, {0x607D, 2, int32, rw, 0},  // software limits
  {0x607F, 0, uint32, rw, 0}, {0x6080, 0, uint32, rw, 0},
  {0x6081, 0, uint32, rw, 0, true}, {0x6083, 0, uint32, rw, 0, true}, {0x6084, 0, uint32, rw, 0, true},
  {0x6085, 0, uint32, rw, 0, true},              // quick stop deceleration
  {0x6086, 0, int16, rw, 0, false, 0, 0},        // profile type: trapezoidal only
  {0x6098, 0, int8, rw, 37},                     // homing method
  {0x6099, 0, uint8, ro, 2}, {0x6099, 1, uint32, rw, 0}, {0x6099, 2, uint32, rw, 0},
  {0x609A, 0, uint32, rw, 0},                    // homing acceleration
  {0x60B0, 0, int32, rw, 0, true}, {0x60B1, 0, int32, rw, 0, true}, {0x60B2, 0, int16, rw, 0, true},
  {0x60C0, 0, int16, rw, 0, false, 0, 0},
  {0x60C1, 0, uint8, ro, 1}, {0x60C1, 1, int32, rw, 0, true},
  {0x60C2, 0, uint8, ro, 2}, {0x60C2, 1, uint8, rw, 10, false, 1, 255}, {0x60C2, 2, int8, rw, -3, false, -6, 0},
  {0x60C5, 0, uint32, rw, 0}, {0x60C6, 0, uint32, rw, 0},
  {0x60F4, 0, int32, ro, 0, true},               // following error actual
  {0x60FD, 0, uint32, ro, 0, true},              // digital inputs
  {0x60FF, 0, int32, rw, 0, true},               // target velocity
  {0x6502, 0, uint32, ro, 0x1E1},                // modes: pp, hm, ip, csp, csv
};
// clang-format on

void add_communication(ObjectDictionary& out, unsigned node) {
  out.define(object_key(0x1003, 0), uint8, rw, 0);
  for (unsigned sub = 1; sub <= 8; ++sub) out.define(object_key(0x1003, sub), uint32, ro, 0);
  for (unsigned text : {0x1008u, 0x1009u, 0x100Au}) out.define(object_key(text), visible_string, constant, 0);
  out.set_text(object_key(0x1008), "Foresight emulated servo drive");
  out.set_text(object_key(0x1009), "1.0");
  out.set_text(object_key(0x100A), "1.0");
  out.define(object_key(0x1014), uint32, rw, 0x80 + node);
  out.define(object_key(0x1016, 0), uint8, ro, 4);
  for (unsigned sub = 1; sub <= 4; ++sub) out.define(object_key(0x1016, sub), uint32, rw, 0);
  out.define(object_key(0x1200, 1), uint32, ro, 0x600 + node);
  out.define(object_key(0x1200, 2), uint32, ro, 0x580 + node);
}

void add_pdo(ObjectDictionary& out, unsigned communication, unsigned mapping, std::int64_t identifier, bool transmit) {
  out.define(object_key(communication, 0), uint8, ro, 5);
  out.define(object_key(communication, 1), uint32, rw, identifier);
  out.define(object_key(communication, 2), uint8, rw, 255);
  if (transmit) out.define(object_key(communication, 3), uint16, rw, 0);
  if (transmit) out.define(object_key(communication, 5), uint16, rw, 0);
  for (unsigned sub = 0; sub <= 8; ++sub) out.define(object_key(mapping, sub), sub == 0 ? uint8 : uint32, rw, 0);
}

}  // namespace

ObjectDictionary generic_402(int node) {
  ObjectDictionary out;
  for (const Row& row : kRows) {
    out.define(object_key(row.index, row.sub), row.type, row.access, row.value, row.mappable);
    ObjectEntry& entry = *out.find(object_key(row.index, row.sub));
    entry.low = row.low;
    entry.high = row.high;
  }
  const unsigned id = static_cast<unsigned>(node);
  add_communication(out, id);
  constexpr std::int64_t kInvalid = 0x80000000;
  for (unsigned pdo = 0; pdo < 4; ++pdo) {
    const std::int64_t off = pdo == 0 ? 0 : kInvalid;
    add_pdo(out, 0x1400 + pdo, 0x1600 + pdo, off | (0x200 + 0x100 * pdo + id), false);
    add_pdo(out, 0x1800 + pdo, 0x1A00 + pdo, off | (0x180 + 0x100 * pdo + id), true);
  }
  out.set(object_key(0x1600, 1), 0x60400010);
  out.set(object_key(0x1600, 0), 1);
  out.set(object_key(0x1A00, 1), 0x60410010);
  out.set(object_key(0x1A00, 0), 1);
  return out;
}

}  // namespace foresight::sim
