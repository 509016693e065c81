#include "apps/bench/seat_faults.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>
#include <span>

#include "apps/operator/stepped_sides.hpp"

namespace foresight {
namespace {

constexpr double kLeastApart = 15, kMostApart = 45;  // s
constexpr double kLookEvery = 0.05;                  // s
constexpr double kLost = 2;                          // s: by then the switch has ceased to count
constexpr std::size_t kDrawsInVain = 60;             // each a second after the one before
constexpr std::size_t kHeadBus = 1;                  // of the rig
constexpr double kClearlyMoves = 0.1;                // rad/s: a shaft that stands soon after is missed by nobody

void fail_a_drive(const SeatMoment& moment, std::size_t bus, std::size_t drive, sim::DriveFault fault) {
  if (sim::DriveRack* const rack = moment.robot.devices().rack(bus)) rack->inject(drive, fault);
}

/// Of the arm's drives, the one whose set-points move most.
std::size_t fastest(const RobotStatus& status, std::size_t drives) {
  const auto speeds = std::span(status.set_point).first(drives);
  const auto speed = [](const JointMotion& motion) { return std::abs(motion.velocity); };
  return static_cast<std::size_t>(std::ranges::max_element(speeds, {}, speed) - speeds.begin());
}

/// As long as that in any direction, and as wide a turn about any axis.
Pose somewhere_else(std::mt19937& random, double way, double turn) {
  const auto direction = [&random] {
    std::normal_distribution<double> normal;
    const double x = normal(random), y = normal(random), z = normal(random);
    return Eigen::Vector3d(x, y, z).normalized();
  };
  Pose out = Pose::Identity();
  out.translation() = way * direction();
  out.linear() = Eigen::AngleAxisd(turn, direction()).toRotationMatrix();
  return out;
}

}  // namespace

std::vector<Fault> seat_faults(std::size_t drives, std::mt19937& random, bool& stands) {
  const auto any_drive = [drives, &random] {
    return std::uniform_int_distribution<std::size_t>(0, drives - 1)(random);
  };
  const auto on_arm = [any_drive](sim::DriveFault fault) {
    return [any_drive, fault](const SeatMoment& moment, bool begins) {
      if (begins) fail_a_drive(moment, 0, any_drive(), fault);
    };
  };
  const auto recover = [drives](const SeatMoment& moment) {
    for (std::size_t i = 0; i < drives; ++i) fail_a_drive(moment, 0, i, sim::DriveFault::recover);
  };
  const auto for_a_while = [any_drive, recover](sim::DriveFault fault) {
    return [any_drive, recover, fault](const SeatMoment& moment, bool begins) {
      begins ? fail_a_drive(moment, 0, any_drive(), fault) : recover(moment);
    };
  };
  const std::vector<std::string> of_robot{"robot", "drives"}, of_images{"images"}, of_switch{"in command", "next"};
  return {
      {"stopped at the robot", 0, of_robot,
       [](const SeatMoment& m, bool begins) {
         if (begins) m.robot.robot().ask(RobotRequest::emergency_stop);
       }},
      {"stopped at the seat", 0, of_robot,
       [](const SeatMoment& m, bool begins) {
         if (begins)
           m.end.seat([](ControlSeat& seat, OperatorTime now) { seat.request(LineRequest::emergency_stop, now); });
       }},
      {"a drive finds a short circuit", 0, of_robot, on_arm(sim::DriveFault::overcurrent)},
      {"a shaft lags behind", 0, of_robot, on_arm(sim::DriveFault::tow_error)},
      {"a drive sends nothing", 1.5, of_robot, for_a_while(sim::DriveFault::silent)},
      {"a drive tells nonsense", 1.0, of_robot, for_a_while(sim::DriveFault::garbage)},
      {"a shaft is held fast",
       4.0,
       {"robot", "drives", "prediction"},
       [drives, recover](const SeatMoment& m, bool begins) {
         begins ? fail_a_drive(m, 0, fastest(m.robot.robot().status(), drives), sim::DriveFault::jam) : recover(m);
       },
       [drives](const SeatMoment& m) {
         const RobotStatus status = m.robot.robot().status();
         return std::abs(status.set_point[fastest(status, drives)].velocity) > kClearlyMoves;
       }},
      {"the head's encoders say nothing",
       3,
       of_images,
       [](const SeatMoment& m, bool begins) {
         fail_a_drive(m, kHeadBus, 0, begins ? sim::DriveFault::silent : sim::DriveFault::recover);
       },
       {},
       "NO POSE for the newest image: pan"},
      {"no images are taken", 4, of_images, [](const SeatMoment& m, bool begins) { m.robot.hold_cameras(begins); }},
      {"the robot's program stands still",
       3,
       {"images", "robot", "in command"},
       [](const SeatMoment& m, bool begins) { m.robot.hold_program(begins); }},
      {"the operator's program stands still", 1.2, of_switch,
       [&stands](const SeatMoment&, bool begins) { stands = begins; }},
  };
}

std::vector<Fault> hand_faults(SeatHand& hand, std::mt19937& random) {
  // A program that goes on hears of it in its next cycle; a device that says nothing is believed for 0.2 s.
  constexpr double kAtOnce = 0.1, kFrozen = 0.35;
  const std::vector<std::string> of_hand{"hand"}, of_device{"device", "device 2"};
  const auto by_controller = [&hand](const SeatMoment&) { return !hand.at_gamepad(); };
  const auto controller = [&](const char* name, ControllerFault what, const std::vector<std::string>& labels,
                              const char* words, double within) {
    const auto make = [&hand, what](const SeatMoment&, bool begins) {
      hand.fail(begins ? what : ControllerFault::none);
    };
    return Fault{name, 3, labels, make, by_controller, words, within};
  };
  const auto jump = [&](const char* name, double way, double turn) {
    const auto make = [&hand, &random, way, turn](const SeatMoment&, bool begins) {
      if (begins) hand.jump_hand(somewhere_else(random, way, turn));
    };
    return Fault{name, 0, of_hand, make, by_controller, "jumped", kAtOnce};
  };
  return {
      controller("the controller is off", ControllerFault::off, of_device, "the controller is off", kAtOnce),
      controller("the controller is not seen", ControllerFault::not_seen, of_hand, "not tracked", kAtOnce),
      controller("the controller is frozen", ControllerFault::frozen, of_hand, "nothing new", kFrozen),
      controller("the controller's instants are old", ControllerFault::late, of_hand, "nothing new", kFrozen),
      controller("the controller's pose is no number", ControllerFault::no_number, of_hand, "pose is none", kAtOnce),
      controller("the controller's clock is another", ControllerFault::other_clock, of_hand, "another clock", kAtOnce),
      jump("the hand jumps by half a metre", 0.5, 0),
      jump("the hand jumps by a quarter turn", 0, 0.5 * std::numbers::pi),
      {"the gamepad is unplugged", 3, of_device,
       [&hand](const SeatMoment&, bool begins) { hand.plug_gamepad(!begins); },
       [&hand](const SeatMoment&) { return hand.at_gamepad(); }, "the gamepad is not there", kAtOnce},
  };
}

void Strangers::come(SteppedRobotSide& robot, Kind kind) {
  Rig other = rig_;
  Identity identity = robot.identity();
  switch (kind) {
    case Kind::other_joints:
      std::swap(other.joints.at(0), other.joints.at(1));
      identity.joints = other.joint_names();
      identity.rig = ~identity.rig;
      break;
    case Kind::other_model: identity.urdf = ~identity.urdf; break;
    case Kind::other_lenses:
      for (CameraConfig& camera : other.cameras->cameras) {
        camera.settings.width /= 2;
        camera.settings.height /= 2;
      }
      identity.calibration = ~identity.calibration;
      break;
  }
  must_rest_ = kind != Kind::other_lenses;
  robot.start(other, identity);
}

void Strangers::go(SteppedRobotSide& robot) {
  must_rest_ = false;
  robot.start(rig_, robot.identity());
}

std::vector<Fault> start_faults(Strangers& strangers) {
  constexpr double kGone = 8, kThere = 12;  // s
  const auto stranger = [&strangers](const char* name, Strangers::Kind kind, const std::vector<std::string>& labels,
                                     const char* words) {
    const auto make = [&strangers, kind](const SeatMoment& m, bool begins) {
      begins ? strangers.come(m.robot, kind) : strangers.go(m.robot);
    };
    return Fault{name, kThere, labels, make, {}, words, kLost};
  };
  const std::vector<std::string> refused{"refused", "in command"};
  return {
      {"the robot's program is gone, and starts anew",
       kGone,
       {"line"},
       [](const SeatMoment& m, bool begins) {
         begins ? m.robot.end() : m.robot.start(m.robot.rig(), m.robot.identity());
       },
       {},
       "nothing comes of the robot",
       kLost},
      {"the robot's program starts anew at once",
       0,
       {"line", "in command", "drives"},
       [](const SeatMoment& m, bool begins) {
         if (begins) m.robot.start(m.robot.rig(), m.robot.identity());
       },
       {},
       "",
       kLost},
      stranger("a robot with other joints in its place", Strangers::Kind::other_joints, refused, "joint"),
      stranger("a robot of another model in its place", Strangers::Kind::other_model, refused, "URDF"),
      stranger("a robot with other lenses in its place", Strangers::Kind::other_lenses, {"differs"}, "calibration"),
  };
}

FaultMaker::FaultMaker(std::vector<Fault> faults, std::mt19937& random, double told_within)
    : faults_(std::move(faults)), random_(random), told_within_(told_within), next_s_(kLeastApart) {}

void FaultMaker::heed_switch(const SeatMoment& moment, double now_s) {
  FaultRecord& record = records_.back();
  const double for_s = now_s - record.at_s;
  if (!record.let_go_s && !moment.seat.status().engaged) record.let_go_s = for_s;
  if (now_->lets_go_within && record.let_go_s.value_or(for_s) > *now_->lets_go_within) record.drove_on = true;
}

void FaultMaker::look(const SeatMoment& moment, double now_s, const std::vector<SeatLine>& lines) {
  FaultRecord& record = records_.back();
  const double for_s = now_s - record.at_s;
  if (lasts_ && for_s >= now_->seconds) {
    now_->make(moment, false);
    lasts_ = false;
  }
  for (const SeatLine& line : lines)
    if (record.named.empty() && line.urgency != Urgency::fine && line.words.find(now_->words) != line.words.npos &&
        std::ranges::find(now_->labels, line.label) != now_->labels.end()) {
      record.named = line.label + ": " + line.words;
      record.after_s = for_s;
    }
  const bool judged = !now_->lets_go_within || record.let_go_s || record.drove_on;
  if (lasts_ || ((record.named.empty() || !judged) && for_s < now_->seconds + told_within_)) return;
  now_ = nullptr;
  next_s_ = now_s + std::uniform_real_distribution<double>(kLeastApart, kMostApart)(random_);
}

/// One that has not been in this round; after many that could not begin, the round is over.
std::size_t FaultMaker::draw() {
  if (left_.empty() || in_vain_ > kDrawsInVain) {
    left_.resize(faults_.size());
    std::iota(left_.begin(), left_.end(), std::size_t{0});
    in_vain_ = 0;
  }
  ++in_vain_;
  return left_[std::uniform_int_distribution<std::size_t>(0, left_.size() - 1)(random_)];
}

void FaultMaker::begin(const SeatMoment& moment, double now_s, const std::function<std::vector<SeatLine>()>& lines) {
  next_s_ = now_s + 1;
  if (!moment.seat.status().engaged) return;
  const std::size_t index = draw();
  const Fault& fault = faults_[index];
  if (fault.would_show && !fault.would_show(moment)) return;
  // What is marked already could not be told from what comes.
  if (std::ranges::any_of(lines(), [&](const SeatLine& line) {
        return line.urgency != Urgency::fine && std::ranges::find(fault.labels, line.label) != fault.labels.end();
      }))
    return;
  std::erase(left_, index);
  in_vain_ = 0;
  now_ = &fault;
  lasts_ = true;
  looked_s_ = now_s;
  records_.push_back({fault.name, now_s, "", 0, std::nullopt, false});
  fault.make(moment, true);
}

void FaultMaker::step(const SeatMoment& moment, double now_s, const std::function<std::vector<SeatLine>()>& lines) {
  if (!now_) {
    if (now_s >= next_s_) begin(moment, now_s, lines);
    return;
  }
  heed_switch(moment, now_s);
  if (now_s - looked_s_ < kLookEvery) return;
  looked_s_ = now_s;
  look(moment, now_s, lines());
}

}  // namespace foresight
