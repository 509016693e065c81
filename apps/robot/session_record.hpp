// What a robot did over a session, kept small however long it lasts.
#pragma once

#include <string>
#include <vector>

#include "rig/robot_devices.hpp"

namespace foresight {

/// All of a session's joints over time, in columns of equal width, which doubles when there are too many of them; and
/// every stretch of time in which the robot did one thing. One thread.
class SessionRecord {
 public:
  static constexpr std::size_t kMostColumns = 800;     ///< even
  static constexpr std::size_t kMostStretches = 1000;  ///< what comes later belongs to the last one

  /// A joint in one column. Not a number where it is not known.
  struct JointColumn {
    double position = NAN;   ///< the last; once the joint is homed
    double asked = NAN;      ///< the last; while an operator is followed
    double set_point = NAN;  ///< the last; while the drive follows set-points
    double error = NAN;      ///< position less the set-point that it was to reach then, where that is largest
    double velocity = NAN;   ///< measured, where it is largest
  };
  struct Column {
    double time_s = 0;  ///< of its begin
    double speed = 0;   ///< largest of all joints' measured velocities, as a share of their limits
    std::vector<JointColumn> joints;
    std::vector<double> load;  ///< of each bus, 0 .. 1, the largest
  };
  enum class Doing : std::uint8_t { nothing, ready, homing, following, held, stopping, stopped };
  struct Stretch {
    double from_s = 0, to_s = 0;
    Doing doing = Doing::nothing;
    RobotPhase phase = RobotPhase::disabled;
    GateReason reason = GateReason::none;
    std::string name, cure;  ///< for people
  };

  /// `cycles`: Robot::cycles(); `rig` must outlive this.
  SessionRecord(const Rig& rig, BroadcastRing<RobotCycle>::Reader cycles);
  /// Takes what came since the last call. To be called before the ring comes round.
  void write(const std::vector<BusLine>& buses);

  const std::vector<Column>& columns() const { return columns_; }
  const std::vector<Stretch>& stretches() const { return stretches_; }
  double duration_s() const { return stretches_.empty() ? 0 : stretches_.back().to_s; }
  std::uint64_t dropped() const { return cycles_.dropped(); }  ///< cycles that are missing

 private:
  void add(const RobotCycle& cycle);
  void add_stretch(const RobotCycle& cycle, double time);
  Column& column_at(double time);
  void halve();

  const Rig& rig_;
  std::vector<JointWords> joints_;
  BroadcastRing<RobotCycle>::Reader cycles_;
  RobotTime begin_;
  double width_s_ = 0.02;
  std::vector<Column> columns_;
  std::vector<Stretch> stretches_;
  std::vector<double> last_set_point_;
};

}  // namespace foresight
