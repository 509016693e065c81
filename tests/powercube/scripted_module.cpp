#include "scripted_module.hpp"

#include <algorithm>

namespace foresight::powercube {
namespace {

using namespace std::chrono_literals;

std::map<Param, double> defaults(int id) {
  return {{Param::def_min_pos, -2},
          {Param::def_max_pos, 2},
          {Param::def_max_vel, 3},
          {Param::def_max_acc, 5},
          {Param::def_home_vel, -0.2},
          {Param::def_cube_serial, 1000.0 + id},
          {Param::def_cube_version, 0x3512},
          {Param::config, kConfigNoAnswers | 0x11},
          {Param::min_pos, -2},
          {Param::max_pos, 2},
          {Param::max_vel, 3},
          {Param::max_acc, 5},
          {Param::target_vel, 0.1},
          {Param::target_acc, 0.1},
          {Param::act_vel, 0}};
}

}  // namespace

ScriptedModule::ScriptedModule(InProcessBus& bus, SteppedClock& clock, int id)
    : values(defaults(id)), bus_(bus.attach()), id_(id) {
  clock.every(1ms, [this](RobotTime now) { cycle(now); });
}

void ScriptedModule::lose_power() {
  values = defaults(id_);
  state = kHalted;
  ramp_target_.reset();
  fed_ = {-1};
}

void ScriptedModule::cycle(RobotTime now) {
  while (const auto frame = bus_->receive(0ns))
    if (!silent) hear(decode(*frame), now);
  const bool watched = (static_cast<std::uint32_t>(values[Param::config]) & kConfigWatchdog) != 0 && fed_.ns >= 0;
  if (watched && now - fed_ > 50ms) state |= kHalted;
  if ((state & kHalted) != 0) ramp_target_.reset();
  if (ramp_target_) {
    const double step = velocity * 1e-3;
    position += std::clamp(*ramp_target_ - position, -step, step);
  }
  if ((state & kInProgress) != 0 && now >= home_end_ && !never_ends_homing) {
    state = (state & ~(kInProgress | kMotion)) | kHomeOk;
    position = 0;
  }
}

void ScriptedModule::hear(const Message& m, RobotTime now) {
  using Kind = Message::Kind;
  if (m.kind == Kind::broadcast && m.code == static_cast<std::uint8_t>(Command::watchdog_refresh)) {
    refreshes.push_back(now);
    fed_ = now;
  }
  if (m.module != id_) return;
  const Param param{m.code};
  if (m.kind == Kind::get) tell(param);
  if (m.kind == Kind::set && !read_only.contains(param)) values[param] = m.value;
  if (m.kind == Kind::order) order(Command{m.code}, now);
  if (m.kind == Kind::motion) move(m);
}

void ScriptedModule::order(Command what, RobotTime now) {
  if (what == Command::reset) {
    ++resets;
    if (!deaf_to_reset) state &= kHomeOk;
  } else if (what == Command::halt) {
    ++halts;
    state = (state | kHalted) & ~(kMotion | kInProgress);
  } else if (what == Command::home && (state & (kHalted | kError)) == 0) {
    ++homes;
    state = (state & ~kHomeOk) | kInProgress | kMotion;
    home_end_ = now + homing_takes;
    CanFrame out = command(id_, Command::home);
    out.id = kAnswerId + static_cast<std::uint32_t>(id_);
    out.data[1] = kAccepted;
    out.size = 2;
    bus_->send(out);
  }
}

void ScriptedModule::move(const Message& m) {
  const bool ramp = Motion{m.code} == Motion::framp_ack;
  (ramp ? ramps : steps).push_back(m.value);
  const bool ok = (state & kHomeOk) != 0 && (state & (kHalted | kError)) == 0;
  if (ok && ramp) ramp_target_ = m.value;
  if (ok && !ramp) position = m.value;
  CanFrame out = motion(id_, Motion::framp_ack, position);
  out.id = kAnswerId + static_cast<std::uint32_t>(id_);
  out.data[1] = m.code;
  out.data[6] = ok ? 0 : kShortNotOk;
  out.size = 8;
  bus_->send(out);
}

void ScriptedModule::tell(Param param) {
  double value = values[param];
  if (param == Param::cube_state) value = state;
  if (param == Param::act_pos) value = position;
  CanFrame out = set_param(id_, param, value);
  out.id = kAnswerId + static_cast<std::uint32_t>(id_);
  out.data[0] = static_cast<std::uint8_t>(Command::get_extended);
  bus_->send(out);
}

}  // namespace foresight::powercube
