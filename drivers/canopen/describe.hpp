// What a CANopen frame says, in words: for people who read a bus.
#pragma once

#include <span>
#include <string>

#include "drivers/canopen/object_dictionary.hpp"
#include "drivers/canopen/pdo.hpp"

namespace foresight::canopen {

struct Vocabulary {
  const ObjectDictionary* objects = nullptr;  ///< names of objects; absent: those of CiA 301 and 402 that we use
  std::span<const Pdo> pdos;                  ///< how PDOs are packed; absent: by the predefined set, as bytes
};

/// One line, such as
///   "NMT start, node 10"                               "heartbeat of node 3: operational"
///   "EMCY of node 2: 0x8110 CAN overrun (objects lost), error register 0x11 (generic, communication)"
///   "SDO answer of node 3: upload 6041:00 statusword = 0x0218 (fault)"
///   "SDO request to node 2: abort 1000:00 device type, 0x05040000 SDO protocol timed out"
///   "RPDO1 to node 2: 0F 00"      "SYNC"               "unknown"
/// A PDO of which no packing is given, but whose first two bytes are a known state or command by the 402 default
/// (RPDO1 6040h, TPDO1 6041h), says so with "as control word" / "as status word". Never throws but bad_alloc.
std::string describe(const CanFrame& frame, const Vocabulary& words = {});

}  // namespace foresight::canopen
