#include "apps/bench/seat_faults.hpp"

#include <algorithm>

#include "apps/operator/stepped_sides.hpp"

namespace foresight {
namespace {

constexpr double kLeastApart = 15, kMostApart = 45;  // s
constexpr double kLookEvery = 0.05;                  // s

void fail_a_drive(const SeatMoment& moment, std::size_t bus, std::size_t drive, sim::DriveFault fault) {
  if (sim::DriveRack* const rack = moment.robot.devices().rack(bus)) rack->inject(drive, fault);
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
  const auto for_a_while = [drives, any_drive](sim::DriveFault fault) {
    return [drives, any_drive, fault](const SeatMoment& moment, bool begins) {
      if (begins) return fail_a_drive(moment, 0, any_drive(), fault);
      for (std::size_t i = 0; i < drives; ++i) fail_a_drive(moment, 0, i, sim::DriveFault::recover);
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
      {"a shaft is held fast", 2.0, {"robot", "drives", "prediction"}, for_a_while(sim::DriveFault::jam)},
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
