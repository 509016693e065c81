// What an emulated CiA 402 drive does with its targets in each mode of operation (CiA 402-2, sections 10 to 15).
//
// All values in joint units of the shaft; the node converts. Pure logic, one thread.
#pragma once

#include <optional>

#include "sim/drives/cia402_states.hpp"
#include "sim/drives/homing_search.hpp"
#include "sim/drives/reference.hpp"

namespace foresight::sim {

/// Values of 6060h that are served here.
enum class Mode : std::int8_t {
  none = 0,
  profile_position = 1,
  homing = 6,
  interpolated = 7,
  cyclic_position = 8,
  cyclic_velocity = 9
};

struct MotionSettings {
  ProfileLimits profile;                      ///< 6081h, 6083h, 6084h
  double quick_deceleration = 1;              ///< 6085h
  double min_position = 0, max_position = 0;  ///< 607Dh; none where min >= max
  double interval_s = 0.01;                   ///< 60C2h
  int missed_set_points = 3;
  bool hold_when_missed = false;
  int homing_method = 37;                                                 ///< 6098h: one of served_homing_methods()
  double homing_fast = 0.1, homing_slow = 0.02, homing_acceleration = 1;  ///< 6099h, 609Ah
  double index_distance = 1, index_at = 0;                                ///< of the encoder's index pulses
};

class Cia402Motion {
 public:
  MotionSettings settings;

  /// Rest at `position`, no targets. To be called when power comes on.
  void hold(double position);
  /// Goes on from where the shaft really is, such as after a following error.
  void follow_shaft(const ShaftState& shaft) { reference_ = {shaft.position, shaft.velocity, 0}; }
  /// Takes effect when the reference is at rest, to where it is slowed down first.
  void want_mode(Mode mode) { wanted_ = mode; }
  Mode mode() const { return mode_; }

  // Profile position. Refused (false) while one target waits already.
  bool new_target(double position, bool at_once);
  bool target_waits() const { return next_.has_value(); }
  // Interpolated and cyclic synchronous position; cyclic synchronous velocity.
  void set_point(double value, bool cyclic);
  void synchronised();
  // Homing.
  bool start_homing();  ///< false: the method is not served
  void cancel_homing() { search_.reset(); }
  /// The shaft position of the home found, once.
  std::optional<double> take_home();
  bool homing_active() const { return search_.has_value(); }
  /// The search ended at a limit switch without having found home; once.
  bool take_homing_failure();

  /// `switches`: the inputs of homing_search.hpp, at `shaft`. A braking that is a halt keeps
  /// target and homing for later; any other drops them.
  Reference step(double dt, Braking braking, bool halted, double shaft, unsigned switches);
  const Reference& reference() const { return reference_; }
  bool at_rest() const { return reference_.velocity == 0; }
  bool target_reached() const;
  bool limited() const { return limited_; }  ///< 607Dh cuts the target
  /// More set-points in a row were missed than are allowed; once.
  bool take_missed();

 private:
  double limited_position(double position);
  void begin_interval();
  void step_mode(double dt, double shaft, unsigned switches);
  void step_cyclic(double dt);
  void step_homing(double dt, double shaft, unsigned switches);
  void step_velocity(double dt);

  Mode mode_ = Mode::none, wanted_ = Mode::none;
  Reference reference_;
  bool limited_ = false;
  std::optional<double> target_, next_;
  CyclicInterpolator cyclic_;
  double set_point_ = 0, since_sync_s_ = 1e9;
  bool fresh_ = false, monitored_ = false, holding_ = false, missed_event_ = false;
  int missed_ = 0;
  std::optional<HomingSearch> search_;
  std::optional<double> home_;
  bool homing_failed_ = false;
};

}  // namespace foresight::sim
