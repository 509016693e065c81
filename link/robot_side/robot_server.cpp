#include "link/robot_side/robot_server.hpp"

#include <fmt/core.h>

#include <utility>

#include "link/robot_side/rig_identity.hpp"

namespace foresight::link {
namespace {

constexpr std::size_t kRoom = 2;                                 // pairs that wait for the coder; only the newest goes
constexpr Duration kLookEvery = std::chrono::milliseconds(500);  // for another robot

ControlDeskOptions desk_options(Identity identity, const RobotCameras* cameras, Duration round_trip, DrawNonce draw) {
  if (cameras) identity.scene = scene_digest(cameras->scene());
  ControlDeskOptions out;
  out.life.allowed_delay = round_trip;
  out.identity = std::move(identity);
  out.draw = std::move(draw);
  return out;
}

}  // namespace

RobotServer::RobotServer(const Rig& rig, const Robot& robot, RobotCameras* cameras, Identity identity, Clock& clock,
                         std::shared_ptr<PretendedLine> line)
    : RobotServer(std::make_unique<Participant>(rig.link, "robot " + rig.name, Role::robot, std::move(line)), nullptr,
                  rig, robot, cameras, std::move(identity), clock, {}) {}

RobotServer::RobotServer(Participant& participant, const Rig& rig, const Robot& robot, RobotCameras* cameras,
                         Identity identity, Clock& clock, const Start& start)
    : RobotServer(nullptr, &participant, rig, robot, cameras, std::move(identity), clock, start) {}

RobotServer::RobotServer(std::unique_ptr<Participant> own, Participant* others, const Rig& rig, const Robot& robot,
                         RobotCameras* cameras, Identity identity, Clock& clock, const Start& start)
    : own_(std::move(own)),
      participant_(own_ ? *own_ : *others),
      wall_(clock, start.wall),
      operator_(participant_, rig.gate_options(),
                desk_options(std::move(identity), cameras, rig.link.round_trip, start.draw), clock, &capacity_),
      states_(participant_, {start.draw(), rig.joint_names()}, rig, robot, cameras, wall_, clock, &operator_.taken(),
              &capacity_) {
  if (!cameras) return;
  const auto& lenses = cameras->scene().lenses();
  frames_ = std::make_unique<FrameSender>(
      participant_, states_.name(), lenses ? &*lenses : nullptr, cameras->frames().subscribe(kRoom),
      FrameSenderOptions{rig.link.coding, rig.link.jpeg_quality, rig.link.image_rate_hz, &capacity_}, wall_, clock);
}

void RobotServer::start() {
  states_.start();
  if (frames_) frames_->start();
}

void RobotServer::step(RobotTime now) {
  states_.step(now);
  if (frames_) frames_->step(Duration{0});
}

void RobotServer::stop() noexcept {
  if (frames_) frames_->stop();
  states_.stop();
}

std::string RobotServer::news(RobotTime now) {
  if (const std::string lease = lease_.of(operator_.desk(), now); !lease.empty()) return lease;
  if (now >= look_due_) {
    look_due_ = now + kLookEvery;
    if (const std::string before = std::exchange(beside_, robot_beside()); !beside_.empty() && beside_ != before)
      return beside_ + " has come to the same domain, and operators hear both: end it, or change its link.domain";
    else if (beside_.empty() && !before.empty())
      return before + " has gone from the domain: operators hear this robot alone";
  }
  return refusals_.news(participant_, now);
}

std::string RobotServer::line() const {
  std::string others;
  for (const Peer& peer : participant_.peers())
    if (!peer.own) others += (others.empty() ? "" : ", ") + peer.name;
  const FrameCounts counts = this->counts();
  std::string out = others.empty() ? "nobody listens" : others;
  if (const std::string lease = lease_.line(); !lease.empty()) out += "; " + lease;
  if (frames_) out += fmt::format("; {} pairs sent", static_cast<unsigned long long>(counts.sent));
  if (counts.bytes_per_s > 0) out += fmt::format(", the line carries {:.0f} kbit/s", 8e-3 * counts.bytes_per_s);
  if (frames_ && !counts.watched) out += ", nobody takes pictures";
  if (counts.failed) out += fmt::format(", {} could not be coded", static_cast<unsigned long long>(counts.failed));
  if (const std::uint64_t refused = participant_.refused())
    out += fmt::format(", {} messages refused, the last: {}", static_cast<unsigned long long>(refused),
                       participant_.refusal());
  const std::string trouble = participant_.trouble();
  return out + (trouble.empty() ? "" : "; " + trouble);
}

}  // namespace foresight::link
