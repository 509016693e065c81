#include "link/messages/checks.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "common/text.hpp"
#include "link/messages/cdr.hpp"

namespace foresight::link {

std::string text_objection(const std::string& text, std::size_t most) {
  if (text.size() > most) return fmt::format("has {} characters", text.size());
  const auto control = [](char c) { return static_cast<unsigned char>(c) < ' ' && c != '\n' && c != '\t'; };
  if (std::ranges::any_of(text, control) || text.find('\x7f') != text.npos)
    return "has control characters: " + in_quotes(text);
  return "";
}

namespace {

/// Walks through all fields of any message and keeps the first objection.
class FieldCheck {
 public:
  template <typename T>
  FieldCheck& operator()(const char* name, const T& value) {
    if (!objection_.empty()) return *this;
    const std::size_t before = path_.size();
    if (!path_.empty()) path_ += '.';
    path_ += name;
    check(value);
    path_.resize(before);
    return *this;
  }
  std::string take() { return std::move(objection_); }

 private:
  void object(const std::string& what) { objection_ = path_ + " " + what; }

  template <std::integral T>
  void check(T) {}
  void check(double value) {
    if (!std::isfinite(value)) object(fmt::format("is {}", value));
  }
  void check(const std::string& text) {
    if (const std::string wrong = text_objection(text, kMostText); !wrong.empty()) object(wrong);
  }
  void check(const std::vector<std::uint8_t>& bytes) {
    if (bytes.size() > kMostImageBytes) object(fmt::format("has {} bytes", bytes.size()));
  }
  template <typename T>
  void check(const std::vector<T>& values) {
    each(values);
  }
  template <typename T, std::size_t N>
  void check(const std::array<T, N>& values) {
    each(values);
  }
  void each(const auto& values) {
    const std::size_t before = path_.size();
    for (std::size_t i = 0; i < values.size() && objection_.empty(); ++i) {
      path_ += fmt::format("[{}]", i);
      check(values[i]);
      path_.resize(before);
    }
  }
  void check(const RosTime& time) { check_nanoseconds(time.nanosec); }
  void check(const RosDuration& duration) { check_nanoseconds(duration.nanosec); }
  void check_nanoseconds(std::uint32_t nanosec) {
    if (nanosec >= 1'000'000'000) object(fmt::format("has {} nanoseconds in a second", nanosec));
  }
  void check(const Quaternion& q) {
    const double length = std::sqrt(q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    if (!(std::abs(length - 1) <= 1e-3)) object(fmt::format("has the length {}, not 1", length));
  }
  template <detail::Message T>
  void check(const T& message) {
    T::visit(message, *this);
  }

  std::string path_, objection_;
};

template <typename T>
std::string of_fields(const T& message) {
  FieldCheck check;
  T::visit(message, check);
  return check.take();
}

/// The first of these that says anything.
template <typename First, typename... Others>
std::string first_of(First&& first, Others&&... others) {
  std::string out = first();
  if constexpr (sizeof...(others) > 0)
    if (out.empty()) return first_of(std::forward<Others>(others)...);
  return out;
}

std::string of_count(const char* field, std::size_t count, std::size_t wanted) {
  return count == 0 || count == wanted ? "" : fmt::format("{} has {} values for {} joints", field, count, wanted);
}

std::string of_names(const char* field, const std::vector<std::string>& names, const Expected& expected) {
  std::set<std::string> seen;
  for (const std::string& name : names) {
    if (!seen.insert(name).second) return std::string(field) + " has " + in_quotes(name) + " twice";
    if (!expected.joints.empty() && std::ranges::find(expected.joints, name) == expected.joints.end())
      return std::string(field) + " has " + in_quotes(name) + ", which the rig has not; " +
             did_you_mean(name, expected.joints);
  }
  return "";
}

std::string of_instant(const char* field, std::int64_t ns, const Expected& expected) {
  if (!expected.writer_now_ns || ns <= *expected.writer_now_ns) return "";
  return fmt::format("{} lies {:.3g} s in the future", field, 1e-9 * static_cast<double>(ns - *expected.writer_now_ns));
}

std::string of_size(const char* field, std::uint32_t width, std::uint32_t height) {
  if (width == 0 || height == 0 || width > kMostPixels || height > kMostPixels)
    return fmt::format("{} is {} x {} px", field, width, height);
  return "";
}

std::string of_packet(const char* field, std::size_t bytes, std::size_t least) {
  return bytes < least || bytes > kMostPieceBytes ? fmt::format("{} has {} bytes", field, bytes) : "";
}

std::string of_image(const char* side, const CodedImage& image, bool with_data, const Expected& expected,
                     std::size_t at) {
  if (image.data.empty() == with_data) return std::string(side) + (with_data ? ".data is empty" : ".data is not empty");
  if (image.uncertainty_ns < 0) return std::string(side) + ".uncertainty_ns is negative";
  if (std::string size = of_size(side, image.width, image.height); !size.empty()) return size;
  if (expected.image_sizes) {
    const auto& sizes = *expected.image_sizes;
    if (image.width != sizes[at] || image.height != sizes[at + 1])
      return fmt::format("{} is {} x {} px, but its lens was calibrated at {} x {} px", side, image.width, image.height,
                         sizes[at], sizes[at + 1]);
  }
  return of_instant(side, image.capture_ns, expected);
}

}  // namespace

std::string objection(const JointStateMessage& m, const Expected& expected) {
  return first_of([&] { return of_fields(m); }, [&] { return of_names("name", m.name, expected); },
                  [&] { return of_count("position", m.position.size(), m.name.size()); },
                  [&] { return of_count("velocity", m.velocity.size(), m.name.size()); },
                  [&] { return of_count("effort", m.effort.size(), m.name.size()); });
}

std::string objection(const TFMessage& m, const Expected&) {
  std::string out = of_fields(m);
  for (std::size_t i = 0; i < m.transforms.size() && out.empty(); ++i)
    if (m.transforms[i].child_frame_id.empty() || m.transforms[i].child_frame_id == m.transforms[i].header.frame_id)
      out = fmt::format("transforms[{}] leads from {} to {}", i, in_quotes(m.transforms[i].header.frame_id),
                        in_quotes(m.transforms[i].child_frame_id));
  return out;
}

std::string objection(const PoseStamped& m, const Expected&) {
  return of_fields(m);
}

std::string objection(const Twist& m, const Expected&) {
  return of_fields(m);
}

std::string objection(const ImageMessage& m, const Expected&) {
  return first_of([&] { return of_fields(m); }, [&] { return of_size("image", m.width, m.height); },
                  [&]() -> std::string {
                    const std::uint64_t needed = std::uint64_t{m.step} * m.height;
                    if (m.step >= m.width && m.data.size() == needed) return "";
                    return fmt::format("data has {} bytes, where {} rows of {} are wanted", m.data.size(), m.height,
                                       m.step);
                  });
}

std::string objection(const CompressedImage& m, const Expected&) {
  const std::string out = of_fields(m);
  return out.empty() && m.data.empty() ? "data is empty" : out;
}

std::string objection(const CameraInfoMessage& m, const Expected&) {
  return first_of([&] { return of_fields(m); }, [&] { return of_size("image", m.width, m.height); },
                  [&]() -> std::string { return m.d.size() > 14 ? fmt::format("d has {} values", m.d.size()) : ""; });
}

std::string objection(const JointTrajectory& m, const Expected& expected) {
  return first_of([&] { return of_fields(m); }, [&] { return of_names("joint_names", m.joint_names, expected); },
                  [&] {
                    std::string out;
                    for (std::size_t i = 0; i < m.points.size() && out.empty(); ++i) {
                      const JointTrajectoryPoint& p = m.points[i];
                      for (const auto* values : {&p.positions, &p.velocities, &p.accelerations, &p.effort})
                        if (out.empty())
                          out = of_count(fmt::format("points[{}]", i).c_str(), values->size(), m.joint_names.size());
                    }
                    return out;
                  });
}

std::string objection(const DiagnosticArray& m, const Expected&) {
  std::string out = of_fields(m);
  for (std::size_t i = 0; i < m.status.size() && out.empty(); ++i)
    if (m.status[i].level > DiagnosticStatus::kStale) out = fmt::format("status[{}].level is {}", i, m.status[i].level);
  return out;
}

std::string objection(const StereoFrame& m, const Expected& expected) {
  std::vector<std::string> names;
  for (const JointSample& joint : m.joints) names.push_back(joint.name);
  return first_of([&] { return of_fields(m); }, [&] { return of_names("joints", names, expected); },
                  [&]() -> std::string {
                    const bool known = std::ranges::all_of(
                        m.joints, [](const JointSample& j) { return j.status <= JointSample::kNeverKnown; });
                    if (m.joints_status > 3 || !known) return "joints have a status that there is not";
                    if (m.coding != kJpegCoding && m.coding != kH264Coding) return "coding is " + in_quotes(m.coding);
                    return m.number == 0 ? "number is 0" : "";
                  },
                  [&] { return of_image("left", m.left, m.coding == kJpegCoding, expected, 0); },
                  [&] { return of_image("right", m.right, m.coding == kJpegCoding, expected, 2); });
}

std::string objection(const StereoPiece& m, const Expected&) {
  if (m.stream == 0) return "stream is 0";
  return of_packet("data", m.data.size(), 1);
}

std::string objection(const StereoReport& m, const Expected&) {
  return of_packet("acknowledgement", m.acknowledgement.size(), 0);
}

std::string objection(const GateMotion& m, const Expected& expected) {
  return first_of([&] { return of_fields(m); }, [&] { return of_instant("time_ns", m.time_ns, expected); },
                  [&]() -> std::string {
                    if (m.doing > 4) return fmt::format("doing is {}", m.doing);
                    if (m.speed < 0 || m.speed > 1) return fmt::format("speed is {}", m.speed);
                    return expected.joints.empty() ? "" : of_count("joints", m.joints.size(), expected.joints.size());
                  });
}

std::string objection(const RobotState& m, const Expected& expected) {
  std::vector<std::string> names;
  for (const DriveLine& drive : m.drives) names.push_back(drive.name);
  return first_of(
      [&] { return of_fields(m); }, [&] { return of_names("drives", names, expected); },
      [&] { return of_instant("time_ns", m.time_ns, expected); },
      [&]() -> std::string { return m.speed < 0 || m.speed > 1 ? fmt::format("speed is {}", m.speed) : ""; });
}

}  // namespace foresight::link
