#include "drivers/powercube/network.hpp"

#include "common/error.hpp"

namespace foresight::powercube {
namespace {

using namespace std::chrono_literals;

constexpr Duration kScanTime = 200ms;
constexpr Duration kFedWithin = 15ms;      // of 40 ms: a cycle that is late by the rest stops no module
constexpr int kMostFramesPerCycle = 2048;  // a babbling bus must not hold the loop

}  // namespace

std::vector<ModuleInfo> scan(CanBus& bus, Clock& clock) {
  Link link(bus, clock);
  std::array<bool, kLargestModule + 1> found{};
  for (int id = 1; id <= kLargestModule; ++id) link.send(get_param(id, Param::def_cube_serial), "scan");
  const RobotTime until = link.now() + kScanTime;
  while (link.now() < until) {
    const Message m = link.receive(until - link.now());
    if (m.is(Message::Kind::value, Param::def_cube_serial)) found[static_cast<std::size_t>(m.module)] = true;
  }
  std::vector<ModuleInfo> out;
  for (int id = 1; id <= kLargestModule; ++id) {
    if (!found[static_cast<std::size_t>(id)]) continue;
    const std::string who = "module " + std::to_string(id);
    ModuleInfo info{.id = id};
    info.serial = static_cast<std::uint32_t>(link.get(id, Param::def_cube_serial, who));
    info.version = static_cast<std::uint16_t>(link.get(id, Param::def_cube_version, who));
    info.config = static_cast<std::uint32_t>(link.get(id, Param::config, who));
    info.linear = (info.config & kConfigLinear) != 0;
    out.push_back(info);
  }
  return out;
}

Network::Network(CanBus& bus, Clock& clock, const std::vector<DriveConfig>& drives, const Options& options)
    : bus_(bus), link_(bus, clock), options_(options) {
  if (options.cycle < kShortestCycle || options.cycle > kLongestCycle) {
    throw InputError("PowerCube bus " + bus.name(), "cycle = " + std::to_string(to_seconds(options.cycle)) + " s",
                     "give 0.001 to 0.030 s");
  }
  if (options.missing_cycles < 1) {
    throw InputError("PowerCube bus " + bus.name(), "missing_cycles = " + std::to_string(options.missing_cycles),
                     "give 1 or more");
  }
  for (const DriveConfig& config : drives) {
    modules_.push_back(std::make_unique<Module>(link_, config, options));
    Module*& slot = by_id_[static_cast<std::size_t>(config.node)];
    if (slot != nullptr) {
      throw InputError(
          "PowerCube bus " + bus.name(),
          "'" + slot->config().name + "' and '" + config.name + "' both have module id " + std::to_string(config.node),
          "give each joint its own module");
    }
    slot = modules_.back().get();
    drives_.push_back(slot);
  }
}

void Network::receive(RobotTime now) noexcept {
  for (int i = 0; i < kMostFramesPerCycle; ++i) {
    const auto frame = bus_.receive(0ns);
    if (!frame) break;
    const Message message = decode(*frame);
    if (message.from_host()) other_master_ = true;
    if (!message.from_module()) continue;
    Module* module = by_id_[static_cast<std::size_t>(message.module)];
    if (module != nullptr) module->take(message, frame->time.ns != 0 ? frame->time : now);
  }
  for (const auto& module : modules_) module->check(now);
}

void Network::send(RobotTime now) noexcept {
  if (!healthy())
    for (const auto& module : modules_) module->request(DriveRequest::quick_stop);
  // Set-points first: what else there is to send in a cycle must not change when they arrive.
  for (const auto& module : modules_) module->send(now, bus_);
  if (!fed_ || now + options_.cycle - *fed_ > kFedWithin) {
    if (bus_.send(broadcast(Command::watchdog_refresh)) == CanSend::sent) fed_ = now;
  }
  for (const auto& module : modules_) module->ask(bus_);
}

const char* Network::reason() const noexcept {
  if (bus_.state() == CanBusState::bus_off) return "the bus is off: too many errors on the cable";
  if (bus_.state() == CanBusState::down) return "the bus is down";
  if (other_master_) return "another master sends to PowerCube modules on this bus";
  return "";
}

}  // namespace foresight::powercube
