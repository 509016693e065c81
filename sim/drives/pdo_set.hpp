// The process data objects of an emulated node (CiA 301, section 7.2.2): mapping, transmission types, timers.
#pragma once

#include <functional>
#include <vector>

#include "drivers/can/can_frame.hpp"
#include "sim/drives/object_dictionary.hpp"
#include "sim/drives/sdo_server.hpp"

namespace foresight::sim {

/// Works on the dictionary's objects 1400h .. 1BFFh as they are at the last load(). RTR-only types (252, 253) and
/// 29-bit identifiers are refused. A mapping may be written only while sub-index 0 is 0, and sub-index 0 only while the
/// PDO is invalid (the procedure of 7.5.2.36); else the abort code is 08000022h. One thread.
class PdoSet {
 public:
  struct Hooks {
    std::function<void(std::uint32_t key, std::span<const std::uint8_t> value)> write;
    std::function<void(const CanFrame&)> send;
    std::function<void(std::uint16_t code)> emergency;  ///< 8210h: a received PDO was too short
  };
  PdoSet(ObjectDictionary& dictionary, Hooks hooks) : dictionary_(dictionary), hooks_(std::move(hooks)) {}

  /// Whether `value` may be written to `key`, one of the objects above.
  SdoAbort check(std::uint32_t key, std::int64_t value) const;
  static bool owns(std::uint32_t key) { return key >> 8 >= 0x1400 && key >> 8 <= 0x1BFF; }
  void load();
  /// The node became operational: event-driven PDOs are due.
  void start(RobotTime now);

  /// Takes what is a PDO of ours; false else. Synchronous ones wait for sync().
  bool receive(const CanFrame& frame);
  void sync(RobotTime now);
  /// Sends event-driven PDOs whose values changed or whose timers ran out.
  void step(RobotTime now);

 private:
  struct Mapped {
    std::uint32_t key = 0;
    std::size_t size = 0;
  };
  struct Pdo {
    bool valid = false;
    std::uint32_t id = 0;
    unsigned type = 255;
    std::vector<Mapped> mapping;
    std::size_t size = 0;
    // receive
    std::optional<CanFrame> waiting;
    // transmit
    Duration inhibit{}, event{};
    unsigned syncs = 0;
    bool due = false;
    std::optional<RobotTime> sent;
    std::vector<std::uint8_t> last;
  };
  Pdo load_one(unsigned communication, unsigned mapping, bool transmit) const;
  SdoAbort check_entry(std::int64_t value, bool transmit) const;
  SdoAbort check_count(unsigned mapping, std::int64_t count, bool transmit) const;
  void apply(Pdo& pdo, const CanFrame& frame);
  std::vector<std::uint8_t> pack(const Pdo& pdo) const;
  void transmit(Pdo& pdo, RobotTime now);

  ObjectDictionary& dictionary_;
  Hooks hooks_;
  std::vector<Pdo> receive_, transmit_;
};

}  // namespace foresight::sim
