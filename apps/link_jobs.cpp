#include "apps/link_jobs.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cstdio>
#include <set>

#include "common/clock.hpp"
#include "common/error.hpp"
#include "common/statistics.hpp"
#include "common/stop_signal.hpp"
#include "common/text.hpp"
#include "link/dds/endpoints.hpp"
#include "link/messages/message_types.hpp"
#include "rig/rig.hpp"

namespace foresight {
namespace {

using namespace std::chrono_literals;

constexpr Duration kLook = 100ms;
constexpr Duration kDiscovery = 3s;  // another vendor's program may need a second
constexpr int kRoom = 256;           // samples that a reader of ours may be behind, so that none goes uncounted

unsigned long long number(std::uint64_t n) {
  return n;
}

LinkConfig config_of(const LinkPlace& place) {
  LinkConfig out = place.rig.empty() ? LinkConfig{} : read_rig(place.rig).link;
  if (place.rig.empty()) out.where = "foresight link";
  if (place.domain) out.domain = *place.domain;
  if (!place.interface.empty()) out.interface = place.interface;
  if (!place.peers.empty()) out.peers = place.peers;
  if (!place.keys.empty()) out.security = place.keys;
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
        if (endpoint.topic == topic)
          return link::Topic{topic, endpoint.type, endpoint.kept ? link::Delivery::kept : link::Delivery::newest,
                             kRoom};
        written.insert(endpoint.topic);
      }
    clock.sleep_until(clock.now() + kLook);
  }
  if (stop_requested()) return std::nullopt;
  const std::vector<std::string> names(written.begin(), written.end());
  throw InputError(topic, "nobody writes this topic",
                   names.empty() ? "nobody writes any: see `foresight link status`, and `foresight robot RIG --serve`"
                                 : "did you mean '" + nearest_word(topic, names) + "'?");
}

/// What came of one topic.
struct Measured {
  std::uint64_t samples = 0, bytes = 0, strange = 0;
  std::string strangeness;
  std::vector<double> ages_ms, gaps_ms;
};

void measure(link::Reader& reader, const link::MessageType* type, Duration length, Measured& out) {
  MonotonicClock clock;
  std::optional<RobotTime> last;
  for (const RobotTime end = clock.now() + length; clock.now() < end && !stop_requested();) {
    reader.wait(kLook);
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
}

}  // namespace

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
    for (const link::Peer::Endpoint& endpoint : peer.endpoints)
      out += fmt::format("  {} {} ({})\n", endpoint.writes ? "writes" : "reads ", endpoint.topic,
                         link::ros_name(endpoint.type));
  }
  return out;
}

int link_status(const LinkStatusOptions& options) {
  const LinkConfig config = config_of(options.place);
  poll_stop_signals();
  const link::Participant program(config, "link status");
  MonotonicClock clock;
  for (const RobotTime end = clock.now() + seconds(options.seconds); clock.now() < end && !stop_requested();)
    clock.sleep_until(std::min(end, clock.now() + kLook));
  if (stop_requested()) return kStopped;
  const auto peers = program.peers();
  const std::size_t others = peers.empty() ? 0 : peers.size() - 1;
  std::printf("domain %d, interface %s: %zu other program%s\n", config.domain, config.interface.c_str(), others,
              others == 1 ? "" : "s");
  std::fputs(peers_text(peers).c_str(), stdout);
  warn(link::receive_buffer_trouble());
  warn(program.trouble());
  const bool robot = std::ranges::any_of(peers, [](const link::Peer& peer) { return peer.name.starts_with("robot "); });
  if (!robot)
    warn(
        "no robot is there; start `foresight robot RIG --serve` with the same domain, and name each other's address "
        "under link.peers where they are on two hosts");
  return robot ? 0 : 1;
}

int link_listen(const LinkListenOptions& options) {
  poll_stop_signals();
  link::Participant program(config_of(options.place), "link listen");
  const auto topic = find_topic(program, topic_on_dds(options.topic));
  if (!topic) return kStopped;
  const link::MessageType* const type = link::find_message_type(topic->type);
  if (!type)
    throw InputError(
        topic->name,
        "has messages of the type " + in_quotes(link::ros_name(topic->type)) + ", which are not known here",
        "measure it with `foresight link rate`, or look at it with the tools of who writes it");
  link::Reader reader(program, *topic);
  MonotonicClock clock;
  const RobotTime begin = clock.now();
  std::uint64_t shown = 0, strange = 0;
  while (!stop_requested() && (!options.count || shown < *options.count) &&
         (!options.seconds || clock.now() - begin < seconds(*options.seconds))) {
    reader.wait(kLook);
    reader.take([&](const link::Sample& sample) {
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
  }
  if (stop_requested() && shown == 0) return kStopped;
  return shown == 0 || strange > 0 ? 1 : 0;
}

int link_keys(const LinkKeysOptions& options) {
  link::make_keys(options.folder, options.days);
  std::printf("%s: authority, robot, operator, observer; they count for %d days\n", options.folder.c_str(),
              options.days);
  return 0;
}

int link_rate(const LinkRateOptions& options) {
  poll_stop_signals();
  link::Participant program(config_of(options.place), "link rate");
  const auto topic = find_topic(program, topic_on_dds(options.topic));
  if (!topic) return kStopped;
  link::Reader reader(program, *topic);
  Measured m;
  measure(reader, link::find_message_type(topic->type), seconds(options.seconds), m);
  warn(link::receive_buffer_trouble());
  if (m.samples == 0) {
    warn("nothing came on " + topic->name + (reader.writers() ? ", though somebody writes it" : ""));
    return stop_requested() ? kStopped : 1;
  }
  const double length = options.seconds;
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
