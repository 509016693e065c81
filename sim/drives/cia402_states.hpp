// The power state machine of a drive (CiA 402-2, section 8, figure "power drive system finite state automaton").
#pragma once

#include <cstdint>

namespace foresight::sim {

enum class PowerState : std::uint8_t {
  not_ready,
  switch_on_disabled,
  ready_to_switch_on,
  switched_on,
  operation_enabled,
  quick_stop_active,
  fault_reaction_active,
  fault,
};

/// How the shaft is to be stopped.
enum class Braking : std::uint8_t { none, slow_down, quick };

/// Option codes as the objects hold them.
struct StopOptions {
  int quick_stop = 2;  ///< 605Ah: 0 power off; 1 slow down, 2, 3 quick, then power off; 5, 6, 7 the same, and hold
  int shutdown = 0;    ///< 605Bh: 0 power off; 1 slow down first
  int disable = 1;     ///< 605Ch: likewise
  int fault = 2;       ///< 605Eh: 0 power off; 1 slow down, 2, 3 quick, then power off
};

/// Pure logic; no clock, no wire. One thread.
class PowerStates {
 public:
  StopOptions options;

  /// Leaves not_ready (transitions 0 and 1).
  void power_on();
  /// A controlword came: transitions 2 to 12, 16, and at a rising edge of bit 7 transition 15.
  void control(std::uint16_t controlword);
  void fault();  ///< transition 13
  /// Object 6007h: 0 nothing, 1 fault (the caller tells which), 2 disable voltage, 3 quick stop.
  void connection_lost(int option);
  /// To be called at every step: ends brakings when the shaft is at rest (transitions 5, 8, 12, 14).
  void at_rest();

  PowerState state() const { return state_; }
  bool powered() const;  ///< torque is on the shaft
  Braking braking() const { return braking_; }
  /// The state's bits 0 to 6 of the statusword, with bit 4 (voltage) where there is power.
  std::uint16_t status_bits() const;

 private:
  void disable_voltage();
  void quick_stop();
  void leave_enabled(PowerState to, bool slow_down);

  PowerState state_ = PowerState::not_ready;
  PowerState after_braking_ = PowerState::switch_on_disabled;
  Braking braking_ = Braking::none;
  std::uint16_t last_ = 0;
};

}  // namespace foresight::sim
