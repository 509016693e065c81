// Everything that is said on a line, into a recording.
#pragma once

#include <deque>
#include <memory>
#include <set>

#include "link/dds/endpoints.hpp"
#include "link/recording/recording_file.hpp"
#include "link/robot_side/wall_clock.hpp"

namespace foresight::link {

struct LineRecorderOptions {
  /// Also the copies of the pictures that the robot's program makes for ROS 2's tools while somebody reads them: twice
  /// the bytes on the line.
  bool pictures = false;
  std::size_t most_topics = 200;
};

/// Records every topic that anybody writes, of whatever type: the bytes as they came, under the name that ROS 2 has for
/// it ("/joint_states"). A message's `log_ns` is when it was taken here, on this host's wall clock as it was at the
/// start (it never goes back); its `publish_ns` is when it was written, by the writer's wall clock. One thread.
class LineRecorder {
 public:
  /// References must outlive this.
  LineRecorder(Participant& participant, RecordingFile& file, const Clock& clock, LineRecorderOptions options = {});
  ~LineRecorder();

  /// Takes what has come, and looks for new topics ten times a second. Never waits.
  void step(RobotTime now);

  /// Words about topics, for people, since it was asked last: what is recorded, what cannot be.
  std::vector<std::string> take_news();
  std::uint64_t came() const { return came_; }  ///< messages
  std::uint64_t lost() const;                   ///< on the way, of reliable writers: never seen here
  std::int64_t log_ns(RobotTime time) const { return time.ns + wall_minus_clock_; }
  /// For the recording's metadata: by topic, what came, and what was lost or dropped.
  McapTexts remarks() const;

 private:
  struct Recorded {
    std::string topic;
    std::unique_ptr<Reader> reader;
    std::size_t channel = 0;
    std::uint64_t came = 0, dropped = 0;
  };
  void look_around();
  void add(const std::string& writer, const Peer::Endpoint& endpoint);

  Participant& participant_;
  RecordingFile& file_;
  const LineRecorderOptions options_;
  const std::int64_t wall_minus_clock_;
  RobotTime look_due_;
  std::set<std::string> known_;  // topics, recorded or not
  std::deque<Recorded> topics_;
  std::vector<std::string> news_;
  std::uint64_t came_ = 0;
};

/// "rt/joint_states" as "/joint_states"; other names as they are.
std::string topic_in_ros(const std::string& dds_topic);

}  // namespace foresight::link
