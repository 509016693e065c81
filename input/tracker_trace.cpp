#include "input/tracker_trace.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "common/error.hpp"
#include "input/room_axes.hpp"
#include "input/trace_columns.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPedalGap = 100ms;  // rows are missing for longer: the switch was let go of
constexpr Duration kPedalRow = 50ms;
constexpr Duration kHeldAfter = 200ms;
constexpr int kMostPedalRows = 200;
constexpr double kHalf = 0.5;  // of a trigger

constexpr std::array kButtons{TrackerButton::deadman,       TrackerButton::clutch,     TrackerButton::gripper_open,
                              TrackerButton::gripper_close, TrackerButton::home_view,  TrackerButton::recentre,
                              TrackerButton::joint_mode,    TrackerButton::next_joint, TrackerButton::previous_joint,
                              TrackerButton::to_start};
static_assert(kButtons.size() == kTrackerButtons);

constexpr const char* kHead = "head_";

void hold_switch(TrackerState& state, bool held) {
  state.buttons.set(TrackerButton::deadman, held);
  state.buttons.set(TrackerButton::clutch, held);
}

TrackerState own_row(const TraceColumns& columns, const TextRow& row) {
  TrackerState out;
  out.connected = columns.flag(row, "connected");
  out.tracked = columns.flag(row, "tracked");
  out.integrated = columns.flag(row, "integrated");
  if (out.tracked) out.T_space_hand = columns.pose(row, "");
  if (std::isfinite(columns.number_or_nan(row, "head_x"))) out.T_space_head = columns.pose(row, kHead);
  for (const TrackerButton button : kButtons)
    if (columns.has(to_string(button))) out.buttons.set(button, columns.flag(row, to_string(button)));
  if (const double grip = columns.number_or_nan(row, "grip"); std::isfinite(grip)) out.grip = grip;
  const double joint = columns.number_or_nan(row, "joint");
  if (joint >= 0 && joint < 1000) out.joint = static_cast<std::size_t>(joint);
  out.joint_rate = columns.number(row, "joint_rate");
  out.pan_rate = columns.number(row, "pan_rate");
  out.tilt_rate = columns.number(row, "tilt_rate");
  return out;
}

constexpr double kTipOpen = 100, kTipClosed = 30;

TrackerState tip_row(const TraceColumns& columns, const TextRow& row) {
  TrackerState out;
  out.connected = out.tracked = true;
  out.T_space_hand = columns.pose(row, "");
  out.grip = std::clamp((kTipOpen - columns.number(row, "gripper")) / (kTipOpen - kTipClosed), 0.0, 1.0);
  hold_switch(out, true);
  return out;
}

TrackerState controller_row(const TraceColumns& columns, const TextRow& row, const std::string& side) {
  TrackerState out;
  out.connected = true;
  out.tracked = columns.flag(row, side + "valid");
  out.T_space_head = from_room_axes(columns.pose(row, kHead));
  if (!out.tracked) return out;
  out.T_space_hand = from_room_axes(columns.pose(row, side + "grip_"));
  hold_switch(out, columns.number(row, side + "squeeze") > kHalf);
  out.grip = std::clamp(columns.number(row, side + "trigger"), 0.0, 1.0);
  const auto pressed = static_cast<std::int64_t>(std::clamp(columns.number(row, side + "pressed"), 0.0, 65535.0));
  out.buttons.set(TrackerButton::joint_mode, (pressed & 8) != 0);
  out.buttons.set(TrackerButton::home_view, (pressed & 16) != 0);
  out.buttons.set(TrackerButton::recentre, (pressed & 32) != 0);
  out.joint_rate = std::clamp(-columns.number(row, side + "stick_y"), -1.0, 1.0);
  out.pan_rate = std::clamp(-columns.number(row, side + "stick_x"), -1.0, 1.0);
  out.tilt_rate = out.joint_rate;
  return out;
}

TrackerState hand_row(const TraceColumns& columns, const TextRow& row, const std::string& side) {
  constexpr double kPinched = 0.02, kOpen = 0.08;  // m
  TrackerState out;
  out.connected = true;
  out.tracked = columns.flag(row, side + "valid");
  out.T_space_head = from_room_axes(columns.pose(row, kHead));
  if (!out.tracked) return out;
  out.T_space_hand = from_room_axes(columns.pose(row, side + "wrist_"));
  Eigen::Vector3d apart;
  for (int i = 0; i < 3; ++i) {
    const std::string axis(1, static_cast<char>('x' + i));
    apart[i] = columns.number(row, side + "thumb_tip_" + axis) - columns.number(row, side + "index_tip_" + axis);
  }
  out.grip = std::clamp((kOpen - apart.norm()) / (kOpen - kPinched), 0.0, 1.0);
  return out;
}

// One of the forms: how a row of it is read.
struct Form {
  std::string what;
  std::function<TrackerState(const TraceColumns&, const TextRow&)> read;
  bool pedal = false;  // it has rows only while the switch is held
  struct Gripper {
    std::string column;  // whose numbers may be beyond the ends; "": none
    double open = 0, closed = 1;
  } gripper = {};
};

Form form_of(const TraceColumns& columns, const TextRow& heading, TrackerSide side) {
  const bool left = side == TrackerSide::left;
  const std::string prefix = left ? "L_" : "R_", word = left ? ", left" : ", right";
  const bool timed = columns.has("time_s"), posed = columns.has_all({"x", "y", "z", "qx", "qy", "qz", "qw"});
  const bool head = columns.has_all({"head_x", "head_y", "head_z", "head_qx", "head_qy", "head_qz", "head_qw"});
  const auto has = [&](const std::string& part) {
    return std::ranges::all_of(std::array{"x", "y", "z", "qx", "qy", "qz", "qw"},
                               [&](const char* axis) { return columns.has(prefix + part + axis); });
  };
  const bool buttons = std::ranges::all_of(kButtons, [&](TrackerButton b) {
    return b == TrackerButton::to_start || columns.has(to_string(b));  // which older recordings lack
  });
  if (timed && posed && head && buttons &&
      columns.has_all({"connected", "tracked", "integrated", "grip", "joint", "joint_rate", "pan_rate", "tilt_rate"}))
    return {"a device", own_row};
  if (timed && head && has("grip_") &&
      columns.has_all({"L_valid", "R_valid", "L_trigger", "L_squeeze", "L_stick_x", "L_stick_y", "L_pressed",
                       "R_trigger", "R_squeeze", "R_stick_x", "R_stick_y", "R_pressed"}))
    return {"tracked controllers" + word,
            [prefix](const TraceColumns& c, const TextRow& row) { return controller_row(c, row, prefix); },
            false,
            {prefix + "trigger"}};
  const auto tips = [&](const std::string& axis) {
    return columns.has(prefix + "thumb_tip_" + axis) && columns.has(prefix + "index_tip_" + axis);
  };
  if (timed && head && has("wrist_") && columns.has(prefix + "valid") && tips("x") && tips("y") && tips("z"))
    return {"tracked hands" + word,
            [prefix](const TraceColumns& c, const TextRow& row) { return hand_row(c, row, prefix); }};
  if (timed && posed && columns.has("gripper"))
    return {"the tip of a tool", tip_row, true, {"gripper", kTipOpen, kTipClosed}};
  throw InputError(
      heading.where(), "is not the heading of a recording of a device",
      "name columns: time_s,x,y,z,qx,qy,qz,qw,gripper, or those that `foresight input show --record` writes");
}

// The open switch before the begin, and while the pedal was up.
void add_open(TrackerTrace& trace, Duration until) {
  TrackerTrace::Row open = trace.rows.back();
  hold_switch(open.state, false);
  for (int i = 0; i < kMostPedalRows && open.time + kPedalRow < until; ++i) {
    trace.rows.push_back(open);
    open.time += kPedalRow;
  }
}

// Ours, not the recording's: whoever wears no switch holds none while nobody sees the hand.
void hold_where_tracked(TrackerTrace& trace) {
  std::optional<Duration> since, before;
  for (TrackerTrace::Row& row : trace.rows) {
    if (!row.state.tracked || (before && row.time - *before > kHeldAfter)) since.reset();
    if (row.state.tracked && !since) since = row.time;
    hold_switch(row.state, since && row.time - *since >= kHeldAfter);
    before = row.time;
  }
}

// Reads the rows below the heading.
class Reading {
 public:
  Reading(TrackerTrace& trace, TrackerSide side) : trace_(trace), side_(side) {}

  void visit(const TextRow& row) {
    if (!form_) {
      columns_ = TraceColumns(row);
      form_ = form_of(columns_, row, side_);
      trace_.what = form_->what;
      trace_.beyond = {form_->gripper.column, form_->gripper.open, form_->gripper.closed};
      return;
    }
    const Duration stamp = columns_.seconds_since(row, "time_s");
    if (!first_) first_ = stamp - (form_->pedal ? 2 * kPedalRow : Duration{0});
    const Duration time = stamp - *first_;
    if (!trace_.rows.empty() && time < trace_.rows.back().time)
      throw InputError(row.where(), "time_s goes back", "sort the rows by time");
    TrackerTrace::Row next{time, form_->read(columns_, row)};
    if (next.state.grip) look_at_gripper(row);
    if (form_->pedal) let_go(next);
    trace_.rows.push_back(next);
    if (trace_.rows.size() > kMostTraceRows)
      throw InputError(row.where(), "has more than " + std::to_string(kMostTraceRows) + " rows", "cut the recording");
  }

 private:
  void look_at_gripper(const TextRow& row) {
    TrackerTrace::Beyond& beyond = trace_.beyond;
    if (beyond.column.empty()) return;
    const double value = columns_.number(row, beyond.column);
    const auto [least, most] = std::minmax(beyond.open, beyond.closed);
    beyond.least = beyond.of == 0 ? value : std::min(beyond.least, value);
    beyond.most = beyond.of == 0 ? value : std::max(beyond.most, value);
    beyond.rows += value < least || value > most;
    ++beyond.of;
  }
  void let_go(const TrackerTrace::Row& next) {
    if (trace_.rows.empty()) {
      trace_.rows.push_back({Duration{0}, next.state});
      hold_switch(trace_.rows.back().state, false);
    } else if (next.time - trace_.rows.back().time > kPedalGap) {
      add_open(trace_, next.time);
    }
  }

  TrackerTrace& trace_;
  TrackerSide side_;
  TraceColumns columns_;
  std::optional<Form> form_;
  std::optional<Duration> first_;
};

}  // namespace

TrackerTrace read_tracker_trace(const std::filesystem::path& file, const TrackerTraceOptions& options) {
  TrackerTrace trace;
  Reading reading(trace, options.side);
  for_each_row(file, {RowForm::Between::commas}, [&](const TextRow& row) { reading.visit(row); });
  if (trace.rows.empty())
    throw InputError(file.string(), "has no rows of a recorded device", "give a recording with a heading and rows");
  if (options.hold_switch) hold_where_tracked(trace);
  return trace;
}

std::string trace_heading() {
  std::string out = "time_s,connected,tracked,integrated,x,y,z,qx,qy,qz,qw";
  for (const char* axis : {"x", "y", "z", "qx", "qy", "qz", "qw"}) out += std::string(",") + kHead + axis;
  for (const TrackerButton button : kButtons) out += std::string(",") + to_string(button);
  return out + ",grip,joint,joint_rate,pan_rate,tilt_rate\n";
}

std::string trace_row(Duration time, const TrackerState& state) {
  const auto flag = [](bool value) { return value ? 1 : 0; };
  const auto pose = [](const Pose& T) {
    const Eigen::Vector3d& p = T.translation();
    const Eigen::Quaterniond q(T.linear());
    return fmt::format("{},{},{},{},{},{},{}", p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
  };
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  std::string out = fmt::format("{:.9f},{},{},{},", to_seconds(time), flag(state.connected), flag(state.tracked),
                                flag(state.integrated));
  out += pose(state.tracked ? state.T_space_hand : Pose::Identity()) + ',';
  out += state.T_space_head ? pose(*state.T_space_head) : "nan,nan,nan,nan,nan,nan,nan";
  for (const TrackerButton button : kButtons) out += state.buttons.held(button) ? ",1" : ",0";
  out += fmt::format(",{},{},{},{},{}\n", state.grip.value_or(kNone),
                     state.joint ? static_cast<double>(*state.joint) : kNone, state.joint_rate, state.pan_rate,
                     state.tilt_rate);
  return out;
}

}  // namespace foresight
