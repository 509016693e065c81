#include "rig/joint_limits.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/urdf_limits.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

constexpr double kRounding = 1e-6;
constexpr double kWritten = 1e-5;  // as when somebody writes 2.0944 for 2.09439510
// Where the URDF says nothing, by unit: more than two turns, or than any arm's reach, are another unit.
struct Plausible {
  const char* unit;
  double position, velocity, following_error;
  const char* other;  // that may have been meant
  double factor;
};
constexpr double kMostJerk = 4;                       // times the acceleration, a cycle
constexpr double kMostTurned = 8 * std::numbers::pi;  // rad, of what a URDF may say: no arm turns that far
constexpr double kMostSlid = 20;                      // m
constexpr Plausible kTurning{"rad", 4 * std::numbers::pi, 30, 0.5, "degrees", std::numbers::pi / 180};
constexpr Plausible kSliding{"m", 10, 10, 0.1, "millimetres", 1e-3};

std::string shown(double value) {
  return fmt::format("{:.6g}", value);
}

class LimitReader {
 public:
  LimitReader(const YamlMap& map, const UrdfJoint* urdf, RigJoint& joint)
      : map_(map), urdf_(urdf), joint_(joint), plausible_(joint.unit == "m" ? kSliding : kTurning) {}

  void read_positions() {
    const bool bounded = urdf_ != nullptr && std::isfinite(urdf_->lower) && std::isfinite(urdf_->upper);
    const double most = plausible_.position;
    const std::pair<double, double> bounds = bounded ? std::pair(urdf_->lower, urdf_->upper) : std::pair(-most, most);
    joint_.drive.min_position = default_of("min", bounded ? std::optional(bounds.first) : std::nullopt);
    joint_.drive.max_position = default_of("max", bounded ? std::optional(bounds.second) : std::nullopt);
    const double farthest = std::max(std::abs(bounds.first), std::abs(bounds.second));
    const double little = kWritten * std::max(1.0, farthest);
    for (auto [key, value] : {std::pair("min", &joint_.drive.min_position), {"max", &joint_.drive.max_position}}) {
      if (!(*value >= bounds.first - little && *value <= bounds.second + little))
        refuse(key, *value, *value < bounds.first ? bounds.first : bounds.second, bounded, "", farthest);
      *value = std::clamp(*value, bounds.first, bounds.second);
    }
    if (joint_.drive.min_position >= joint_.drive.max_position)
      throw InputError(map_.where("min"),
                       shown(joint_.drive.min_position) + " is not below max, " + shown(joint_.drive.max_position),
                       "exchange or correct them");
  }

  void read_velocity() {
    const bool bounded = urdf_ != nullptr && urdf_->velocity > 0;
    const double most = bounded ? urdf_->velocity : plausible_.velocity;
    joint_.drive.max_velocity = default_of("velocity", bounded ? std::optional(most) : std::nullopt);
    if (!(joint_.drive.max_velocity > 0)) map_.positive("velocity");  // which refuses it
    if (joint_.drive.max_velocity > most * (1 + kWritten))
      refuse("velocity", joint_.drive.max_velocity, most, bounded, "/s", most);
    joint_.drive.max_velocity = std::min(joint_.drive.max_velocity, most);
  }

  void read_following_error(double rate_hz) {
    joint_.following_error = map_.positive("following_error");
    const double range = joint_.drive.max_position - joint_.drive.min_position;
    const double most = std::min(0.5 * range, plausible_.following_error);
    const double in_a_cycle = joint_.drive.max_velocity / rate_hz;
    if (joint_.following_error <= in_a_cycle)
      throw InputError(map_.where("following_error"),
                       fmt::format("{} {} is no more than the joint moves in one cycle of the control loop, {} {}",
                                   shown(joint_.following_error), joint_.unit, shown(in_a_cycle), joint_.unit),
                       fmt::format("give more than {}, at most {}, or a larger control.rate_hz than {:g}",
                                   shown(in_a_cycle), shown(most), rate_hz));
    if (joint_.following_error <= most * (1 + kRounding)) return;
    throw InputError(
        map_.where("following_error"),
        fmt::format("{} {} is more than {} {}, half of the joint's range or what links may be off their place: "
                    "nothing would be noticed",
                    shown(joint_.following_error), joint_.unit, shown(most), joint_.unit),
        guess(joint_.following_error, most, "").value_or("give a few hundredths, at most " + shown(most)));
  }

  void check_stop(double rate_hz) const {
    const double v = joint_.drive.max_velocity, a = joint_.drive.max_acceleration;
    const double range = joint_.drive.max_position - joint_.drive.min_position;
    if (v / a < 1 / rate_hz)
      throw InputError(
          map_.where("acceleration"),
          fmt::format("{} {}/s^2 reaches the velocity of {} {}/s in {:.3g} ms, less than a control cycle of "
                      "{:.3g} ms: nothing that has a mass does that",
                      shown(a), joint_.unit, shown(v), joint_.unit, 1e3 * v / a, 1e3 / rate_hz),
          guess(a, v * rate_hz, "/s^2").value_or("give what the drive can do, at most " + shown(v * rate_hz)));
    if (joint_.jerk > kMostJerk * a * rate_hz)
      throw InputError(
          map_.where("jerk"),
          fmt::format("{} {}/s^3 reaches the acceleration of {} {}/s^2 in {:.3g} ms, less than a quarter of "
                      "a control cycle of {:.3g} ms: that is no limit",
                      shown(joint_.jerk), joint_.unit, shown(a), joint_.unit, 1e3 * a / joint_.jerk, 1e3 / rate_hz),
          "give ten times the acceleration or so, at most " + shown(kMostJerk * a * rate_hz));
    const double way = stop_position(
        {0, v, 0}, {joint_.drive.min_position, joint_.drive.max_position, v, a, joint_.jerk}, 1 / rate_hz);
    if (way <= range) return;
    const bool too_weak = 0.5 * v * v / a > 0.5 * range;
    throw InputError(map_.where(too_weak ? "acceleration" : "jerk"),
                     fmt::format("with an acceleration of {} and a jerk of {} it takes the joint {} {} or more to stop "
                                 "from {} {}/s, and it has {} {}",
                                 shown(a), shown(joint_.jerk), shown(way), joint_.unit, shown(v), joint_.unit,
                                 shown(range), joint_.unit),
                     too_weak ? "give it more acceleration, or less velocity"
                              : "give it more jerk, such as ten times the acceleration");
  }

 private:
  double default_of(const char* key, const std::optional<double>& otherwise) const {
    if (map_.has(key) || (urdf_ == nullptr && !otherwise)) return map_.number(key);
    if (otherwise) return *otherwise;
    throw InputError(map_.where(key), "is missing, and the URDF has no such limit", "add it");
  }

  /// What `value` would be in the unit that is mistaken for ours, where it then fits. `per_second`: of ours, "/s^2".
  std::optional<std::string> guess(double value, double most, const char* per_second) const {
    const double meant = value * plausible_.factor;
    const bool little_too_much = std::abs(value) < 2.5 * most;  // that is another mistake
    if (little_too_much || !(std::abs(meant) <= 1.1 * most)) return std::nullopt;
    return fmt::format("{} looks like {}{}: {:.4g} {}{}{}", shown(value), plausible_.other, per_second, meant,
                       joint_.unit, per_second, std::abs(meant) > most ? ", and give at most " + shown(most) : "");
  }

  [[noreturn]] void refuse(const char* key, double value, double bound, bool by_urdf, const char* per_second,
                           double most) const {
    const std::string unit = joint_.unit + per_second;
    const std::string what =
        by_urdf ? fmt::format("{} {} is beyond the URDF's {} {}", shown(value), unit, shown(bound), unit)
                : fmt::format("{} {} is more than {} {}, and the URDF has no limit that says so", shown(value), unit,
                              shown(bound), unit);
    throw InputError(map_.where(key), what,
                     guess(value, most, per_second)
                         .value_or(by_urdf ? "give at most that, or correct the URDF"
                                           : "correct it, or give the joint its limits in the URDF"));
  }

  const YamlMap& map_;
  const UrdfJoint* urdf_;
  RigJoint& joint_;
  const Plausible& plausible_;
};

void require_unit(const YamlMap& map, const UrdfJoint* urdf, const RigJoint& joint) {
  if (urdf == nullptr) return;
  const bool turns = urdf->kind == UrdfJoint::Kind::rotating;
  if (turns == (joint.unit == "rad")) return;
  throw InputError(
      map.where("unit"),
      fmt::format("is {}, but joint '{}' {} in the URDF", joint.unit, joint.drive.name, turns ? "turns" : "slides"),
      turns ? "write `unit: rad`, and its numbers in rad" : "write `unit: m`, and its numbers in m");
}

void require_name(const UrdfRobot& robot, const UrdfJoint& joint, const std::string& file) {
  if (joint.name.empty())
    throw InputError(file,
                     "the <joint> that moves link " +
                         in_quotes(robot.links[static_cast<std::size_t>(joint.child)].name) + " has an empty name",
                     "name it: rig and commands call it so");
}

void require_near_origin(const UrdfJoint& joint, const std::string& file) {
  const double far = joint.T_parent_joint.translation().cwiseAbs().maxCoeff();
  if (far > kMostSlid)
    throw InputError(file + ": joint " + in_quotes(joint.name) + " <origin>",
                     fmt::format("is {:g} m from its parent's, and URDF counts in metres", far),
                     fmt::format("write metres: {:g} mm are {:g}", far, far * kSliding.factor));
}

}  // namespace

void require_joint_units(const UrdfRobot& robot, const std::string& file) {
  for (std::size_t i = 0; i < robot.joints.size(); ++i) {
    const UrdfJoint& joint = robot.joints[i];
    require_name(robot, joint, file);
    require_near_origin(joint, file);
    if (joint.kind == UrdfJoint::Kind::fixed || joint.mimic) continue;
    const std::string where = file + ": joint " + in_quotes(joint.name) + " <limit>";
    const bool turns = joint.kind == UrdfJoint::Kind::rotating;
    for (const auto& [key, value] : {std::pair("lower", joint.lower), {"upper", joint.upper}})
      if (std::isfinite(value) && std::abs(value) > (turns ? kMostTurned : kMostSlid))
        throw InputError(where,
                         fmt::format("{} is {:g}, and URDF counts in {}", key, value, turns ? "radians" : "metres"),
                         turns ? fmt::format("write radians: {:g} degrees are {:.4g}; type=\"continuous\" has no end",
                                             value, value * kTurning.factor)
                               : fmt::format("write metres: {:g} mm are {:g}", value, value * kSliding.factor));
    const UrdfJoint cut = within_followers(robot, i);
    if (joint.lower < joint.upper && !(cut.lower < cut.upper))
      throw InputError(where, "the limits of the joints that follow it leave it no way to move",
                       "correct their <limit>, or multiplier and offset of their <mimic>");
  }
}

void read_limits(const YamlMap& map, const UrdfJoint* urdf, double rate_hz, RigJoint& joint) {
  require_unit(map, urdf, joint);
  LimitReader reader(map, urdf, joint);
  reader.read_positions();
  reader.read_velocity();
  joint.drive.max_acceleration = map.positive("acceleration");
  joint.jerk = map.positive("jerk");
  reader.read_following_error(rate_hz);
  reader.check_stop(rate_hz);
  joint.drive.homing_velocity =
      map.has("homing_velocity") ? map.positive("homing_velocity") : 0.1 * joint.drive.max_velocity;
  if (joint.drive.homing_velocity > 0.25 * joint.drive.max_velocity)
    throw InputError(
        map.where("homing_velocity"),
        fmt::format("{} {}/s is more than a quarter of the joint's velocity, {} {}/s",
                    shown(joint.drive.homing_velocity), joint.unit, shown(joint.drive.max_velocity), joint.unit),
        "home slowly");
}

void check_counts(const YamlMap& map, const RigJoint& joint) {
  const DriveConfig& d = joint.drive;
  const std::string cure = fmt::format(
      "counts_per_unit is increments per {} of the joint: those of the encoder per turn of the motor, times the "
      "gear's ratio, {}",
      joint.unit, joint.unit == "m" ? "over the way of one turn in metres" : "/ 6.2832");
  if (1 / d.counts_per_unit > 0.1 * joint.following_error * (1 + kRounding))
    throw InputError(map.where("counts_per_unit"),
                     fmt::format("{} makes one count {} {}, more than a tenth of the following error of {} {}",
                                 shown(d.counts_per_unit), shown(1 / d.counts_per_unit), joint.unit,
                                 shown(joint.following_error), joint.unit),
                     cure);
  const double farthest = std::max(std::abs(d.min_position - d.offset), std::abs(d.max_position - d.offset));
  if (farthest * d.counts_per_unit > 2147483647.0)
    throw InputError(map.where("counts_per_unit"),
                     fmt::format("{} makes the joint's end at {} {} {:.4g} counts, more than the 2147483647 of 32 bits",
                                 shown(d.counts_per_unit), shown(farthest), joint.unit, farthest * d.counts_per_unit),
                     cure);
}

}  // namespace foresight
