#include "input/open_tracker.hpp"

#include <filesystem>

#include "common/error.hpp"
#include "common/text.hpp"
#include "input/gamepad.hpp"
#include "input/recorded_tracker.hpp"
#include "input/space_mouse.hpp"

namespace foresight {
namespace {

constexpr std::string_view kGamepad = "gamepad";
constexpr const char* kSpaceMouse = "spacemouse";
constexpr long long kMostGamepads = 16;

bool is_gamepad(const std::string& device) {
  return device == kGamepad || device.starts_with("gamepad:");
}

std::size_t gamepad_index(const std::string& device) {
  if (device == kGamepad) return 0;
  const auto index = parse_integer(std::string_view(device).substr(kGamepad.size() + 1));
  if (!index || *index < 0 || *index >= kMostGamepads)
    throw InputError(in_quotes(device), "is no gamepad", "count from gamepad:0 on; see `foresight input list`");
  return static_cast<std::size_t>(*index);
}

// A name without a folder or an ending was hardly meant as a file.
void require_recording(const std::string& device) {
  if (std::filesystem::exists(device)) return;
  const std::string devices[] = {std::string(kGamepad), kSpaceMouse};
  const std::string list = "`foresight input list` says which devices are there";
  if (device.find_first_of("/.") != std::string::npos)
    throw InputError(in_quotes(device), "no such file", "put the recording there or correct the name; " + list);
  const std::string question = question_of_near(device, devices);
  throw InputError(in_quotes(device), "is no device, and no file", question + (question.empty() ? "" : " ") + list);
}

}  // namespace

bool is_recording(const std::string& device) {
  return !is_gamepad(device) && device != kSpaceMouse && device != "keyboard";
}

std::unique_ptr<Tracker> open_tracker(const std::string& device, const TrackerTraceOptions& options) {
  if (is_gamepad(device)) return std::make_unique<Gamepad>(gamepad_index(device));
  if (device == kSpaceMouse) return std::make_unique<SpaceMouse>();
  if (device == "keyboard")
    throw InputError("keyboard", "speaks to a window alone", "name a gamepad, spacemouse, or a recording");
  require_recording(device);
  return std::make_unique<RecordedTracker>(read_tracker_trace(device, options));
}

std::vector<std::pair<std::string, std::string>> keys_of(const std::string& device) {
  if (is_gamepad(device)) return Gamepad::keys();
  if (device == kSpaceMouse) return SpaceMouse::keys();
  return {};
}

}  // namespace foresight
