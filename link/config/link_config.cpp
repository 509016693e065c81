#include "link/config/link_config.hpp"

#include <fmt/core.h>
#include <net/if.h>

#include <algorithm>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

// RTPS counts ports from 7400 on, 250 a domain: the last one whose ports all exist.
constexpr int kLastDomain = 230;
constexpr double kMostRoundTrip_s = 2;

bool may_be_host(const std::string& text) {
  const auto fits = [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '.' || c == '-' ||
           c == ':' || c == '_';
  };
  return !text.empty() && text.size() <= 253 && std::ranges::all_of(text, fits) && text.front() != '-';
}

std::string read_interface(const YamlMap& map) {
  std::string name = map.text("interface");
  const auto fits = [](char c) {
    return c > ' ' && c < 127 && c != '/' && c != '<' && c != '>' && c != '"' && c != '&';
  };
  if (name.size() >= IFNAMSIZ || !std::ranges::all_of(name, fits))
    throw InputError(map.where("interface"), in_quotes(name) + " cannot be the name of a network interface",
                     "write it as `ip -brief link` shows it, such as lo, eth0 or wg0");
  return name;
}

std::vector<std::string> read_peers(const YamlMap& map) {
  std::vector<std::string> out = map.texts("peers");
  for (const std::string& peer : out)
    if (!may_be_host(peer))
      throw InputError(map.where("peers"), in_quotes(peer) + " is neither an address nor the name of a host",
                       "write a list such as [192.168.1.20, operator.lab]");
  return out;
}

// Hz. Whoever operates takes a robot that says nothing of itself for longer for one that is gone.
constexpr double kLeastStateRate = 1;

double read_rate(const YamlMap& map, const std::string& key, double otherwise, double most, double least = 0) {
  if (!map.has(key)) return otherwise;
  const double rate = map.positive(key);
  if (rate > most)
    throw InputError(map.where(key), fmt::format("is {:g}", rate), fmt::format("give at most {:g}", most));
  if (rate < least)
    throw InputError(map.where(key), fmt::format("is {:g}", rate), fmt::format("give at least {:g}", least));
  return rate;
}

Duration read_round_trip(const YamlMap& map) {
  const double delay = map.number("round_trip_s");
  if (delay < 0 || delay > kMostRoundTrip_s)
    throw InputError(map.where("round_trip_s"), fmt::format("is {:g}", delay),
                     fmt::format("give the line's round trip in seconds, 0 .. {:g}", kMostRoundTrip_s));
  return std::chrono::duration_cast<Duration>(std::chrono::duration<double>(delay));
}

}  // namespace

LinkConfig read_link_config(const YamlMap& map) {
  map.require_known({"domain", "interface", "peers", "joint_rate_hz", "state_rate_hz", "image_rate_hz", "coding",
                     "jpeg_quality", "round_trip_s", "security"});
  LinkConfig out;
  if (map.has("domain")) out.domain = map.integer("domain", 0, kLastDomain);
  if (map.has("interface")) out.interface = read_interface(map);
  if (map.has("peers")) out.peers = read_peers(map);
  out.joint_rate_hz = read_rate(map, "joint_rate_hz", out.joint_rate_hz, 1000);
  out.state_rate_hz = read_rate(map, "state_rate_hz", out.state_rate_hz, 100, kLeastStateRate);
  out.image_rate_hz = read_rate(map, "image_rate_hz", out.image_rate_hz, 1000);
  if (map.has("coding"))
    out.coding = map.choice<LinkCoding>("coding", {{"jpeg", LinkCoding::jpeg}, {"h264", LinkCoding::h264}});
  if (map.has("jpeg_quality")) out.jpeg_quality = map.integer("jpeg_quality", 1, 100);
  if (map.has("round_trip_s")) out.round_trip = read_round_trip(map);
  if (map.has("security")) out.security = map.file().parent_path() / map.text("security");
  return out;
}

}  // namespace foresight
