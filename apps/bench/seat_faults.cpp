#include "apps/bench/seat_faults.hpp"

#include <algorithm>
#include <cmath>
#include <span>

#include "apps/operator/stepped_sides.hpp"

namespace foresight {
namespace {

constexpr double kLeastApart = 15, kMostApart = 45;  // s
constexpr double kLookEvery = 0.05;                  // s
constexpr double kClearlyMoves = 0.05;               // rad/s: a shaft that stands soon after is missed by nobody

void fail_a_drive(const SeatMoment& moment, std::size_t bus, std::size_t drive, sim::DriveFault fault) {
  if (sim::DriveRack* const rack = moment.robot.devices().rack(bus)) rack->inject(drive, fault);
}

/// Of the arm's drives, the one whose set-points move most.
std::size_t fastest(const RobotStatus& status, std::size_t drives) {
  const auto speeds = std::span(status.set_point).first(drives);
  const auto speed = [](const JointMotion& motion) { return std::abs(motion.velocity); };
  return static_cast<std::size_t>(std::ranges::max_element(speeds, {}, speed) - speeds.begin());
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
       2.0,
       {"robot", "drives", "prediction"},
       [drives, recover](const SeatMoment& m, bool begins) {
         begins ? fail_a_drive(m, 0, fastest(m.robot.robot().status(), drives), sim::DriveFault::jam) : recover(m);
       },
       [drives](const SeatMoment& m) {
         const RobotStatus status = m.robot.robot().status();
         return std::abs(status.set_point[fastest(status, drives)].velocity) > kClearlyMoves;
       }},
      {"no images are taken", 4, of_images, [](const SeatMoment& m, bool begins) { m.robot.hold_cameras(begins); }},
      {"the robot's program stands still",
       3,
       {"images", "robot", "in command"},
       [](const SeatMoment& m, bool begins) { m.robot.hold_program(begins); }},
      {"the operator's program stands still", 1.2, of_switch,
       [&stands](const SeatMoment&, bool begins) { stands = begins; }},
  };
}

FaultMaker::FaultMaker(std::vector<Fault> faults, std::mt19937& random, double told_within)
    : faults_(std::move(faults)), random_(random), told_within_(told_within), next_s_(kLeastApart) {}

void FaultMaker::look(const SeatMoment& moment, double now_s, const std::vector<SeatLine>& lines) {
  FaultRecord& record = records_.back();
  const double for_s = now_s - record.at_s;
  if (lasts_ && for_s >= now_->seconds) {
    now_->make(moment, false);
    lasts_ = false;
  }
  for (const SeatLine& line : lines)
    if (record.named.empty() && line.urgency != Urgency::fine &&
        std::ranges::find(now_->labels, line.label) != now_->labels.end()) {
      record.named = line.label + ": " + line.words;
      record.after_s = for_s;
    }
  if (lasts_ || (record.named.empty() && for_s < now_->seconds + told_within_)) return;
  now_ = nullptr;
  next_s_ = now_s + std::uniform_real_distribution<double>(kLeastApart, kMostApart)(random_);
}

void FaultMaker::step(const SeatMoment& moment, double now_s, const std::function<std::vector<SeatLine>()>& lines) {
  if (now_) {
    if (now_s - looked_s_ < kLookEvery) return;
    looked_s_ = now_s;
    look(moment, now_s, lines());
    return;
  }
  // What is marked already could not be told from what comes.
  if (now_s < next_s_) return;
  next_s_ = now_s + 1;
  if (!moment.seat.status().engaged) return;
  const auto index = std::uniform_int_distribution<std::size_t>(0, faults_.size() - 1)(random_);
  if (faults_[index].would_show && !faults_[index].would_show(moment)) return;
  const std::vector<SeatLine> before = lines();
  const auto& labels = faults_[index].labels;
  if (std::ranges::any_of(before, [&](const SeatLine& line) {
        return line.urgency != Urgency::fine && std::ranges::find(labels, line.label) != labels.end();
      }))
    return;
  now_ = &faults_[index];
  lasts_ = true;
  looked_s_ = now_s;
  records_.push_back({now_->name, now_s, "", 0});
  now_->make(moment, true);
}

}  // namespace foresight
