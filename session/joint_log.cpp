#include "session/joint_log.hpp"

#include "common/error.hpp"
#include "scene/run_writer.hpp"

namespace foresight {

JointLog::JointLog(const std::filesystem::path& file, const Rig& rig, BroadcastRing<RobotCycle>::Reader cycles)
    : stream_(file), cycles_(std::move(cycles)) {
  if (!stream_) throw RuntimeFailure("cannot write " + file.string(), "choose a folder that can be written");
  stream_.setf(std::ios::fixed);
  stream_.precision(7);
  stream_ << "time_s";
  for (const std::string& joint : rig.joint_names()) stream_ << ',' << joint;
  for (const std::string& joint : rig.joint_names()) stream_ << ',' << joint << "_time_s";
  stream_ << '\n';
}

void JointLog::write() {
  while (const auto cycle = cycles_.take()) {
    if (!cycle->all_homed) continue;
    stream_ << time_text(cycle->time);
    for (std::size_t i = 0; i < cycle->joints; ++i) stream_ << ',' << cycle->joint[i].position;
    for (std::size_t i = 0; i < cycle->joints; ++i) stream_ << ',' << time_text(cycle->joint[i].time);
    stream_ << '\n';
  }
}

}  // namespace foresight
