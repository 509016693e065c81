#include "link/messages/message_types.hpp"

#include <fmt/core.h>

#include <algorithm>

#include "link/messages/cdr.hpp"

namespace foresight::link {
namespace {

constexpr std::size_t kShown = 16;  // of a sequence

/// Fields as YAML, about as `ros2 topic echo` shows them.
class FieldText {
 public:
  template <typename T>
  FieldText& operator()(const char* name, const T& value) {
    text_ += std::string(2 * depth_, ' ') + name + ":";
    add(value);
    return *this;
  }
  std::string take() { return std::move(text_); }

 private:
  template <std::integral T>
  void add(T value) {
    text_ += " " + plain(value) + "\n";
  }
  void add(double value) { text_ += " " + plain(value) + "\n"; }
  void add(const std::string& value) { text_ += " " + plain(value) + "\n"; }
  template <typename T>
  void add(const std::vector<T>& values) {
    add_all<T>(values);
  }
  template <typename T, std::size_t N>
  void add(const std::array<T, N>& values) {
    add_all<T>(values);
  }
  template <detail::Message T>
  void add(const T& message) {
    text_ += "\n";
    ++depth_;
    T::visit(message, *this);
    --depth_;
  }

  template <typename T>
  void add_all(std::span<const T> values) {
    const std::size_t shown = std::min(values.size(), kShown);
    const std::string rest = values.size() > shown ? fmt::format("{} more", values.size() - shown) : "";
    if constexpr (detail::Message<T>) {
      text_ += values.empty() ? " []\n" : "\n";
      for (const T& value : values.first(shown)) {
        text_ += std::string(2 * depth_, ' ') + "-";
        add(value);
      }
      if (!rest.empty()) text_ += std::string(2 * depth_, ' ') + "# " + rest + "\n";
    } else {
      text_ += " [";
      for (std::size_t i = 0; i < shown; ++i) text_ += (i ? ", " : "") + plain(values[i]);
      text_ += (rest.empty() ? "" : ", ... " + rest) + "]\n";
    }
  }

  static std::string plain(const std::string& text) { return "'" + text + "'"; }
  static std::string plain(double value) { return fmt::format("{}", value); }
  static std::string plain(bool value) { return value ? "true" : "false"; }
  template <std::integral T>
  static std::string plain(T value) {
    return std::to_string(value);
  }

  std::string text_;
  std::size_t depth_ = 0;
};

template <typename T>
MessageType::Reading read(std::span<const std::uint8_t> cdr, bool with_text) {
  const auto message = from_cdr<T>(cdr);
  if (!message) return {fmt::format("{} bytes are no {}", cdr.size(), ros_name(T::kType)), {}, ""};
  MessageType::Reading out{objection(*message), {}, ""};
  if constexpr (requires { message->header.stamp; }) out.stamp_unix_ns = unix_ns(message->header.stamp);
  if (with_text && out.objection.empty()) {
    FieldText text;
    T::visit(*message, text);
    out.text = text.take();
  }
  return out;
}

template <typename T>
bool round_trips(std::span<const std::uint8_t> cdr) {
  const auto message = from_cdr<T>(cdr);
  if (!message) return false;
  const Bytes again = to_cdr(*message);
  const auto twice = from_cdr<T>(again);
  return twice && to_cdr(*twice) == again;
}

template <typename... T>
constexpr std::array<MessageType, sizeof...(T)> table() {
  return {MessageType{T::kType, read<T>, round_trips<T>}...};
}
constexpr auto kTypes =
    table<JointStateMessage, TFMessage, PoseStamped, Twist, ImageMessage, CompressedImage, CameraInfoMessage,
          JointTrajectory, DiagnosticArray, StereoFrame, StereoPiece, StereoReport, GateMotion, RobotState>();

}  // namespace

std::span<const MessageType> message_types() {
  return kTypes;
}

const MessageType* find_message_type(std::string_view name) {
  const auto found = std::ranges::find_if(kTypes, [&](const MessageType& type) { return type.name == name; });
  return found == kTypes.end() ? nullptr : &*found;
}

std::string ros_name(std::string_view dds_type) {
  std::string out;
  for (std::size_t i = 0; i < dds_type.size(); ++i) {
    if (dds_type.substr(i).starts_with("::")) {
      out += '/';
      ++i;
    } else {
      out += dds_type[i];
    }
  }
  const std::size_t mark = out.find("/dds_/");
  if (mark == out.npos || !out.ends_with('_')) return std::string(dds_type);
  out.erase(mark, 5);
  out.pop_back();
  return out;
}

}  // namespace foresight::link
