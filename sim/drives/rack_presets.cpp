#include "sim/drives/rack_presets.hpp"

namespace foresight::sim {
namespace {

constexpr double kDegree = 0.017453292519943295;

struct Joint {
  const char* name;
  double range_deg, velocity_deg, acceleration_deg, inertia;
};
// Round figures of a light arm on a table and of a camera head.
constexpr Joint kJoints[] = {
    {"arm_1", 170, 70, 200, 4.0},  {"arm_2", 115, 70, 200, 4.0},  {"arm_3", 170, 70, 200, 2.0},
    {"arm_4", 115, 70, 200, 1.5},  {"arm_5", 170, 100, 300, 0.4}, {"arm_6", 115, 100, 300, 0.3},
    {"arm_7", 170, 100, 300, 0.1}, {"pan", 175, 240, 900, 0.05},  {"tilt", 115, 240, 900, 0.05},
};

std::vector<NodeConfig> rack(NodeConfig::Kind kind, int first_node, bool homed) {
  std::vector<NodeConfig> out;
  for (const Joint& joint : kJoints) {
    NodeConfig config;
    config.kind = kind;
    config.node = first_node + static_cast<int>(out.size());
    config.name = joint.name;
    config.serial = 1000u + static_cast<unsigned>(config.node);
    config.homed = homed;
    config.max_position = joint.range_deg * kDegree;
    config.min_position = -config.max_position;
    config.motor.max_stop = config.max_position + 3 * kDegree;
    config.motor.min_stop = -config.motor.max_stop;
    config.motor.max_velocity = joint.velocity_deg * kDegree;
    config.motor.max_acceleration = joint.acceleration_deg * kDegree;
    config.motor.inertia = joint.inertia;
    config.motor.viscous = 0.2 * joint.inertia;
    config.motor.coulomb = 0.05 * joint.inertia;
    config.motor.brake_torque = 40 * joint.inertia;
    config.motor.torque_limit = 3 * config.motor.max_acceleration * joint.inertia;
    config.high_switch = config.max_position + 1 * kDegree;
    config.low_switch = -config.high_switch;
    out.push_back(config);
  }
  return out;
}

}  // namespace

std::vector<NodeConfig> powercube_rack() {
  return rack(NodeConfig::Kind::powercube, 1, false);
}

std::vector<NodeConfig> cia402_rack() {
  return rack(NodeConfig::Kind::cia402, 3, true);
}

}  // namespace foresight::sim
