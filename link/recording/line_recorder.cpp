#include "link/recording/line_recorder.hpp"

#include <fmt/core.h>

#include "common/error.hpp"
#include "common/text.hpp"
#include "link/dds/topics.hpp"
#include "link/messages/message_types.hpp"

namespace foresight::link {
namespace {

using namespace std::chrono_literals;

constexpr Duration kLook = 100ms;
constexpr int kRoom = 512;  // samples that come between two steps: all pieces of a few pairs, on a busy machine

bool is_copy(const std::string& topic) {
  return topic == topics::compressed_images("left").name || topic == topics::compressed_images("right").name;
}

}  // namespace

std::string topic_in_ros(const std::string& dds_topic) {
  return dds_topic.starts_with("rt/") ? dds_topic.substr(2) : dds_topic;
}

LineRecorder::LineRecorder(Participant& participant, RecordingFile& file, const Clock& clock,
                           LineRecorderOptions options)
    : participant_(participant),
      file_(file),
      options_(options),
      wall_minus_clock_(WallClock::machine_unix_ns() - clock.now().ns) {}

LineRecorder::~LineRecorder() = default;

void LineRecorder::look_around() {
  for (const Peer& peer : participant_.peers())
    for (const Peer::Endpoint& endpoint : peer.endpoints)
      if (endpoint.writes && !known_.contains(endpoint.topic)) {
        if (is_copy(endpoint.topic) && !options_.pictures) continue;
        if (known_.size() >= options_.most_topics) return;
        known_.insert(endpoint.topic);
        if (known_.size() == options_.most_topics)
          news_.push_back(fmt::format("there are more than {} topics: others are not recorded", options_.most_topics));
        add(peer.name, endpoint);
      }
}

void LineRecorder::add(const std::string& writer, const Peer::Endpoint& endpoint) {
  const Topic topic{endpoint.topic, endpoint.type, endpoint.delivery, kRoom};
  try {
    Recorded recorded{topic_in_ros(topic.name), std::make_unique<Reader>(participant_, topic)};
    recorded.channel = file_.add_channel(recorded.topic, topic.type,
                                         {{"dds_topic", topic.name},
                                          {"dds_type", topic.type},
                                          {"kept", endpoint.delivery == Delivery::kept ? "yes" : "no"},
                                          {"writer", writer}});
    topics_.push_back(std::move(recorded));
    news_.push_back(fmt::format("{} ({}) of {}", topics_.back().topic, ros_name(topic.type), writer));
  } catch (const RuntimeFailure& failure) {
    news_.push_back(fmt::format("{} is not recorded: {}", in_quotes(topic.name), failure.what()));
  }
}

void LineRecorder::step(RobotTime now) {
  if (now >= look_due_) {
    look_due_ = now + kLook;
    look_around();
  }
  for (Recorded& topic : topics_)
    topic.reader->take([&](const Sample& sample) {
      ++came_;
      ++topic.came;
      if (!file_.put(topic.channel, log_ns(now), sample.sent_unix_ns, {sample.cdr.begin(), sample.cdr.end()}))
        ++topic.dropped;
    });
}

std::vector<std::string> LineRecorder::take_news() {
  return std::exchange(news_, {});
}

std::uint64_t LineRecorder::lost() const {
  std::uint64_t out = 0;
  for (const Recorded& topic : topics_) out += topic.reader->lost();
  return out;
}

McapTexts LineRecorder::remarks() const {
  McapTexts out;
  for (const Recorded& topic : topics_)
    out[topic.topic] = fmt::format("came {}, lost on the way {}, dropped for the disk {}", topic.came,
                                   topic.reader->lost(), topic.dropped);
  return out;
}

}  // namespace foresight::link
