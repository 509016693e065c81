// What the frames of a CAN log say, each by the protocol of its bus.
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>

#include "apps/can_jobs.hpp"
#include "drivers/can/candump_log.hpp"
#include "rig/rig.hpp"

namespace foresight {

/// A frame in words.
struct ExplainedFrame {
  std::string text;         ///< one line, with the joint's name where a rig knows it
  const char* kind = "";    ///< "SDO", "motion"; static
  std::optional<int> node;  ///< whose it is; absent for what concerns all
  bool unknown = false;     ///< says nothing known
  bool trouble = false;     ///< something went wrong: an emergency, an abort, a fault that is new, an error frame
};

/// A bus's protocol. Frames must come in the order of the bus. One thread.
class BusWords {
 public:
  virtual ~BusWords() = default;
  virtual ExplainedFrame explain(const CanFrame& frame) = 0;
};

/// A log's buses. One thread.
class LogWords {
 public:
  /// Throws InputError: neither protocol nor rig, both, or data sheets without CANopen.
  explicit LogWords(const CanExplainOptions& options);
  /// In the order of the log. Throws InputError where the rig has no such bus.
  ExplainedFrame explain(const CanLogEntry& entry);
  /// "3 (elbow)"
  std::string node_name(const std::string& interface, int node) const;

 private:
  std::unique_ptr<BusWords> make(const std::string& interface) const;
  const RigBus* bus_of(const std::string& interface) const;

  CanExplainOptions options_;
  std::optional<Rig> rig_;
  std::map<std::string, std::unique_ptr<BusWords>> buses_;  // by interface
};

}  // namespace foresight
