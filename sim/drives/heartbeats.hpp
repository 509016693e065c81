// The heartbeats that an emulated node listens to (CiA 301, 7.2.8.2.2 and object 1016h).
#pragma once

#include <vector>

#include "drivers/can/can_frame.hpp"
#include "sim/drives/object_dictionary.hpp"

namespace foresight::sim {

/// Each entry of 1016h watches one node, from its first heartbeat on. One thread.
class HeartbeatConsumers {
 public:
  void load(const ObjectDictionary& dictionary);
  void receive(const CanFrame& frame, RobotTime now);
  /// True once for each node that has fallen silent or told of a new boot; it is watched again from its next one.
  bool lost(RobotTime now);

 private:
  struct Watch {
    std::uint32_t id = 0;  // 700h + node
    Duration limit{};
    bool seen = false, booted = false;
    RobotTime last;
  };
  std::vector<Watch> watches_;
};

}  // namespace foresight::sim
