// The buses and drives of a rig, real or mock.
#pragma once

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "common/clock.hpp"
#include "drivers/can/in_process_bus.hpp"
#include "rig/rig.hpp"
#include "sim/drives/drive_rack.hpp"

namespace foresight {

/// The drives that a bus of a rig needs, emulated, as their own shafts see them. PowerCube modules start a little off
/// home.
std::vector<sim::NodeConfig> emulated_drives(const Rig& rig, std::size_t bus);

/// A bus as a view shows it.
struct BusLine {
  std::string name;
  CanBusState state = CanBusState::active;
  CanCounters counters;
  double load = 0;  ///< share of its bit rate in use, 0 .. 1
};

struct RobotDeviceOptions {
  bool mock = false;                         ///< every bus with emulated drives, whatever the rig says
  std::optional<std::filesystem::path> log;  ///< candump log of all frames
  bool mock_without_limits = false;          ///< emulated drives do whatever they are told: to prove the gate
  /// Where shafts of mock drives stand at first, by joint, in its unit and direction; else a little beside home.
  std::map<std::string, double> mock_start = {};
};

/// Where the frames of a bus go: `file` where the rig has one bus, else its name with the bus's before its extension.
std::filesystem::path log_of(std::filesystem::path file, const Rig& rig, const RigBus& bus);

/// Opens the rig's buses: SocketCAN interfaces, or in-process ones with emulated drives where the rig says `mock`.
/// Outlived by the clock. Construction and bring_up() throw InputError or RuntimeFailure; nothing moves.
class RobotDevices {
 public:
  RobotDevices(const Rig& rig, Clock& clock, const RobotDeviceOptions& options);
  ~RobotDevices();

  /// Identifies and configures every drive, in the rig's order; `say` gets a line for each step. From then on the
  /// drives expect to hear from us, every 100 ms at least: the loop must follow at once.
  void bring_up(const std::function<void(const std::string&)>& say);

  std::vector<DriveNetwork*> networks() const;
  std::vector<Drive*> drives() const;  ///< in the rig's order
  /// Thread-safe while the loop runs.
  std::vector<BusLine> buses() const;
  /// Why the log of a bus is not complete (a full disk); "" where all are. Once the loop has ended.
  std::string log_fault() const;
  /// The files that the frames go to, one for each bus; none without RobotDeviceOptions::log.
  const std::vector<std::filesystem::path>& logs() const { return logs_; }

  /// Where the shaft of a joint on a mock bus truly was at an instant of the last seconds, in the joint's own unit and
  /// direction; nothing for joints of real buses or that the rig does not have. Any thread; in real time it waits, 50
  /// ms at most, until the emulated drives have come that far.
  std::optional<double> shaft_at(std::string_view joint, RobotTime time) const;

  /// What is behind a mock bus, for tests: where the shafts are, faults, other ends; null behind a real one.
  sim::DriveRack* rack(std::size_t bus) const;
  InProcessBus* medium(std::size_t bus) const;
  CanBus& master_end(std::size_t bus) const;  ///< the end of the medium that we use

 private:
  struct Bus;
  void serve_others(std::size_t than) noexcept;
  static void open_log(Bus& bus, Clock& clock, bool stepped, const std::filesystem::path& file);

  const Rig& rig_;
  Clock& clock_;
  std::vector<std::unique_ptr<Bus>> buses_;
  std::vector<Drive*> drives_;
  std::vector<std::filesystem::path> logs_;
};

}  // namespace foresight
