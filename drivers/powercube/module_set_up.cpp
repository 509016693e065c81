// Set-up of a module: what it is, its limits, its watchdog.
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "drivers/powercube/module.hpp"

namespace foresight::powercube {
namespace {

std::string text(double value) {
  return fmt::format("{:.7g}", value);
}

void need(bool fine, const std::string& who, const char* field, double value, const char* cure) {
  if (!fine) throw InputError(who, std::string(field) + " = " + text(value), cure);
}

}  // namespace

Module::Module(Link& link, DriveConfig config, const Options& options)
    : link_(link), config_(std::move(config)), options_(options) {
  validate();
}

std::string Module::who() const {
  return "module " + std::to_string(config_.node) + " (" + config_.name + ")";
}

void Module::validate() const {
  const DriveConfig& c = config_;
  need(c.node >= 1 && c.node <= kLargestModule, who(), "node", c.node, "give a module id from 1 to 31");
  need(c.direction == 1 || c.direction == -1, who(), "direction", c.direction, "give 1 or -1");
  need(std::isfinite(c.offset), who(), "offset", c.offset, "give a number");
  need(std::isfinite(c.min_position), who(), "min_position", c.min_position, "give a number");
  need(c.max_position > c.min_position && std::isfinite(c.max_position), who(), "max_position", c.max_position,
       "give more than min_position");
  need(c.max_velocity > 0 && std::isfinite(c.max_velocity), who(), "max_velocity", c.max_velocity, "give more than 0");
  need(c.max_acceleration > 0 && std::isfinite(c.max_acceleration), who(), "max_acceleration", c.max_acceleration,
       "give more than 0");
  need(c.homing_velocity > 0 && c.homing_velocity <= c.max_velocity, who(), "homing_velocity", c.homing_velocity,
       "give more than 0 and at most max_velocity");
  need(!c.vendor, who(), "vendor", c.vendor.value_or(0), "leave it out: a PowerCube does not tell its vendor");
}

void Module::identify() {
  const auto ask = [&](Param p) { return link_.get(config_.node, p, who()); };
  info_.id = config_.node;
  info_.serial = static_cast<std::uint32_t>(ask(Param::def_cube_serial));
  info_.version = static_cast<std::uint16_t>(ask(Param::def_cube_version));
  info_.config = static_cast<std::uint32_t>(ask(Param::config));
  info_.linear = (info_.config & kConfigLinear) != 0;
  const auto compare = [&](const char* what, std::uint32_t is, std::optional<std::uint32_t> wanted) {
    if (!wanted || *wanted == is) return;
    throw InputError(who() + " on " + link_.bus().name(),
                     std::string(what) + " is " + std::to_string(is) + ", the rig expects " + std::to_string(*wanted),
                     "connect the right module or correct the rig");
  };
  compare("its serial number", info_.serial, config_.serial);
  compare("its version", info_.version, config_.product);
}

void Module::check_envelope(double low, double high) {
  const auto within = [&](const char* field, double value, Param low_param, Param high_param) {
    const double lowest = link_.get(config_.node, low_param, who());
    const double highest = link_.get(config_.node, high_param, who());
    if (value >= lowest - 1e-6 && value <= highest + 1e-6) return;
    throw InputError(who() + " on " + link_.bus().name(),
                     std::string(field) + " " + text(value) + " is outside of what the module allows, " + text(lowest) +
                         " .. " + text(highest) + " (in its own direction, without offset)",
                     "correct the joint's limits");
  };
  const auto at_most = [&](const char* field, double value, Param param) {
    const double highest = std::abs(link_.get(config_.node, param, who()));
    if (value <= highest * (1 + 1e-6)) return;
    throw InputError(who() + " on " + link_.bus().name(),
                     std::string(field) + " " + text(value) + " is more than the module allows, " + text(highest),
                     "correct the joint's limits");
  };
  within("lower limit", low, Param::def_min_pos, Param::def_max_pos);
  within("upper limit", high, Param::def_min_pos, Param::def_max_pos);
  at_most("max_velocity", config_.max_velocity, Param::def_max_vel);
  at_most("max_acceleration", config_.max_acceleration, Param::def_max_acc);
}

bool Module::equal(Param param, double a, double b) noexcept {
  if (param == Param::config) return a == b;
  return std::abs(a - b) <= 1e-6 * std::max({1.0, std::abs(a), std::abs(b)});
}

void Module::prove(std::size_t slot, Param param, double value) {
  const double is = link_.set(config_.node, param, value, who());
  if (!equal(param, is, value)) {
    throw RuntimeFailure(who() + " on " + link_.bus().name() + ": wrote " +
                             find_param(static_cast<std::uint8_t>(param))->name + " = " + text(value) +
                             ", but it reads back as " + text(is),
                         param == Param::config ? "use a module whose watchdog can be switched on"
                                                : "check that the module's firmware allows this value");
  }
  if (slot < kProven) proven_[slot] = {param, value};
}

void Module::configure() {
  configured_ = false;
  const double a = to_wire(config_.min_position), b = to_wire(config_.max_position);
  const double low = std::min(a, b), high = std::max(a, b);
  check_envelope(low, high);
  const auto bits = static_cast<std::uint32_t>(link_.get(config_.node, Param::config, who()));
  prove(0, Param::config, (bits | kConfigWatchdog) & ~(kConfigNoAnswers | kConfigWaitForSync));
  prove(1, Param::min_pos, low);
  prove(2, Param::max_pos, high);
  prove(3, Param::max_vel, config_.max_velocity);
  prove(4, Param::max_acc, config_.max_acceleration);
  prove(kProven, Param::target_vel, config_.max_velocity);
  prove(kProven, Param::target_acc, config_.max_acceleration);
  // The sign is the direction of homing, which the maker chose by where the switch is.
  const double home = link_.get(config_.node, Param::def_home_vel, who());
  prove(kProven, Param::def_home_vel, std::copysign(config_.homing_velocity, home));
  configured_ = true;
}

}  // namespace foresight::powercube
