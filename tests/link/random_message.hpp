// Messages of any type with random contents that pass the checks where their meaning does not matter.
#pragma once

#include <random>

#include "link/messages/cdr.hpp"

namespace foresight::link {

class RandomFields {
 public:
  explicit RandomFields(std::mt19937& random) : random_(random) {}

  template <typename T>
  RandomFields& operator()(const char*, T& value) {
    fill(value);
    return *this;
  }

 private:
  std::size_t count() { return random_() % 4; }

  void fill(bool& value) { value = random_() % 2 == 1; }
  void fill(double& value) { value = std::uniform_real_distribution<double>(-10, 10)(random_); }
  void fill(float& value) { value = std::uniform_real_distribution<float>(-10, 10)(random_); }
  template <std::integral T>
  void fill(T& value) {
    value = static_cast<T>((std::uint64_t{random_()} << 32) | random_());
  }
  void fill(std::string& text) {
    text.clear();
    for (std::size_t n = random_() % 9; n > 0; --n) text += static_cast<char>('a' + random_() % 26);
  }
  template <typename T>
  void fill(std::vector<T>& values) {
    values.resize(count());
    for (T& value : values) fill(value);
  }
  template <typename T, std::size_t N>
  void fill(std::array<T, N>& values) {
    for (T& value : values) fill(value);
  }
  template <detail::Message T>
  void fill(T& message) {
    T::visit(message, *this);
  }

  std::mt19937& random_;
};

template <typename T>
T random_message(std::mt19937& random) {
  T out;
  RandomFields fields(random);
  T::visit(out, fields);
  return out;
}

/// Calls `visit.template operator()<T>()` for every type that this program reads.
template <typename Visit>
void each_message_type(Visit&& visit) {
  visit.template operator()<JointStateMessage>();
  visit.template operator()<TFMessage>();
  visit.template operator()<PoseStamped>();
  visit.template operator()<Twist>();
  visit.template operator()<ImageMessage>();
  visit.template operator()<CompressedImage>();
  visit.template operator()<CameraInfoMessage>();
  visit.template operator()<JointTrajectory>();
  visit.template operator()<DiagnosticArray>();
  visit.template operator()<StereoFrame>();
  visit.template operator()<StereoPiece>();
  visit.template operator()<StereoReport>();
  visit.template operator()<GateMotion>();
  visit.template operator()<RobotState>();
}

}  // namespace foresight::link
