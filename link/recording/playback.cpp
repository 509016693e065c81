#include "link/recording/playback.hpp"

#include <algorithm>
#include <array>

#include "link/dds/topics.hpp"
#include "link/messages/message_types.hpp"
#include "link/recording/line_recorder.hpp"
#include "pictures/encode.hpp"

namespace foresight::link {
namespace {

/// Walks through all fields of any message and moves those that are instants.
class InstantMover {
 public:
  InstantMover(const PlayedTime& time, std::uint64_t session) : time_(time), session_(session) {}

  template <typename T>
  InstantMover& operator()(std::string_view name, T& value) {
    if constexpr (std::is_same_v<T, RosTime>) {
      if (value.sec != 0 || value.nanosec != 0) value = ros_time(time_.unix_ns(unix_ns(value)));
    } else if constexpr (std::is_same_v<T, std::int64_t>) {
      const bool instant = name.ends_with("_ns") && name != "uncertainty_ns";
      if (instant && value != 0) value = time_.monotonic_ns(value);
    } else if constexpr (std::is_same_v<T, std::uint64_t>) {
      if (name == "session") value ^= session_;
    } else if constexpr (detail::Message<T>) {
      detail::visit(value, *this);
    } else if constexpr (requires { value.begin()->kType; }) {
      for (auto& one : value) detail::visit(one, *this);
    }
    return *this;
  }

 private:
  const PlayedTime& time_;
  std::uint64_t session_;
};

void learn(PlayedTime& time, const StereoFrame& frame) {
  time.learn(unix_ns(frame.header.stamp), frame.left.capture_ns, /*exact=*/true);
}
void learn(PlayedTime& time, const RobotState& state) {
  time.learn(unix_ns(state.header.stamp), state.time_ns, /*exact=*/false);
}
void learn(PlayedTime&, const auto&) {}

struct PlayedType {
  Topic topic;
  /// False where the bytes are no such message.
  bool (*learn)(PlayedTime& time, std::span<const std::uint8_t> cdr);
  Bytes (*move)(const PlayedTime& time, std::uint64_t session, std::span<const std::uint8_t> cdr);
};

template <detail::Message T>
PlayedType played(Topic topic) {
  return {std::move(topic),
          [](PlayedTime& time, std::span<const std::uint8_t> cdr) {
            const auto message = from_cdr<T>(cdr);
            if (message) learn(time, *message);
            return message.has_value();
          },
          [](const PlayedTime& time, std::uint64_t session, std::span<const std::uint8_t> cdr) {
            T message = *from_cdr<T>(cdr);
            InstantMover mover(time, session);
            detail::visit(message, mover);
            return to_cdr(message);
          }};
}

constexpr std::size_t kFrames = 0;  // in played_types()

const std::vector<PlayedType>& played_types() {
  static const std::vector<PlayedType> all{played<StereoFrame>(topics::frames()),
                                           played<RobotState>(topics::robot_state()),
                                           played<JointStateMessage>(topics::joint_states()),
                                           played<TFMessage>(topics::transforms()),
                                           played<TFMessage>(topics::static_transforms()),
                                           played<DiagnosticArray>(topics::diagnostics()),
                                           played<CompressedImage>(topics::compressed_images("left")),
                                           played<CompressedImage>(topics::compressed_images("right")),
                                           played<CameraInfoMessage>(topics::camera_info("left")),
                                           played<CameraInfoMessage>(topics::camera_info("right"))};
  return all;
}

/// Its place in played_types().
std::optional<std::size_t> played_type(const McapChannel& channel) {
  const auto found = std::ranges::find_if(played_types(), [&](const PlayedType& type) {
    return channel.message_encoding == "cdr" && topic_in_ros(type.topic.name) == channel.topic &&
           ros_name(type.topic.type) == channel.schema->name;
  });
  if (found == played_types().end()) return std::nullopt;
  return static_cast<std::size_t>(found - played_types().begin());
}

bool is_pieces(const McapChannel& channel) {
  const Topic topic = topics::pieces();
  return channel.message_encoding == "cdr" && channel.topic == topic_in_ros(topic.name) &&
         channel.schema->name == ros_name(topic.type);
}

}  // namespace

std::span<const Topic> played_topics() {
  static const std::vector<Topic> all = [] {
    std::vector<Topic> out;
    for (const PlayedType& type : played_types()) out.push_back(type.topic);
    return out;
  }();
  return all;
}

Playback::Playback(RobotTime start, std::int64_t start_unix_ns, const PlaybackOptions& options)
    : options_(options), time_(start, start_unix_ns, options.rate) {}

Playback::Message Playback::moved(std::size_t topic, std::span<const std::uint8_t> cdr, RobotTime due) const {
  return {&played_topics()[topic], played_types()[topic].move(time_, options_.session, cdr), due};
}

bool Playback::wants_chunk(std::int64_t end_ns, std::span<const McapChannel* const> channels) const {
  constexpr std::int64_t kBefore = 2'000'000'000;  // ns: the robot's state comes more often
  if (!begin_ns_ || began_ || end_ns >= *begin_ns_ - std::min(kBefore, options_.from.count())) return true;
  return std::ranges::any_of(channels, [](const McapChannel* channel) {  // coded pairs build on earlier ones
    return channel->topic == topic_in_ros(topics::static_transforms().name) || is_pieces(*channel);
  });
}

std::vector<Playback::Message> Playback::take(const McapMessage& message) {
  if (is_pieces(message.channel)) return take_piece(message);
  const auto topic = played_type(message.channel);
  if (topic) return take(*topic, message.data, message);
  ++left_out_[message.channel.topic];
  return {};
}

std::vector<Playback::Message> Playback::take_piece(const McapMessage& message) {
  constexpr int kQuality = 95;
  const auto piece = from_cdr<StereoPiece>(message.data);
  if (!piece) {
    ++damaged_;
    return {};
  }
  ++pieces_.came;
  stream_time_ = std::max(stream_time_, RobotTime{std::min<std::int64_t>(message.log_ns, kLatestLog)});
  auto pair = stream_.take(*piece, stream_time_);
  if (!pair) return {};
  ++pieces_.pairs;
  pair->frame.coding = kJpegCoding;
  pair->frame.left.data = encode_jpeg(pair->picture.left, kQuality);
  pair->frame.right.data = encode_jpeg(pair->picture.right, kQuality);
  return take(kFrames, to_cdr(pair->frame), message);
}

std::vector<Playback::Message> Playback::take(std::size_t topic, std::span<const std::uint8_t> cdr,
                                              const McapMessage& message) {
  std::vector<Message> out;
  const PlayedType& type = played_types()[topic];
  if (!type.learn(time_, cdr)) {
    ++damaged_;
    return out;
  }
  const bool kept = type.topic.delivery == Delivery::kept;
  if (!begin_ns_) begin_ns_ = std::min(message.log_ns, INT64_MAX - options_.from.count()) + options_.from.count();
  if (!began_ && message.log_ns < *begin_ns_) {
    if (kept) kept_[topic].assign(cdr.begin(), cdr.end());
    return out;
  }
  const RobotTime due = time_.due(message.log_ns, message.publish_ns, kept);
  began_ = true;
  for (const auto& [old, last] : std::exchange(kept_, {}))
    if (old != topic) out.push_back(moved(old, last, due));
  out.push_back(moved(topic, cdr, due));
  return out;
}

}  // namespace foresight::link
