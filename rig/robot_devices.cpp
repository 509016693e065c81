#include "rig/robot_devices.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <thread>

#include "common/error.hpp"
#include "common/real_time.hpp"
#include "common/text.hpp"
#include "drivers/can/candump_log.hpp"
#include "drivers/can/metered_bus.hpp"
#include "drivers/can/recording_bus.hpp"
#include "drivers/can/socket_can_bus.hpp"
#include "drivers/canopen/canopen_network.hpp"
#include "drivers/powercube/network.hpp"
#include "rig/bus_plan.hpp"
#include "rig/home.hpp"
#include "sim/drives/homing_search.hpp"

namespace foresight {
namespace {

constexpr Duration kRackStep = std::chrono::milliseconds(1), kRackPatience = std::chrono::milliseconds(50);

/// Writes at once, in the caller's thread: for stepped time, in which nothing may be left out and waiting costs
/// nothing.
class LoggedBus final : public CanBus {
 public:
  LoggedBus(CanBus& bus, const Clock& clock, const std::filesystem::path& file)
      : bus_(bus), clock_(clock), writer_(file) {}
  const std::string& name() const noexcept override { return bus_.name(); }
  CanSend send(const CanFrame& frame) noexcept override {
    const CanSend result = bus_.send(frame);
    if (result == CanSend::sent) write(clock_.now(), frame, true);
    return result;
  }
  std::optional<CanFrame> receive(Duration timeout) noexcept override {
    const auto frame = bus_.receive(timeout);
    if (frame) write(frame->time, *frame, false);
    return frame;
  }
  CanBusState state() const noexcept override { return bus_.state(); }
  CanCounters counters() const noexcept override { return bus_.counters(); }

  /// Why the log is not complete; "" where it is.
  std::string fault() {
    attempt([&] { writer_.flush(); });
    return fault_;
  }

 private:
  void write(RobotTime time, const CanFrame& frame, bool sent) noexcept {
    attempt([&] { writer_.write(Duration{time.ns}, name(), frame, sent); });
  }
  template <typename Work>
  void attempt(const Work& work) noexcept {
    if (!fault_.empty()) return;
    try {
      work();
    } catch (const std::exception& error) {
      fault_ = error.what();
      std::fprintf(stderr, "robot: the log ends here: %s\n", error.what());
    }
  }

  CanBus& bus_;
  const Clock& clock_;
  CandumpWriter writer_;
  std::string fault_;
};

/// While one network is set up and waits for its answers here, the others go on: their drives' watchdogs would find
/// them silent.
class PatientBus final : public CanBus {
 public:
  PatientBus(CanBus& bus, Clock& clock, std::function<void()> meanwhile)
      : bus_(bus), clock_(clock), meanwhile_(std::move(meanwhile)) {}
  const std::string& name() const noexcept override { return bus_.name(); }
  CanSend send(const CanFrame& frame) noexcept override { return bus_.send(frame); }
  std::optional<CanFrame> receive(Duration timeout) noexcept override {
    if (timeout.count() <= 0) return bus_.receive(timeout);
    const RobotTime until = clock_.now() + timeout;
    for (RobotTime now = clock_.now();; now = clock_.now()) {
      meanwhile_();
      if (auto frame = bus_.receive(std::clamp(until - now, Duration{0}, kSlice))) return frame;
      if (clock_.now() >= until) return std::nullopt;
    }
  }
  CanBusState state() const noexcept override { return bus_.state(); }
  CanCounters counters() const noexcept override { return bus_.counters(); }

 private:
  static constexpr Duration kSlice = std::chrono::milliseconds(2);
  CanBus& bus_;
  Clock& clock_;
  std::function<void()> meanwhile_;
};

/// Where a mock shaft stands at the start: not quite at home, on the side from which it can be looked for.
double start_beside(double home, int homing_method, const sim::NodeConfig& config) {
  const auto method = sim::homing_method(homing_method);
  const bool towards_center = !method || (method->input == sim::kHomeSwitch);
  const double center = 0.5 * (config.min_position + config.max_position);
  const double way = !towards_center  ? (method->edge == sim::HomingMethod::Edge::none ? -method->way : method->way)
                     : home <= center ? 1
                                      : -1;
  return home + 0.02 * way * (config.max_position - config.min_position);
}

/// The drive that a joint of the rig needs, as its own shaft sees it.
sim::NodeConfig emulated(const RigJoint& joint, DriveProtocol protocol) {
  const DriveConfig& d = joint.drive;
  const auto at_drive = [&](double position) { return d.direction * (position - d.offset); };
  const double room = d.max_position - d.min_position;
  const bool powercube = protocol == DriveProtocol::powercube;
  sim::NodeConfig out;
  out.kind = powercube ? sim::NodeConfig::Kind::powercube : sim::NodeConfig::Kind::cia402;
  out.node = d.node;
  out.name = d.name;
  if (!powercube) out.counts_per_unit = d.counts_per_unit;
  out.homed = joint.absolute;
  std::tie(out.min_position, out.max_position) = std::minmax({at_drive(d.min_position), at_drive(d.max_position)});
  const double home = home_of(joint, protocol);
  out.home_position = at_drive(home);
  out.motor.start = at_drive(powercube && !joint.absolute ? std::min(home + 0.02 * room, d.max_position) : home);
  // A CiA 402 drive says 0 at the home that it has found: there its switches must be.
  if (!powercube && !joint.absolute) {
    if (!(out.min_position <= 0 && 0 <= out.max_position))
      throw InputError("joint " + in_quotes(d.name),
                       "its offset lies beyond min and max, and emulated drives have home there",
                       "give a rig for mock drives an offset within, or `encoder: absolute`");
    sim::place_homing_switches(out, joint.homing_method, 0);
    out.motor.start = start_beside(0, joint.homing_method, out);
  }
  out.motor.min_stop = out.min_position - 0.05 * room;
  out.motor.max_stop = out.max_position + 0.05 * room;
  out.motor.max_velocity = 1.5 * d.max_velocity;
  out.motor.max_acceleration = 4 * d.max_acceleration;
  out.motor.following_error_limit = 2 * joint.following_error;
  if (d.vendor) out.vendor = *d.vendor;
  if (d.product) out.product = *d.product;
  if (d.serial) out.serial = *d.serial;
  return out;
}

std::unique_ptr<DriveNetwork> make_network(CanBus& bus, Clock& clock, const Rig& rig, std::size_t number) {
  const Duration cycle = seconds(1 / rig.rate_hz);
  if (rig.buses[number].protocol == DriveProtocol::powercube) {
    std::vector<DriveConfig> drives;
    for (const RigJoint& joint : rig.joints)
      if (joint.bus == number) drives.push_back(joint.drive);
    powercube::Options options;
    options.cycle = cycle;
    // No less than the gate itself waits for a position, and so that it is told what is wrong by then.
    const int within_age = static_cast<int>(rig.feedback_age_s * rig.rate_hz) - 1;
    options.missing_cycles = std::max(options.missing_cycles, within_age);
    return std::make_unique<powercube::Network>(bus, clock, drives, options);
  }
  std::vector<canopen::Cia402Config> drives;
  for (const RigJoint& joint : rig.joints)
    if (joint.bus == number) {
      canopen::Cia402Config config;
      config.drive = joint.drive;
      config.homing_method = joint.homing_method;
      config.absolute_encoder = joint.absolute;
      drives.push_back(config);
    }
  canopen::NetworkConfig config;
  config.cycle = cycle;
  return std::make_unique<canopen::CanopenNetwork>(bus, clock, config, drives);
}

}  // namespace

std::filesystem::path log_of(std::filesystem::path file, const Rig& rig, const RigBus& bus) {
  if (rig.buses.size() == 1) return file;
  const std::string extension = file.extension().string();
  return file.replace_extension().concat("-" + bus.name + extension);
}

std::vector<sim::NodeConfig> emulated_drives(const Rig& rig, std::size_t bus) {
  std::vector<sim::NodeConfig> out;
  for (const RigJoint& joint : rig.joints)
    if (joint.bus == bus) out.push_back(emulated(joint, rig.buses[bus].protocol));
  return out;
}

namespace {

void start_at(const std::map<std::string, double>& positions, const Rig& rig, std::vector<sim::NodeConfig>& nodes) {
  for (sim::NodeConfig& node : nodes) {
    const auto given = positions.find(node.name);
    if (given == positions.end()) continue;
    const DriveConfig& d =
        std::ranges::find_if(rig.joints, [&](const RigJoint& j) { return j.drive.name == node.name; })->drive;
    node.motor.start = d.direction * (given->second - d.offset);
  }
}

}  // namespace

struct RobotDevices::Bus {
  std::unique_ptr<InProcessBus> medium;  // of a mock bus
  std::unique_ptr<sim::DriveRack> rack;
  std::unique_ptr<CanBus> end;
  std::unique_ptr<CanBus> logged;
  std::function<std::string()> log_fault;
  std::unique_ptr<MeteredBus> metered;
  std::unique_ptr<CanBus> patient;
  RobotTime served;
  std::unique_ptr<DriveNetwork> network;
  std::jthread rack_thread;  // the last: joined before all else goes
};

RobotDevices::RobotDevices(const Rig& rig, Clock& clock, const RobotDeviceOptions& options) : rig_(rig), clock_(clock) {
  require_room_on_buses(rig);
  const bool stepped = dynamic_cast<SteppedClock*>(&clock) != nullptr;
  for (std::size_t i = 0; i < rig.buses.size(); ++i) {
    const RigBus& config = rig.buses[i];
    auto bus = std::make_unique<Bus>();
    const CanBitRates rates{config.bit_rate, 0};
    if (options.mock || config.interface == "mock") {
      bus->medium =
          std::make_unique<InProcessBus>(config.name, clock, InProcessBusOptions{.wire = rates, .faults = {}});
      auto nodes = emulated_drives(rig, i);
      for (sim::NodeConfig& node : nodes) node.motor.limits_off = options.mock_without_limits;
      start_at(options.mock_start, rig, nodes);
      bus->rack = std::make_unique<sim::DriveRack>(clock, bus->medium->attach(), nodes);
      bus->end = bus->medium->attach();
    } else {
      bus->end = std::make_unique<SocketCanBus>(config.interface);
    }
    if (options.log) {
      logs_.push_back(log_of(*options.log, rig, config));
      open_log(*bus, clock, stepped, logs_.back());
    }
    bus->metered = std::make_unique<MeteredBus>(bus->logged ? *bus->logged : *bus->end, clock, rates);
    bus->patient = std::make_unique<PatientBus>(*bus->metered, clock, [this, i] { serve_others(i); });
    bus->network = make_network(*bus->patient, clock, rig, i);
    if (bus->rack && !stepped)
      bus->rack_thread = std::jthread([rack = bus->rack.get()](std::stop_token stop) {
        make_real_time(priority::kMockDrives);  // where allowed
        rack->run(std::move(stop));
      });
    buses_.push_back(std::move(bus));
  }
  std::vector<std::size_t> next(rig.buses.size());
  for (const RigJoint& joint : rig.joints) drives_.push_back(buses_[joint.bus]->network->drives()[next[joint.bus]++]);
}

RobotDevices::~RobotDevices() = default;

void RobotDevices::open_log(Bus& bus, Clock& clock, bool stepped, const std::filesystem::path& file) {
  if (stepped) {
    auto logged = std::make_unique<LoggedBus>(*bus.end, clock, file);
    bus.log_fault = [log = logged.get()] { return log->fault(); };
    bus.logged = std::move(logged);
  } else {
    auto logged = std::make_unique<RecordingBus>(*bus.end, clock, file);
    bus.log_fault = [log = logged.get(), file] {
      return log->failed() ? file.string() + ": the log ends early (" + std::to_string(log->dropped()) +
                                 " frames are missing); make room on the disk"
                           : std::string();
    };
    bus.logged = std::move(logged);
  }
}

std::string RobotDevices::log_fault() const {
  for (const auto& bus : buses_)
    if (std::string fault = bus->log_fault ? bus->log_fault() : ""; !fault.empty()) return fault;
  return {};
}

void RobotDevices::serve_others(std::size_t than) noexcept {
  const RobotTime now = clock_.now();
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    Bus& bus = *buses_[i];
    if (i == than || now - bus.served < seconds(1 / rig_.rate_hz)) continue;
    bus.served = now;
    bus.network->receive(now);
    bus.network->send(now);
  }
}

void RobotDevices::bring_up(const std::function<void(const std::string&)>& say) {
  for (Drive* drive : drives_) drive->identify();
  say(std::to_string(drives_.size()) + " drives answer as the rig says");
  for (Drive* drive : drives_) {
    drive->configure();
    for (const std::string& remark : drive->remarks()) say("drive " + drive->config().name + ": " + remark);
  }
  say("limits, process data and watchdogs are written and read back");
}

std::vector<DriveNetwork*> RobotDevices::networks() const {
  std::vector<DriveNetwork*> out;
  for (const auto& bus : buses_) out.push_back(bus->network.get());
  return out;
}

std::vector<Drive*> RobotDevices::drives() const {
  return drives_;
}

std::optional<double> RobotDevices::shaft_at(std::string_view joint, RobotTime time) const {
  const auto found =
      std::ranges::find_if(rig_.joints, [&](const RigJoint& candidate) { return candidate.drive.name == joint; });
  if (found == rig_.joints.end()) return std::nullopt;
  const Bus& bus = *buses_[found->bus];
  const auto place = bus.rack ? bus.rack->find(joint) : std::nullopt;
  if (!place) return std::nullopt;
  const bool real_time = bus.rack_thread.joinable();
  for (const RobotTime limit = clock_.now() + kRackPatience;
       real_time && bus.rack->known_until() < time && clock_.now() < limit;)
    clock_.sleep_until(clock_.now() + kRackStep);
  return found->drive.offset + found->drive.direction * bus.rack->position_at(*place, time);
}

sim::DriveRack* RobotDevices::rack(std::size_t bus) const {
  return buses_[bus]->rack.get();
}
InProcessBus* RobotDevices::medium(std::size_t bus) const {
  return buses_[bus]->medium.get();
}
CanBus& RobotDevices::master_end(std::size_t bus) const {
  return *buses_[bus]->end;
}

std::vector<BusLine> RobotDevices::buses() const {
  std::vector<BusLine> out;
  for (std::size_t i = 0; i < buses_.size(); ++i) {
    const MeteredBus::Snapshot now = buses_[i]->metered->snapshot();
    out.push_back({rig_.buses[i].name, now.state, now.counters, now.load});
  }
  return out;
}

}  // namespace foresight
