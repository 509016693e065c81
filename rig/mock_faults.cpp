#include "rig/mock_faults.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

using sim::DriveFault;

struct Kind {
  const char* name;
  DriveFault fault;
  const char* words;
};
constexpr std::array<Kind, 5> kKinds{{
    {"stuck", DriveFault::jam, "its shaft is held fast"},
    {"following_error", DriveFault::tow_error, "its drive finds that the shaft lags too far behind"},
    {"lost_node", DriveFault::unplugged, "its drive is off the bus"},
    {"noisy_encoder", DriveFault::noisy, "its drive tells positions that are off at random"},
    {"lost_power", DriveFault::no_power, "its drive has no power"},
}};
constexpr double kNoise = 3;  // times the following error that the gate allows

const Kind* kind_of(std::string_view name) {
  const auto found = std::ranges::find_if(kKinds, [&](const Kind& kind) { return kind.name == name; });
  return found == kKinds.end() ? nullptr : &*found;
}

template <typename Range, typename Name>
std::string listed(const Range& range, Name&& name) {
  std::string out;
  for (const auto& one : range) out += (out.empty() ? "" : ", ") + std::string(name(one));
  return out;
}

MockFault parse(const std::string& text, const Rig& rig, bool all_mock) {
  const std::string where = "--fault " + in_quotes(text);
  const std::size_t at = text.rfind('@'), colon = text.rfind(':', at);
  if (at == std::string::npos || colon == std::string::npos)
    throw InputError(where, "is not JOINT:KIND@TIME",
                     "write it such as " + rig.joints.front().drive.name + ":stuck@3.5");
  MockFault out;
  const std::string joint = text.substr(0, colon);
  const auto found = std::ranges::find_if(rig.joints, [&](const RigJoint& j) { return j.drive.name == joint; });
  if (found == rig.joints.end())
    throw InputError(where, "the rig has no joint " + in_quotes(joint),
                     "it has " + listed(rig.joints, [](const RigJoint& j) { return j.drive.name; }));
  out.joint = static_cast<std::size_t>(found - rig.joints.begin());
  const RigBus& bus = rig.buses[found->bus];
  if (!all_mock && bus.interface != "mock")
    throw InputError(where, "the drive of " + in_quotes(joint) + " is a real one, on " + bus.interface,
                     "add --mock: only mock drives fail on request");
  out.kind = text.substr(colon + 1, at - colon - 1);
  if (kind_of(out.kind) == nullptr)
    throw InputError(where, "there is no fault " + in_quotes(out.kind),
                     "use " + listed(kKinds, [](const Kind& kind) { return kind.name; }));
  const auto time = parse_number(text.substr(at + 1));
  if (!time || !std::isfinite(*time) || *time < 0)
    throw InputError(where, in_quotes(text.substr(at + 1)) + " is no time",
                     "give seconds after the start, such as 3.5");
  out.time_s = *time;
  return out;
}

}  // namespace

std::vector<MockFault> parse_mock_faults(const std::vector<std::string>& texts, const Rig& rig, bool all_mock) {
  std::vector<MockFault> out;
  for (const std::string& text : texts) out.push_back(parse(text, rig, all_mock));
  return out;
}

MockFaults::MockFaults(std::vector<MockFault> faults, const Rig& rig, const RobotDevices& devices)
    : waiting_(std::move(faults)), rig_(rig), devices_(devices) {
  std::ranges::stable_sort(waiting_, std::greater{}, &MockFault::time_s);
}

std::vector<std::string> MockFaults::step(RobotTime now) {
  if (start_.ns == 0) start_ = now;
  std::vector<std::string> said;
  for (; !waiting_.empty() && to_seconds(now - start_) >= waiting_.back().time_s; waiting_.pop_back()) {
    const MockFault& fault = waiting_.back();
    const RigJoint& joint = rig_.joints[fault.joint];
    const Kind& kind = *kind_of(fault.kind);
    sim::DriveRack* const rack = devices_.rack(joint.bus);
    rack->inject(rack->find(joint.drive.name).value(), kind.fault, kNoise * joint.following_error);
    said.push_back(
        fmt::format("{:.2f} s: fault {} of {}: {}", to_seconds(now - start_), kind.name, joint.drive.name, kind.words));
  }
  return said;
}

std::vector<std::string> MockFaults::missed() const {
  std::vector<std::string> out;
  for (const MockFault& fault : waiting_)
    out.push_back(fmt::format("fault {} of {} at {:.2f} s did not happen: the session ended before", fault.kind,
                              rig_.joints[fault.joint].drive.name, fault.time_s));
  return out;
}

}  // namespace foresight
