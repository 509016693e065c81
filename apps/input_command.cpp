#include "apps/input_command.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <memory>

#include "common/atomic_file.hpp"
#include "common/clock.hpp"
#include "common/stop_signal.hpp"
#include "input/gamepad.hpp"
#include "input/open_tracker.hpp"
#include "input/recorded_tracker.hpp"
#include "input/space_mouse.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kRound = 10ms;
constexpr int kRoundsPerLine = 10;

struct InputArguments {
  std::string device, record;
  double seconds = 10;
  TrackerTraceOptions trace;
};

int list_devices() {
  fmt::print("keyboard      keyboard and mouse, in the operator's window\n");
  const std::vector<GamepadFound> pads = find_gamepads();
  for (const GamepadFound& pad : pads) {
    if (pad.known)
      fmt::print("gamepad:{}     {}\n", pad.index, pad.name);
    else
      fmt::print("-             {}: SDL does not know its buttons; set SDL_GAMECONTROLLERCONFIG\n", pad.name);
  }
  if (pads.empty())
    fmt::print("gamepad       none is there; plug one in, and see that you may read /dev/input/event*\n");
  SpaceMouse mouse;
  const TrackerState state = mouse.read({MonotonicClock().now().ns});
  fmt::print("spacemouse    {}\n",
             state.connected ? "spacenavd answers" : fmt::format("{}; {}", state.trouble, state.cure));
  fmt::print("FILE          a recording: see `foresight input show --help`\n");
  return 0;
}

std::string line_of(const TrackerState& state) {
  if (!state.connected) return fmt::format("{}; {}", state.trouble, state.cure);
  std::string out = "not tracked";
  if (state.tracked) {
    const Eigen::Vector3d p = 1e3 * state.T_space_hand.translation();
    const double turned = Eigen::AngleAxisd(state.T_space_hand.linear()).angle() * 180 / M_PI;
    out = fmt::format("forward {:8.1f}  left {:8.1f}  up {:8.1f} mm  turned {:5.1f} deg", p.x(), p.y(), p.z(), turned);
  }
  for (std::size_t i = 0; i < kTrackerButtons; ++i)
    if (const auto button = static_cast<TrackerButton>(i); state.buttons.held(button))
      out += std::string("  ") + to_string(button);
  if (state.grip) out += fmt::format("  grip {:.2f}", *state.grip);
  const auto axis = [&](const char* name, double rate) {
    if (rate != 0) out += fmt::format("  {} {:+.2f}", name, rate);
  };
  axis("joint", state.joint_rate);
  axis("pan", state.pan_rate);
  axis("tilt", state.tilt_rate);
  return out;
}

/// What was seen of a device.
struct SeenOfDevice {
  int rounds = 0, connected = 0, tracked = 0, held = 0;
  void count(const TrackerState& state) {
    ++rounds;
    connected += state.connected;
    tracked += state.connected && state.tracked;
    held += state.connected && state.buttons.held(TrackerButton::deadman);
  }
  double percent(int of) const { return rounds > 0 ? 100.0 * of / rounds : 0; }
};

void tell_beyond(const TrackerTrace::Beyond& beyond) {
  if (beyond.rows == 0) return;
  fmt::print(
      "{} of {} numbers of column {}, {:g} to {:g}, lie beyond {:g} (open) and {:g} (closed): grip shows, and a\n"
      "robot is told, the nearer end\n",
      beyond.rows, beyond.of, beyond.column, beyond.least, beyond.most, beyond.open, beyond.closed);
}

int show_device(const InputArguments& arguments) {
  poll_stop_signals();
  const std::unique_ptr<Tracker> device = open_tracker(arguments.device, arguments.trace);
  // A recording need not be waited for.
  MonotonicClock real;
  SteppedClock stepped;
  const bool recorded = is_recording(arguments.device);
  Clock& clock = recorded ? static_cast<Clock&>(stepped) : real;
  fmt::print("{}: forward, left and up since its begin, and which buttons are held\n", device->name());
  const RobotTime begin = clock.now();
  const auto* const recording = dynamic_cast<const RecordedTracker*>(device.get());
  if (recording) tell_beyond(recording->beyond());
  std::string rows = trace_heading();
  SeenOfDevice seen;
  while (!stop_requested() && clock.now() - begin < seconds(arguments.seconds)) {
    const Duration passed = clock.now() - begin;
    const TrackerState state = device->read({clock.now().ns});
    if (recording && recording->ended()) break;
    if (seen.rounds % kRoundsPerLine == 0) {
      fmt::print("{:7.2f} s  {}\n", to_seconds(passed), line_of(state));
      std::fflush(stdout);
    }
    seen.count(state);
    if (!arguments.record.empty()) rows += trace_row(passed, state);
    clock.sleep_until(clock.now() + kRound);
  }
  if (!arguments.record.empty()) write_file_atomically(arguments.record, rows);
  fmt::print("there {:.0f} %, tracked {:.0f} %, its switch held {:.0f} % of {:.1f} s\n", seen.percent(seen.connected),
             seen.percent(seen.tracked), seen.percent(seen.held), to_seconds(clock.now() - begin));
  if (stop_requested()) return kStopped;
  return seen.connected > 0 ? 0 : 1;
}

void add_show(Command& input, std::function<int()>& action) {
  auto* command = input.add_subcommand("show", "Prints what a device says");
  auto arguments = std::make_shared<InputArguments>();
  command->add_option("DEVICE", arguments->device, "gamepad, gamepad:1, spacemouse, or the file of a recording")
      ->reads()
      ->required();
  command->add_option("--seconds", arguments->seconds, "How long")->check(from_to(0.1, 3600))->capture_default_str();
  command->add_option("--record", arguments->record, "Keeps it, as a recording")
      ->writes([](const std::filesystem::path& file) -> std::vector<Output> {
        return {new_output(file, Output::Kind::file)};
      });
  command->add_choice("--side", arguments->trace.side, {{"left", TrackerSide::left}, {"right", TrackerSide::right}},
                      "Of a recording of both hands (default right)");
  command->add_flag("--hold-switch", arguments->trace.hold_switch,
                    "Of a recording: as if the switch were held wherever the hand is tracked");
  command->footer(
      "A recording is shown at once. It is a table with commas and a heading: what --record writes;\n"
      "time_s,x,y,z,qx,qy,qz,qw,gripper of a tool; or a WebXR device's controllers or hands (docs/input.md).\n\n"
      "Exit code: 1 where the device was never there.\n\nExample: foresight input show gamepad");
  command->callback([arguments, &action] { action = [arguments] { return show_device(*arguments); }; });
}

}  // namespace

void add_input_command(Command& app, std::function<int()>& action) {
  auto* input =
      app.add_subcommand("input", "Looks at what may be in the operator's hand: gamepads, 6-DOF devices, recordings");
  input->require_subcommand();
  auto* list = input->add_subcommand("list", "Which devices are there");
  list->callback([&action] { action = list_devices; });
  add_show(*input, action);
}

}  // namespace foresight
