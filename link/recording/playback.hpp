// A recording as if it were the robot: the messages that its program published, moved to now.
#pragma once

#include <map>
#include <span>

#include "link/dds/participant.hpp"
#include "link/messages/cdr.hpp"
#include "link/recording/mcap_reader.hpp"
#include "link/recording/played_time.hpp"
#include "link/recording/recorded_stream.hpp"

namespace foresight::link {

/// What is played: what the robot's program tells. Nothing that anybody said to a robot, nothing of who commands, and
/// no set-points: whoever plays a recording moves nothing with it, here or in whatever else listens.
std::span<const Topic> played_topics();

struct PlaybackOptions {
  double rate = 1;            ///< 0.01 .. 100
  Duration from{0};           ///< what came earlier is left out, but for the last of what who comes late gets
  std::uint64_t session = 0;  ///< drawn at random: another start of the robot's program than the recorded one
};

/// Pairs that went out in pieces (h264) are played as whole ones with JPEGs, as there is nobody whom a recording could
/// ask what arrived. Pure: the caller sends and waits. One thread.
class Playback {
 public:
  /// `start`: when the first message goes, which is `start_unix_ns` on the wall clock.
  Playback(RobotTime start, std::int64_t start_unix_ns, const PlaybackOptions& options);

  struct Message {
    const Topic* topic = nullptr;  ///< of played_topics()
    Bytes cdr;
    RobotTime due;
  };
  /// What goes on behalf of this message of a recording, in its order.
  std::vector<Message> take(const McapMessage& message);

  /// False: nothing of this chunk would go, and nothing of it is needed for what comes later.
  bool wants_chunk(std::int64_t end_ns, std::span<const McapChannel* const> channels) const;

  struct Pieces {
    std::uint64_t came = 0;
    std::uint64_t pairs = 0;  ///< that became whole
  };
  const Pieces& pieces() const { return pieces_; }
  std::uint64_t damaged() const { return damaged_; }  ///< messages of such topics that are none
  /// Topics that are not played, with their numbers of messages.
  const std::map<std::string, std::uint64_t>& left_out() const { return left_out_; }

 private:
  std::vector<Message> take_piece(const McapMessage& message);
  /// `cdr`: of that topic of played_topics(); `message` says when.
  std::vector<Message> take(std::size_t topic, std::span<const std::uint8_t> cdr, const McapMessage& message);
  Message moved(std::size_t topic, std::span<const std::uint8_t> cdr, RobotTime due) const;

  PlaybackOptions options_;
  PlayedTime time_;
  std::optional<std::int64_t> begin_ns_;  // of what is played, by log_ns
  bool began_ = false;
  std::map<std::size_t, Bytes> kept_;  // from before, by topic
  RecordedStream stream_;
  RobotTime stream_time_;
  Pieces pieces_;
  std::uint64_t damaged_ = 0;
  std::map<std::string, std::uint64_t> left_out_;
};

}  // namespace foresight::link
