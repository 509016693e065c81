#include "link/control_wire/control_wire.hpp"

#include <algorithm>
#include <cmath>

#include "link/messages/cdr.hpp"

namespace foresight {

// The fields of each message, in order; the codec finds them beside the messages.
template <typename Self, typename Type>
concept OneOf = std::same_as<std::remove_const_t<Self>, Type>;

template <OneOf<Identity> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("protocol", m.protocol)("program", m.program)("name", m.name)("urdf", m.urdf)("rig", m.rig)(
      "calibration", m.calibration)("joints", m.joints);
}
template <OneOf<Difference> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("words", m.words)("cure", m.cure)("refuses", m.refuses);
}
template <OneOf<ClockPing> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("number", m.number);
}
template <OneOf<ClockPong> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("number", m.number)("received_ns", m.received_ns)("answered_ns", m.answered_ns);
}
template <OneOf<Hello> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("identity", m.identity);
}
template <OneOf<Ask> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("number", m.number);
}
template <OneOf<GiveBack> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("number", m.number);
}
template <OneOf<HandOver> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("lease", m.lease)("to", m.to);
}
template <OneOf<SetPoint> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("lease", m.lease)("consent", m.consent)("sequence", m.sequence)("given", m.given)("lasts", m.lasts)(
      "deadman", m.deadman)("joints", m.joints)("position", m.position);
}
template <OneOf<Request> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("id", m.id)("what", m.what)("lease", m.lease)("consent", m.consent)("given", m.given)("lasts", m.lasts);
}
template <OneOf<Welcome> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("robot", m.robot)("identity", m.identity)("differences", m.differences);
}
template <OneOf<LeaseVerdict> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("number", m.number)("lease", m.lease)("words", m.words);
}
template <OneOf<Answer> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("id", m.id)("outcome", m.outcome);
}
template <OneOf<ControlState> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("sequence", m.sequence)("time", m.time)("holder", m.holder)("asking", m.asking)("holder_name", m.holder_name)(
      "asking_name", m.asking_name)("consent", m.consent)("cause", m.cause)("fault", m.fault)("life", m.life)(
      "delay", m.delay)("delay_doubt", m.delay_doubt)("ready", m.ready)("joints", m.joints)("measured", m.measured)(
      "set_point", m.set_point)("begin", m.begin);
}
template <typename Self, typename V>
requires OneOf<Self, FromOperator> || OneOf<Self, FromRobot>
void visit_fields(Self& m, V& v) {
  v("from", m.from)("to", m.to)("body", m.body);
}

namespace link {
namespace {

constexpr std::size_t kMostNames = kMostLineJoints, kMostWords = 1000;

bool is_short(const std::string& text) {
  return text.size() <= kMostWords;
}
bool is_sound(const Identity& identity) {
  return identity.joints.size() <= kMostNames && std::ranges::all_of(identity.joints, is_short) &&
         is_short(identity.program) && is_short(identity.name);
}
bool are_finite(const LinePositions& positions, std::size_t joints) {
  return joints <= kMostLineJoints &&
         std::all_of(positions.begin(), positions.begin() + static_cast<std::ptrdiff_t>(joints),
                     [](double position) { return std::isfinite(position); });
}

/// One overload for each message that can say what cannot be meant.
struct Sound {
  bool operator()(const auto&) const { return true; }
  bool operator()(const Hello& m) const { return is_sound(m.identity); }
  bool operator()(const SetPoint& m) const { return are_finite(m.position, m.joints); }
  bool operator()(const Request& m) const { return m.what <= LineRequest::emergency_stop; }
  bool operator()(const Welcome& m) const {
    return is_sound(m.identity) && m.differences.size() <= kMostNames &&
           std::ranges::all_of(m.differences,
                               [](const Difference& d) { return is_short(d.words) && is_short(d.cure); });
  }
  bool operator()(const LeaseVerdict& m) const { return is_short(m.words); }
  bool operator()(const Answer& m) const { return m.outcome <= RequestOutcome::before_stop; }
  bool operator()(const ControlState& m) const {
    return m.joints <= kMostLineJoints && m.cause <= RestCause::robot_stopped &&
           m.fault <= SetPointFault::robot_is_busy && is_short(m.holder_name) && is_short(m.asking_name);
  }
};

template <typename T>
std::optional<T> sound(std::span<const std::uint8_t> bytes) {
  auto out = from_cdr<T>(bytes);
  if (out && !std::visit(Sound{}, out->body)) out.reset();
  return out;
}

}  // namespace

std::vector<std::uint8_t> to_bytes(const FromOperator& message) {
  return to_cdr(message);
}
std::vector<std::uint8_t> to_bytes(const FromRobot& message) {
  return to_cdr(message);
}
std::optional<FromOperator> from_operator(std::span<const std::uint8_t> bytes) {
  return sound<FromOperator>(bytes);
}
std::optional<FromRobot> from_robot(std::span<const std::uint8_t> bytes) {
  return sound<FromRobot>(bytes);
}

}  // namespace link
}  // namespace foresight
