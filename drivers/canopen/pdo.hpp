// Process data objects (CiA 301, 7.2.2): which objects a frame carries, and where in it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "drivers/can/can_frame.hpp"

namespace foresight::canopen {

class SdoAccess;

enum class PdoDirection : std::uint8_t { to_node, from_node };  ///< RPDO, TPDO: named as the node sees it

struct PdoEntry {
  std::uint16_t index = 0;
  std::uint8_t sub = 0;
  std::uint8_t bits = 0;  ///< 1 .. 64
  bool is_signed = false;
};

/// One PDO with its packing computed in advance. Packing neither throws nor allocates.
class Pdo {
 public:
  /// `number` 1 .. 512; `cob_id` 181h .. 57Fh. `transmission` (7.5.2.36): 1 with every SYNC, 255 on event.
  /// Throws InputError where the entries exceed 64 bits or there are none.
  Pdo(PdoDirection direction, int number, int node, std::uint32_t cob_id, std::uint8_t transmission,
      std::vector<PdoEntry> entries);

  PdoDirection direction() const noexcept { return direction_; }
  int number() const noexcept { return number_; }
  int node() const noexcept { return node_; }
  std::uint32_t cob_id() const noexcept { return cob_id_; }
  std::uint8_t transmission() const noexcept { return transmission_; }
  const std::vector<PdoEntry>& entries() const noexcept { return entries_; }
  std::uint8_t size() const noexcept { return size_; }  ///< of the frame in bytes
  std::string name() const;                             ///< "TPDO1"

  /// True where `frame` carries this PDO whole; one with more bytes is accepted (CiA 301, 7.2.2.5.2).
  bool carried_by(const CanFrame& frame) const noexcept;
  /// Entry `i` of a frame for which carried_by() holds.
  std::int64_t get(const CanFrame& frame, std::size_t i) const noexcept;
  /// Sets entry `i`, cutting `value` to its bits.
  void put(CanFrame& frame, std::size_t i, std::int64_t value) const noexcept;
  CanFrame empty_frame() const noexcept;

 private:
  PdoDirection direction_;
  int number_, node_;
  std::uint32_t cob_id_;
  std::uint8_t transmission_;
  std::vector<PdoEntry> entries_;
  std::vector<int> offsets_;  // in bits
  std::uint8_t size_ = 0;
};

/// Writes communication parameters and mapping in the order that CiA 301, 7.5.2.36 and 7.5.2.38 ask for
/// (disable, type, clear, entries, count, enable) and reads all of it back. Blocks. Throws RuntimeFailure (no
/// answer, refused) or InputError (the node kept another value).
void configure_pdo(SdoAccess& sdo, const Pdo& pdo);
/// Marks a PDO of the node as not existing; one that the node does not have is that already.
void disable_pdo(SdoAccess& sdo, PdoDirection direction, int number);

}  // namespace foresight::canopen
