#include "link/control_wire/control_wire.hpp"

#include <cmath>

#include "link/messages/checks.hpp"

namespace foresight {

// The fields of each message, in order; the codec finds them beside the messages.
template <typename Self, typename Type>
concept OneOf = std::same_as<std::remove_const_t<Self>, Type>;

template <OneOf<Identity> Self, typename V>
void visit_fields(Self& m, V& v) {
  v("protocol", m.protocol)("program", m.program)("name", m.name)("urdf", m.urdf)("rig", m.rig)(
      "calibration", m.calibration)("joints", m.joints)("scene", m.scene);
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

// Each says what cannot be meant by what it is given, in words; "" where nothing is.

std::string wrong_text(const std::string& what, const std::string& text) {
  const std::string wrong = text_objection(text, kMostWords);
  return wrong.empty() ? "" : what + " " + wrong;
}
std::string wrong_identity(const Identity& identity) {
  if (identity.joints.size() > kMostNames) return std::to_string(identity.joints.size()) + " joints";
  std::string wrong = wrong_text("program", identity.program) + wrong_text("name", identity.name);
  for (std::size_t i = 0; i < identity.joints.size() && wrong.empty(); ++i)
    wrong = wrong_text("joints[" + std::to_string(i) + "]", identity.joints[i]);
  return wrong;
}
std::string wrong_positions(const LinePositions& positions, std::size_t joints) {
  if (joints > kMostLineJoints) return std::to_string(joints) + " joints";
  for (std::size_t i = 0; i < joints; ++i)
    if (!std::isfinite(positions[i])) return "position[" + std::to_string(i) + "] is " + std::to_string(positions[i]);
  return "";
}
template <typename Enumeration>
std::string wrong_value(const char* what, Enumeration value, Enumeration last) {
  return value <= last ? "" : std::string("there is no ") + what + " " + std::to_string(static_cast<unsigned>(value));
}

/// One overload for each message that can say what cannot be meant.
struct Objection {
  std::string operator()(const auto&) const { return ""; }
  std::string operator()(const Hello& m) const { return wrong_identity(m.identity); }
  std::string operator()(const SetPoint& m) const { return wrong_positions(m.position, m.joints); }
  std::string operator()(const Request& m) const { return wrong_value("request", m.what, LineRequest::emergency_stop); }
  std::string operator()(const Welcome& m) const {
    std::string wrong = wrong_identity(m.identity);
    if (m.differences.size() > kMostNames) wrong = std::to_string(m.differences.size()) + " differences";
    for (std::size_t i = 0; i < m.differences.size() && wrong.empty(); ++i)
      wrong = wrong_text("words", m.differences[i].words) + wrong_text("cure", m.differences[i].cure);
    return wrong;
  }
  std::string operator()(const LeaseVerdict& m) const { return wrong_text("words", m.words); }
  std::string operator()(const Answer& m) const {
    return wrong_value("outcome", m.outcome, RequestOutcome::before_stop);
  }
  std::string operator()(const ControlState& m) const {
    if (m.joints > kMostLineJoints) return std::to_string(m.joints) + " joints";
    return wrong_value("cause", m.cause, RestCause::robot_stopped) +
           wrong_value("fault", m.fault, SetPointFault::robot_is_busy) + wrong_text("holder_name", m.holder_name) +
           wrong_text("asking_name", m.asking_name);
  }
};

/// Of a Hello or Welcome of another version of the protocol, whatever else that has: who it is. Nothing where it is
/// none.
template <typename T>
std::optional<T> greeting_of_another_version(std::span<const std::uint8_t> bytes) {
  T out;
  std::variant_alternative_t<0, decltype(T::body)> greeting;
  static_assert(OneOf<decltype(greeting), Hello> || OneOf<decltype(greeting), Welcome>);
  std::int32_t which = -1;
  CdrReader reader(bytes);
  reader("from", out.from)("to", out.to)("which", which);
  if constexpr (OneOf<decltype(greeting), Welcome>) reader("robot", greeting.robot);
  Identity& who = greeting.identity;
  reader("protocol", who.protocol)("program", who.program)("name", who.name);
  if (!reader.ok() || which != 0 || who.protocol == kLineProtocol) return std::nullopt;
  out.body = std::move(greeting);
  return out;
}

template <typename T>
std::optional<T> sound(std::span<const std::uint8_t> bytes, std::string* why) {
  auto out = greeting_of_another_version<T>(bytes);
  if (!out) out = from_cdr<T>(bytes);
  const std::string wrong = out ? std::visit(Objection{}, out->body) : "bytes are no such message";
  if (wrong.empty()) return out;
  if (why) *why = wrong;
  return std::nullopt;
}

}  // namespace

std::vector<std::uint8_t> to_bytes(const FromOperator& message) {
  return to_cdr(message);
}
std::vector<std::uint8_t> to_bytes(const FromRobot& message) {
  return to_cdr(message);
}
std::optional<FromOperator> from_operator(std::span<const std::uint8_t> bytes, std::string* why) {
  return sound<FromOperator>(bytes, why);
}
std::optional<FromRobot> from_robot(std::span<const std::uint8_t> bytes, std::string* why) {
  return sound<FromRobot>(bytes, why);
}

}  // namespace link
}  // namespace foresight
