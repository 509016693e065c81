// One PowerCube module as a drive.
#pragma once

#include "drivers/drive/drive.hpp"
#include "drivers/powercube/link.hpp"

namespace foresight::powercube {

/// Bits of the parameter Config. ASSUMPTIONS: the protocol facts name none; these are the ones that public users of
/// these modules set and test. A module with other meanings fails configure() or has no working watchdog: check on a
/// new module, unloaded, that it halts when the master is killed.
inline constexpr std::uint32_t kConfigWatchdog = 0x01000000;     ///< halts when refreshes stop, once it has seen one
inline constexpr std::uint32_t kConfigLinear = 0x00020000;       ///< metres instead of radians
inline constexpr std::uint32_t kConfigNoAnswers = 0x04000000;    ///< motions are not answered
inline constexpr std::uint32_t kConfigWaitForSync = 0x08000000;  ///< motions wait for a broadcast

/// What a module says of itself.
struct ModuleInfo {
  int id = 0;
  std::uint32_t serial = 0;
  std::uint16_t version = 0;  ///< DefCubeVersion, e.g. 0x2512
  std::uint32_t config = 0;
  bool linear = false;
};

enum class SetPoints : std::uint8_t {
  step,  ///< FSTEP_ACK each cycle: at the set-point one cycle later; for streams
  ramp,  ///< FRAMP_ACK where the set-point changed: the module's own ramp; for single far targets
};

/// Of the loop: the watchdog must be fed each 40 ms.
inline constexpr Duration kShortestCycle = std::chrono::milliseconds(1), kLongestCycle = std::chrono::milliseconds(30);

struct Options {
  Duration cycle = std::chrono::milliseconds(10);  ///< kShortestCycle .. kLongestCycle
  /// Cycles in which a module was asked and said nothing, then it is offline; > 0. A loop that is late itself asks
  /// nothing meanwhile, and has nothing to miss.
  int missing_cycles = 5;
  SetPoints set_points = SetPoints::step;
};

/// Created by Network, which feeds it with messages; thread rule and set-up as said for Drive. How it does what
/// Drive says:
///
/// * `disabled` is the module's halt: brake closed. disable and quick_stop both send Halt, repeated until the module
///   says that it is halted: it decelerates and the brake, not the motor, holds it. Anything that moves without our
///   asking (a module that was just switched on) is halted too.
/// * enable compares Config and limits with what configure() wrote (a module that lost its power forgot them), sends
///   Reset, waits until neither halt nor error is left, and takes the actual position as the first set-point. Nothing
///   from before survives it. A module in `fault` is not enabled; reset_fault clears it and halts.
/// * Not homed, it is enabled but follows no set-point: only home moves it. Homing ends enabled, holding where it is.
/// * Set-points are kept within the joint's limits, and steps within max_velocity. Their velocity is not used.
/// * configure() may be repeated between two cycles of the loop, for a module that lost its power.
/// * DriveFeedback::fault_code is the state word CubeState; `fault` also says what we ourselves miss.
class Module final : public Drive {
 public:
  /// Throws InputError (a config that makes no sense, naming the field).
  Module(Link& link, DriveConfig config, const Options& options);

  const DriveConfig& config() const noexcept override { return config_; }
  /// Serial number, version (as DriveConfig::product) and kind; DriveConfig::vendor must be absent. Blocks.
  void identify() override;
  DriveIdentity identity() const override { return {{}, info_.version, info_.serial}; }
  void configure() override;
  void request(DriveRequest what) noexcept override;
  void set_point(double position, double velocity) noexcept override;
  DriveFeedback feedback() const noexcept override;

  const ModuleInfo& info() const { return info_; }  ///< after identify()
  std::string who() const;                          ///< "module 3 (elbow)"

  // For Network only. All noexcept, without allocation.
  void take(const Message& message, RobotTime time) noexcept;
  void check(RobotTime now) noexcept;  ///< marks what fell silent
  void send(RobotTime now, CanBus& bus) noexcept;
  /// After all modules have sent: what the loop wants to know of this one.
  void ask(CanBus& bus) noexcept;

 private:
  /// What configure() proved, and enable proves again. Wire units.
  struct Proven {
    Param param;
    double value;
  };
  static constexpr std::size_t kProven = 5;

  void validate() const;
  void check_envelope(double low, double high);
  void prove(std::size_t slot, Param param, double value);
  double to_wire(double joint) const { return (joint - config_.offset) * config_.direction; }
  double to_joint(double wire) const { return config_.offset + config_.direction * wire; }

  static bool equal(Param param, double a, double b) noexcept;  ///< as binary32; Config to the bit

  void take_state(std::uint32_t word) noexcept;
  void take_proof(const Message& message) noexcept;
  void take_position(double wire, RobotTime time) noexcept;
  void enter(DriveState state) noexcept;
  void fail(const char* why) noexcept;  ///< our own fault: halts
  void obey() noexcept;
  void send_enabling(CanBus& bus) noexcept;
  void send_enabled(CanBus& bus) noexcept;
  void watch_homing() noexcept;
  void send_orders(CanBus& bus) noexcept;
  bool send_ramp(double wire, CanBus& bus) noexcept;
  bool word_is(std::uint32_t bits) const noexcept { return (word_ & bits) != 0; }

  Link& link_;
  const DriveConfig config_;
  const Options options_;
  ModuleInfo info_;
  std::array<Proven, kProven> proven_{};
  bool configured_ = false;

  // What the module told.
  int silent_ = 0, without_position_ = 0;  // cycles sent since it said anything, and where it is
  std::uint32_t word_ = 0;                 // CubeState
  RobotTime position_time_;
  double position_ = 0;             // wire units
  std::optional<double> velocity_;  // wire units

  // What we do with it.
  DriveState state_ = DriveState::offline;
  RobotTime now_, entered_;  // of this cycle; when state_ began
  std::uint32_t cycles_ = 0;
  const char* own_fault_ = "";
  DriveRequest request_ = DriveRequest::none;
  bool want_halt_ = false, want_reset_ = false, want_home_ = false;

  // Cleared by every change of state.
  std::uint32_t proofs_ = 0;  // bit per slot of proven_, while enabling
  bool reset_sent_ = false, word_fresh_ = false, position_fresh_ = false;
  bool homing_seen_ = false, homing_done_ = false;
  bool ramp_answered_ = true;
  RobotTime action_time_;         // of the last Reset or FRAMP
  std::optional<double> target_;  // joint units
  double last_sent_ = 0;          // wire units; where it stood when it was enabled, then the last set-point
};

}  // namespace foresight::powercube
