#include "sim/drives/drive_node.hpp"

#include <cmath>
#include <sstream>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight::sim {

const char* to_string(DriveFault fault) {
  switch (fault) {
    case DriveFault::recover: return "recover";
    case DriveFault::overcurrent: return "overcurrent";
    case DriveFault::tow_error: return "tow-error";
    case DriveFault::emergency: return "emergency";
    case DriveFault::reset: return "reset";
    case DriveFault::silent: return "silent";
    case DriveFault::frozen: return "frozen";
    case DriveFault::garbage: return "garbage";
    case DriveFault::wrong_identity: return "wrong-identity";
    case DriveFault::slow: return "slow";
    case DriveFault::jam: return "jam";
    case DriveFault::noisy: return "noisy";
    case DriveFault::unplugged: return "unplugged";
    case DriveFault::no_power: return "no-power";
  }
  return "?";
}

double DriveNode::arbitrary() {
  arbitrary_ = arbitrary_ * 1664525u + 1013904223u;  // Numerical Recipes, section 7.1
  return static_cast<std::int32_t>(arbitrary_) / 2147483648.0;
}

void NodeConfig::validate() const {
  const auto require = [&](bool good, const char* field, double value, const char* cure) {
    std::ostringstream text;
    text << field << " is " << value;
    if (!good) throw InputError("drive " + in_quotes(name), text.str(), cure);
  };
  require(!name.empty(), "the length of name", 0, "give each drive a name");
  const int largest = kind == Kind::cia402 ? 127 : 31;
  require(node >= 1 && node <= largest, "node", node, kind == Kind::cia402 ? "use 1 to 127" : "use 1 to 31");
  require(std::isfinite(counts_per_unit) && counts_per_unit > 0, "counts_per_unit", counts_per_unit,
          "make it positive");
  require(std::isfinite(index_distance) && index_distance > 0, "index_distance", index_distance, "make it positive");
  require(watchdog_s > 0, "watchdog_s", watchdog_s, "make it positive");
  require(missed_set_points >= 0, "missed_set_points", missed_set_points, "use 0 or more");
  require(motor.max_velocity > 0, "max_velocity", motor.max_velocity, "make it positive");
  require(motor.max_acceleration > 0, "max_acceleration", motor.max_acceleration, "make it positive");
  require(motor.torque_limit > 0, "torque_limit", motor.torque_limit, "make it positive");
  require(motor.inertia > 0, "inertia", motor.inertia, "make it positive");
  require(motor.viscous >= 0 && motor.coulomb >= 0, "friction", motor.viscous, "make it 0 or more");
  require(motor.bandwidth > 0 && motor.bandwidth < 400, "bandwidth", motor.bandwidth, "use 1 to 400 rad/s");
  require(motor.following_error_limit > 0, "following_error_limit", motor.following_error_limit, "make it positive");
  require(std::isfinite(motor.start) && motor.start >= motor.min_stop && motor.start <= motor.max_stop, "start",
          motor.start, "put it between the stops");
}

}  // namespace foresight::sim
