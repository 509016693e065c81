#include "drivers/canopen/canopen_config.hpp"

#include <cmath>

#include "common/error.hpp"
#include "drivers/canopen/wire.hpp"

namespace foresight::canopen {
namespace {

using namespace std::chrono_literals;

void need(bool ok, const std::string& where, const char* field, const std::string& value, const char* cure) {
  if (!ok) throw InputError(where, std::string(field) + " is " + value, cure);
}

std::string ms(Duration d) {
  return std::to_string(static_cast<double>(d.count()) * 1e-6) + " ms";
}

}  // namespace

void validate(const NetworkConfig& c) {
  const std::string where = "CANopen network";
  need(c.master_node >= 1 && c.master_node <= kLargestNode, where, "master_node", std::to_string(c.master_node),
       "give 1 to 127");
  need(c.cycle >= kShortestCycle && c.cycle <= 255ms, where, "cycle", ms(c.cycle), "give 0.1 to 255 ms");
  need(c.watchdog >= 3ms && c.watchdog <= 65s, where, "watchdog", ms(c.watchdog), "give 3 ms to 65 s");
  need(c.heartbeat >= 1ms && c.heartbeat * 3 <= c.watchdog, where, "heartbeat", ms(c.heartbeat),
       "give 1 ms to a third of watchdog");
  need(c.drive_heartbeat >= 1ms && c.drive_heartbeat <= 65s, where, "drive_heartbeat", ms(c.drive_heartbeat),
       "give 1 ms to 65 s");
  need(c.drive_timeout > c.drive_heartbeat * 2, where, "drive_timeout", ms(c.drive_timeout),
       "give more than twice drive_heartbeat");
  need(c.feedback_timeout >= c.cycle * kCyclesOfFeedback, where, "feedback_timeout", ms(c.feedback_timeout),
       "give at least three cycles");
  need(c.sdo_timeout >= 1ms && c.sdo_timeout <= 500ms, where, "sdo_timeout", ms(c.sdo_timeout), "give 1 to 500 ms");
}

void validate(const Cia402Config& c) {
  const DriveConfig& d = c.drive;
  const std::string where = "drive '" + d.name + "'";
  const auto number = [](double v) { return std::to_string(v); };
  const auto positive = [](double v) { return std::isfinite(v) && v > 0; };
  const auto counts_fit = [&](double v) { return std::abs(v) * d.counts_per_unit < 2147483647.0; };
  need(d.node >= 1 && d.node <= kLargestNode, where, "node", std::to_string(d.node), "give 1 to 127");
  need(positive(d.counts_per_unit), where, "counts_per_unit", number(d.counts_per_unit), "give a number above 0");
  need(d.direction == 1 || d.direction == -1, where, "direction", std::to_string(d.direction), "give 1 or -1");
  need(std::isfinite(d.offset), where, "offset", number(d.offset), "give a finite number");
  need(counts_fit(d.min_position - d.offset), where, "min_position", number(d.min_position),
       "give a position within 32 bits of increments");
  need(counts_fit(d.max_position - d.offset), where, "max_position", number(d.max_position),
       "give a position within 32 bits of increments");
  need(d.min_position <= d.max_position, where, "min_position", number(d.min_position), "give at most max_position");
  need(positive(d.max_velocity) && counts_fit(d.max_velocity), where, "max_velocity", number(d.max_velocity),
       "give a number above 0");
  need(positive(d.max_acceleration) && counts_fit(d.max_acceleration), where, "max_acceleration",
       number(d.max_acceleration), "give a number above 0");
  need(positive(d.homing_velocity) && d.homing_velocity <= d.max_velocity, where, "homing_velocity",
       number(d.homing_velocity), "give a number above 0, at most max_velocity");
  need(c.mode == OperationMode::profile_position || c.mode == OperationMode::cyclic_position ||
           c.mode == OperationMode::cyclic_velocity,
       where, "mode", std::to_string(static_cast<int>(c.mode)), "give 1, 8 or 9");
  need(c.homing_method >= -128 && c.homing_method <= 127, where, "homing_method", std::to_string(c.homing_method),
       "give -128 to 127");
  need(c.homing_acceleration >= 0 && counts_fit(c.homing_acceleration), where, "homing_acceleration",
       number(c.homing_acceleration), "give 0 or more");
  need(c.quick_stop_deceleration >= 0 && counts_fit(c.quick_stop_deceleration), where, "quick_stop_deceleration",
       number(c.quick_stop_deceleration), "give 0 or more");
  need(positive(c.velocity_factor), where, "velocity_factor", number(c.velocity_factor), "give a number above 0");
  // 0 would let the motor run out freely, and with 1 to 4 it loses its torque after the stop.
  need(c.quick_stop_option >= 5 && c.quick_stop_option <= 8, where, "quick_stop_option",
       std::to_string(c.quick_stop_option), "give 5 to 8");
}

}  // namespace foresight::canopen
