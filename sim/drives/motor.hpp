// The shaft of an emulated drive: a rotating mass with friction, a brake, a servo loop and end stops.
//
// Joint units throughout: rad, rad/s, rad/s^2, N m (or m, m/s, m/s^2, N and kg of a linear axis).
#pragma once

#include <limits>

namespace foresight::sim {

/// What a servo loop is to follow at one instant.
struct Reference {
  double position = 0, velocity = 0, acceleration = 0;
};

struct MotorConfig {
  double start = 0;                                            ///< position when the power comes on
  double min_stop = -std::numeric_limits<double>::infinity();  ///< hard stops: the shaft cannot be beyond
  double max_stop = std::numeric_limits<double>::infinity();
  double max_velocity = 2;             ///< > 0; the servo never asks for more
  double max_acceleration = 10;        ///< > 0; likewise
  double torque_limit = 100;           ///< > 0
  double inertia = 1;                  ///< > 0, of rotor, gear and load at the shaft
  double viscous = 0.2;                ///< >= 0, N m s/rad
  double coulomb = 0.1;                ///< >= 0, N m; holds the shaft at rest against as much
  double load = 0;                     ///< N m, acts always, such as a weight
  double bandwidth = 40;               ///< rad/s of the critically damped servo loop; below 400
  double following_error_limit = 0.1;  ///< > 0
  double brake_torque = 60;            ///< >= 0, N m
  double brake_delay_s = 0.03;         ///< from power off until the brake grips; until then the shaft coasts
  /// The servo limits neither velocity, acceleration nor torque and there are no stops: what a master asks for
  /// is what the shaft does. To prove that limits are kept by the master.
  bool limits_off = false;
};

/// What the shaft truly does, and the largest it ever did.
struct ShaftState {
  double position = 0, velocity = 0, acceleration = 0;
  double torque = 0;  ///< of the motor
  bool powered = false;
  bool brake_closed = true;
  bool hit_stop = false;                                                        ///< ever ran into a hard stop
  double most_positive = 0, most_negative = 0;                                  ///< positions
  double largest_position = 0, largest_velocity = 0, largest_acceleration = 0;  ///< absolute values
};

/// A function of its configuration and the steps made: no clock, no randomness. One thread.
class Motor {
 public:
  explicit Motor(const MotorConfig& config);
  /// Power on opens the brake at once; the servo follows track(), first of all the place where it stands.
  void power(bool on);
  void track(const Reference& reference);
  void apply_torque(double torque);  ///< instead of following, until the next track() or power()
  void jam(bool jammed);             ///< something outside holds the shaft fast
  /// Moves time on by `dt` seconds, at most 1 ms.
  void step(double dt);

  const ShaftState& shaft() const { return shaft_; }
  double following_error() const;  ///< reference less position; 0 where nothing is followed
  bool following_failed() const;   ///< |following error| is beyond its limit
  bool torque_limited() const { return torque_limited_; }
  /// Sets the extremes back to what is now.
  void forget_extremes();

 private:
  double servo_torque(double dt);
  void record(double acceleration);

  MotorConfig config_;
  ShaftState shaft_;
  Reference reference_;
  bool follows_ = false, torque_limited_ = false, jammed_ = false;
  double wanted_torque_ = 0, since_off_s_ = 0;
};

}  // namespace foresight::sim
