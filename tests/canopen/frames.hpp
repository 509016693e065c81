// Frames in tests: made, kept and read from lines of text.
#pragma once

#include <fmt/core.h>

#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/can/can_bus.hpp"

namespace foresight::canopen {

inline CanFrame frame(std::uint32_t id, std::initializer_list<std::uint8_t> bytes = {}) {
  CanFrame out;
  out.id = id;
  for (std::uint8_t b : bytes) out.data[out.size++] = b;
  return out;
}

/// "583#4B41600018028FAF"; the text is right.
inline CanFrame frame(std::string_view text) {
  CanFrame out;
  const std::size_t hash = text.find('#');
  out.id = static_cast<std::uint32_t>(std::stoul(std::string(text.substr(0, hash)), nullptr, 16));
  for (std::size_t i = hash + 1; i + 1 < text.size(); i += 2)
    out.data[out.size++] = static_cast<std::uint8_t>(std::stoul(std::string(text.substr(i, 2)), nullptr, 16));
  return out;
}

inline std::string to_text(const CanFrame& f) {
  std::string out = fmt::format("{:03X}#", f.id);
  for (std::uint8_t b : f.payload()) out += fmt::format("{:02X}", b);
  return out;
}

/// Keeps what is sent; hears nothing.
class KeepingBus final : public CanBus {
 public:
  const std::string& name() const noexcept override { return name_; }
  CanSend send(const CanFrame& f) noexcept override {
    sent.push_back(to_text(f));
    return CanSend::sent;
  }
  std::optional<CanFrame> receive(Duration) noexcept override { return std::nullopt; }
  CanBusState state() const noexcept override { return CanBusState::active; }
  CanCounters counters() const noexcept override { return {}; }
  std::vector<std::string> sent;

 private:
  std::string name_ = "kept";
};

}  // namespace foresight::canopen
