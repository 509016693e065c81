#include "apps/link_jobs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <set>
#include <tuple>

#include "common/error.hpp"
#include "common/statistics.hpp"
#include "common/stop_signal.hpp"
#include "common/text.hpp"
#include "link/dds/endpoints.hpp"
#include "link/dds/pretended_line.hpp"
#include "link/dds/topic_watch.hpp"
#include "link/dds/topics.hpp"
#include "link/messages/message_types.hpp"
#include "rig/rig.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kPollEvery = 100ms;
constexpr Duration kDiscovery = 3s;  // another vendor's program may need a second
constexpr int kReaderRoom = 256;     // samples that a reader of ours may be behind, so that none goes uncounted

unsigned long long number(std::uint64_t n) {
  return n;
}

/// Null without --line. `clock` must outlive it.
std::shared_ptr<link::PretendedLine> line_of(const LinkPlace& place, const Clock& clock) {
  if (place.line.empty()) return nullptr;
  auto out =
      std::make_shared<link::PretendedLine>(read_line_spec(place.line), link::PretendedLine::Side::operating, clock);
  out->start();
  return out;
}

void warn(const std::string& trouble) {
  if (!trouble.empty()) std::fprintf(stderr, "link: %s\n", trouble.c_str());
}

/// `topic` as somebody writes it, once one does, with room for what comes in bursts; nothing after a signal. Throws
/// InputError where nobody does within kDiscovery, naming the nearest of the topics that are written.
std::optional<link::Topic> find_topic(const link::Participant& program, const std::string& topic) {
  MonotonicClock clock;
  const RobotTime end = clock.now() + kDiscovery;
  std::set<std::string> written;
  while (clock.now() < end && !stop_requested()) {
    for (const link::Peer& peer : program.peers())
      for (const link::Peer::Endpoint& endpoint : peer.endpoints) {
        if (!endpoint.writes) continue;
        if (endpoint.topic == topic) return link::Topic{topic, endpoint.type, endpoint.delivery, kReaderRoom};
        written.insert(endpoint.topic);
      }
    clock.sleep_until(clock.now() + kPollEvery);
  }
  if (stop_requested()) return std::nullopt;
  const std::vector<std::string> names(written.begin(), written.end());
  throw InputError(
      topic, "nobody writes this topic",
      did_you_mean(topic, names, "nobody writes any: see `foresight link status`, and `foresight robot RIG --serve`"));
}

/// What came of one topic.
struct Measured {
  Duration taken{0};
  std::uint64_t samples = 0, bytes = 0, strange = 0;
  std::string strangeness;
  std::vector<double> ages_ms, gaps_ms;
};

/// Why joints, and the transforms that follow them, do not come, as the robot's state says it; "" where it does not.
std::string why_silent(link::Participant& program, const link::Topic& topic) {
  constexpr Duration kStateComes = 1s;  // the last one, as it is kept
  if (topic.name != link::topics::joint_states().name && topic.name != link::topics::transforms().name) return "";
  link::Reader states(program, link::topics::robot_state());
  states.wait(kStateComes);
  std::string out;
  states.take<link::RobotState>({}, [&](const link::RobotState& state, const link::Sample&) {
    if (!state.all_homed)
      out = ": where joints are that are not homed is not known; home those of " + in_quotes(state.rig) +
            " (h in its console, H at the operator's seat)";
  });
  return out;
}

/// The exit code.
int tell_nothing_came(link::Participant& program, const link::Reader& reader, const link::Topic& topic) {
  if (stop_requested()) return kStopped;
  warn("nothing came on " + topic.name +
       (reader.writers() ? ", though somebody writes it" + why_silent(program, topic) : ""));
  return 1;
}

/// Each topic once, however many writers and readers of it a program has.
std::string topics_text(std::vector<link::Peer::Endpoint> endpoints) {
  const auto key = [](const link::Peer::Endpoint& e) { return std::tie(e.topic, e.type, e.writes); };
  std::ranges::sort(endpoints, [&](const auto& a, const auto& b) { return key(a) < key(b); });
  const auto others = std::ranges::unique(endpoints, [&](const auto& a, const auto& b) { return key(a) == key(b); });
  endpoints.erase(others.begin(), others.end());
  std::string out;
  for (const link::Peer::Endpoint& endpoint : endpoints)
    out += fmt::format("  {} {} ({})\n", endpoint.writes ? "writes" : "reads ", endpoint.topic,
                       link::ros_name(endpoint.type));
  return out;
}

void measure(link::Reader& reader, const link::MessageType* type, Duration length, Measured& out) {
  MonotonicClock clock;
  std::optional<RobotTime> last;
  const RobotTime start = clock.now();
  for (const RobotTime end = start + length; clock.now() < end && !stop_requested();) {
    reader.wait(kPollEvery);
    const RobotTime now = clock.now();
    reader.take([&](const link::Sample& sample) {
      const std::int64_t unix_now =
          std::chrono::duration_cast<Duration>(std::chrono::system_clock::now().time_since_epoch()).count();
      ++out.samples;
      out.bytes += sample.cdr.size();
      std::int64_t stamp = sample.sent_unix_ns;
      if (type) {
        const auto reading = type->read(sample.cdr, false);
        if (!reading.objection.empty()) {
          ++out.strange;
          out.strangeness = reading.objection;
        }
        stamp = reading.stamp_unix_ns.value_or(stamp);
      }
      out.ages_ms.push_back(1e-6 * static_cast<double>(unix_now - stamp));
      if (last) out.gaps_ms.push_back(1e3 * to_seconds(now - *last));
      last = now;
    });
  }
  out.taken = clock.now() - start;
}

}  // namespace

LinkConfig link_config_of(const LinkPlace& place) {
  LinkConfig out = place.rig.empty() ? LinkConfig{} : read_rig(place.rig).link;
  if (place.rig.empty()) out.where = "foresight link";
  if (place.domain) out.domain = *place.domain;
  if (!place.interface.empty()) out.interface = place.interface;
  if (!place.peers.empty()) out.peers = place.peers;
  if (!place.keys.empty()) out.security = place.keys;
  return out;
}

std::string topic_on_dds(const std::string& given) {
  if (given.starts_with("rt/")) return given;
  return "rt/" + (given.starts_with("/") ? given.substr(1) : given);
}

std::string peers_text(const std::vector<link::Peer>& peers) {
  std::string out;
  for (const link::Peer& peer : peers) {
    if (peer.own) continue;
    out += fmt::format("{}{}{}\n", peer.name, peer.host.empty() ? "" : ", on " + peer.host,
                       peer.process.empty() ? "" : ", " + peer.process);
    out += topics_text(peer.endpoints);
  }
  return out;
}

std::string figures_text(const link::LineFigures& line) {
  std::string out;
  if (line.clock && line.round_trip)
    out += fmt::format("clock      the robot's is {:.6f} s ahead, +- {:.3f} ms{}; round trip {:.3f} ms\n",
                       1e-9 * static_cast<double>(line.clock->middle()), 1e-6 * static_cast<double>(line.clock->half()),
                       line.clock_jumps ? fmt::format(", {} jumps", number(line.clock_jumps)) : "",
                       1e3 * to_seconds(*line.round_trip));
  else
    out += "clock      not known: the robot's program answers no operator (as with --follow)\n";
  const link::IntakeCounts& pairs = line.pairs;
  if (pairs.pairs == 0) {
    out += fmt::format("pairs      none came{}\n", pairs.others ? ": they go to another program" : "");
  } else {
    const double intervals = static_cast<double>(pairs.pairs - 1), n = static_cast<double>(pairs.pairs);
    const double per_s = intervals > 0 ? intervals / to_seconds(line.lasted) : 0;
    out += fmt::format("pairs      {:.1f} a second ({}), {:.3f} Mbit/s\n", per_s, line.coding,
                       8e-6 * per_s * static_cast<double>(pairs.bytes) / n);
  }
  std::vector<double> ages, doubts;
  for (const BoundedDelay& age : line.ages) {
    ages.push_back(1e3 * to_seconds(age.delay));
    doubts.push_back(1e3 * to_seconds(age.uncertainty));
  }
  if (!ages.empty())
    out += fmt::format("age        p50 {:.1f} ms, p99 {:.1f} ms, from capture until it was here, +- {:.1f} ms\n",
                       quantile(ages, 0.5), quantile(ages, 0.99), quantile(doubts, 0.5));
  if (pairs.expected > 0)
    out += fmt::format("lost       {} of {} packets\n",
                       number(pairs.expected - std::min(pairs.packets, pairs.expected)), number(pairs.expected));
  else if (pairs.pairs > 0)
    out +=
        fmt::format("lost       {} of {} pairs\n", number(line.samples_lost), number(line.samples_lost + pairs.pairs));
  if (pairs.refused > 0) out += fmt::format("refused    {} pairs: {}\n", number(pairs.refused), pairs.refusal);
  if (line.refused > 0)
    out += fmt::format("refused    {} messages, the last: {}\n", number(line.refused), line.refusal);
  return out;
}

namespace {

/// Null where keys do not let us speak, which measuring clocks and asking for pictures takes.
std::unique_ptr<link::OperatorEnd> look_at_line(link::Participant& program, Clock& clock) {
  link::OperatorEndOptions options;
  options.seat.identity.program = FORESIGHT_VERSION;
  options.seat.identity.name = "link status";
  options.seat.draw = machine_nonces();
  try {
    auto end = std::make_unique<link::OperatorEnd>(program, options, clock);
    end->start();
    return end;
  } catch (const RuntimeFailure& failure) {
    warn(std::string("clock and pictures are not looked at: ") + failure.what());
    return nullptr;
  }
}

}  // namespace

int link_status(const LinkStatusOptions& options) {
  const LinkConfig config = link_config_of(options.place);
  poll_stop_signals();
  MonotonicClock clock;
  link::Participant program(config, "link status", link::Role::observer, line_of(options.place, clock));
  const auto end = look_at_line(program, clock);
  for (const RobotTime until = clock.now() + seconds(options.seconds); clock.now() < until && !stop_requested();)
    clock.sleep_until(std::min(until, clock.now() + kPollEvery));
  if (stop_requested()) return kStopped;
  const auto peers = program.peers();
  const std::size_t others = peers.empty() ? 0 : peers.size() - 1;
  std::printf("domain %d, interface %s: %zu other program%s\n", config.domain, config.interface.c_str(), others,
              others == 1 ? "" : "s");
  std::fputs(peers_text(peers).c_str(), stdout);
  const bool robot = std::ranges::any_of(peers, [](const link::Peer& peer) { return peer.name.starts_with("robot "); });
  if (robot && end) std::fputs(figures_text(end->figures()).c_str(), stdout);
  warn(link::receive_buffer_trouble());
  warn(program.trouble());
  if (!robot)
    warn(
        "no robot is there; start `foresight robot RIG --serve` with the same domain, and name each other's address "
        "under link.peers where they are on two hosts");
  return robot ? 0 : 1;
}

int link_listen(const LinkListenOptions& options) {
  poll_stop_signals();
  MonotonicClock clock;
  link::Participant program(link_config_of(options.place), "link listen", link::Role::observer,
                            line_of(options.place, clock));
  const auto topic = find_topic(program, topic_on_dds(options.topic));
  if (!topic) return kStopped;
  const link::MessageType* const type = link::find_message_type(topic->type);
  if (!type)
    throw InputError(
        topic->name,
        "has messages of the type " + in_quotes(link::ros_name(topic->type)) + ", which are not known here",
        "measure it with `foresight link rate`, or look at it with the tools of who writes it");
  link::Reader reader(program, *topic);
  const RobotTime begin = clock.now();
  std::uint64_t shown = 0, strange = 0;
  link::TopicWatch watch(topic->name, begin);
  while (!stop_requested() && (!options.count || shown < *options.count) &&
         (!options.seconds || clock.now() - begin < seconds(*options.seconds))) {
    reader.wait(kPollEvery);
    const std::size_t came = reader.take([&](const link::Sample& sample) {
      if (options.count && shown >= *options.count) return;
      const auto reading = type->read(sample.cdr, true);
      ++shown;
      if (!reading.objection.empty()) {
        ++strange;
        warn("refused: " + reading.objection);
      } else {
        std::printf("%s---\n", reading.text.c_str());
      }
    });
    std::fflush(stdout);
    warn(watch.news(reader.writers(), came, clock.now()));
  }
  if (shown == 0) return tell_nothing_came(program, reader, *topic);
  return strange > 0 ? 1 : 0;
}

int link_keys(const LinkKeysOptions& options) {
  link::make_keys(options.folder, options.days);
  std::printf("%s: authority, robot, operator, observer; they count for %d days\n", options.folder.c_str(),
              options.days);
  return 0;
}

int link_rate(const LinkRateOptions& options) {
  poll_stop_signals();
  MonotonicClock clock;
  link::Participant program(link_config_of(options.place), "link rate", link::Role::observer,
                            line_of(options.place, clock));
  const auto topic = find_topic(program, topic_on_dds(options.topic));
  if (!topic) return kStopped;
  link::Reader reader(program, *topic);
  Measured m;
  measure(reader, link::find_message_type(topic->type), seconds(options.seconds), m);
  warn(link::receive_buffer_trouble());
  if (m.samples == 0) return tell_nothing_came(program, reader, *topic);
  const double length = to_seconds(m.taken);  // shorter where it was stopped
  std::printf("%s (%s)\n", topic->name.c_str(), link::ros_name(topic->type).c_str());
  std::printf("rate       %.1f messages/s, %.3f Mbit/s\n", static_cast<double>(m.samples) / length,
              8e-6 * static_cast<double>(m.bytes) / length);
  std::printf("gap        p50 %.1f ms, p99 %.1f ms\n", quantile(m.gaps_ms, 0.5), quantile(m.gaps_ms, 0.99));
  std::printf("age        p50 %.2f ms, p99 %.2f ms\n", quantile(m.ages_ms, 0.5), quantile(m.ages_ms, 0.99));
  std::printf("lost       %llu of %llu\n", number(reader.lost()), number(reader.lost() + m.samples));
  if (m.strange) std::printf("refused    %llu: %s\n", number(m.strange), m.strangeness.c_str());
  return stop_requested() ? kStopped : 0;
}

}  // namespace foresight
