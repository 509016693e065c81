#include "session/joint_log.hpp"

#include <cerrno>
#include <cstring>

#include "common/atomic_file.hpp"
#include "common/empty_file.hpp"
#include "common/error.hpp"
#include "scene/run_writer.hpp"

namespace foresight {
namespace {

constexpr Duration kPatience = std::chrono::milliseconds(500);

}  // namespace

JointLog::JointLog(const std::filesystem::path& file, const Rig& rig, BroadcastRing<RobotCycle>::Reader cycles)
    : file_(file), stream_(file), cycles_(cycles), joints_(rig.joints.size()) {
  if (!stream_) throw RuntimeFailure("cannot write " + file.string(), "choose a folder that can be written");
  stream_.setf(std::ios::fixed);
  stream_.precision(7);
  stream_ << "time_s";
  for (const std::string& joint : rig.joint_names()) stream_ << ',' << joint;
  stream_ << '\n';
}

JointLog::~JointLog() {
  stream_.close();
  remove_empty(file_);
}

void JointLog::write() {
  while (const auto cycle = cycles_.take()) {
    joints_.add(*cycle);
    if (cycle->all_homed) waiting_.push_back(cycle->time);
    while (!waiting_.empty() && (joints_.know(waiting_.front()) || cycle->time - waiting_.front() > kPatience)) {
      write_row(joints_.at(waiting_.front()));
      waiting_.pop_front();
    }
  }
}

std::string JointLog::fault() {
  if (stream_.flush()) return {};
  return file_.string() + ": the log ends early (" + std::strerror(errno) + "); " + cure_of_write_error(errno);
}

void JointLog::write_row(const JointState& state) {
  if (state.status == StateStatus::invalid) {
    ++silent_;
    return;
  }
  stream_ << time_text(state.time);
  for (const double position : state.positions) stream_ << ',' << position;
  stream_ << '\n';
}

}  // namespace foresight
