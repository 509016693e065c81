#include "link/line/line_spec.hpp"

#include <fmt/core.h>

#include <cmath>
#include <functional>

#include "common/error.hpp"
#include "common/text.hpp"
#include "scene/yaml_fields.hpp"

namespace foresight {
namespace {

constexpr double kLongest_s = 3600;
constexpr double kShortest_s = 1e-3;  // of an outage, and between two

/// A number of the mapping within a range; `otherwise` where it is absent.
double within(const YamlMap& map, const std::string& key, double least, double most, double otherwise) {
  if (!map.has(key)) return otherwise;
  const double value = map.number(key);
  require(value >= least && value <= most, map.where(key), fmt::format("it is {}", value),
          "give a number from " + readable(least, 0) + " to " + readable(most, 0));
  return value;
}

bool flag(const YamlMap& map, const std::string& key) {
  return map.has(key) && map.choice<bool>(key, {{"true", true}, {"false", false}});
}

Outage read_outage(const YamlMap& map) {
  map.require_known({"at_s", "for_s", "every_s", "loses"});
  Outage outage;
  outage.at = seconds(within(map, "at_s", 0, 1e6, 0));
  outage.lasts = seconds(map.positive("for_s"));
  outage.every = seconds(within(map, "every_s", 0, 1e6, 0));
  outage.loses = flag(map, "loses");
  require(outage.lasts >= seconds(kShortest_s) && outage.lasts <= seconds(1e6), map.where("for_s"),
          fmt::format("it is {:g} s", map.number("for_s")), "give 0.001 to 1,000,000 s");
  require(outage.every.count() == 0 || outage.every > outage.lasts, map.where("every_s"), "the outage would never end",
          "give more than for_s");
  require(outage.every.count() == 0 || outage.every - outage.lasts >= seconds(kShortest_s), map.where("every_s"),
          "less than 1 ms is left between two outages", "give more");
  return outage;
}

void require_rate(double bytes_per_s, const std::string& where) {
  require(bytes_per_s >= kLowestRate_kbps * 125 && bytes_per_s <= kHighestRate_kbps * 125, where,
          fmt::format("the rate is {:g} kbps", bytes_per_s / 125), "give 0.001 to 1e9 kbps, or none for no limit");
}

DirectionSpec read_direction(const YamlMap& map, bool up) {
  map.require_known(
      {"trace", "delay_ms", "jitter_ms", "reorder", "loss", "burst", "duplicates", "rate_kbps", "queue_kb", "outages"});
  DirectionSpec spec;
  spec.delay = seconds(within(map, "delay_ms", 0, kLongest_s * 1e3, 0) * 1e-3);
  spec.jitter = seconds(within(map, "jitter_ms", 0, kLongest_s * 1e3, 0) * 1e-3);
  spec.reorder = flag(map, "reorder");
  spec.loss = within(map, "loss", 0, 1, 0);
  spec.burst = within(map, "burst", 1, 10'000, 1);
  spec.duplicates = within(map, "duplicates", 0, 1, 0);
  if (map.has("rate_kbps")) {
    spec.bytes_per_s = map.positive("rate_kbps") * 125;
    require_rate(spec.bytes_per_s, map.where("rate_kbps"));
  }
  if (map.has("queue_kb")) spec.queue_bytes = static_cast<std::size_t>(1000 * within(map, "queue_kb", 1, 1e9, 0));
  if (map.has("outages"))
    for (const YamlMap& outage : map.maps("outages")) spec.outages.push_back(read_outage(outage));
  if (map.has("trace")) {
    const LineTraces traces = read_line_traces(map.file().parent_path() / map.text("trace"));
    spec.trace = up || !traces.down ? traces.up : traces.down;
  }
  check(spec, map.where(""));
  return spec;
}

}  // namespace

void check(const DirectionSpec& spec, const std::string& where) {
  const auto share = [&](double value, const char* name) {
    require(std::isfinite(value) && value >= 0 && value <= 1, where, fmt::format("{} is {}", name, value),
            "give a share from 0 to 1");
  };
  share(spec.loss, "loss");
  share(spec.duplicates, "duplicates");
  require(std::isfinite(spec.burst) && spec.burst >= 1, where, fmt::format("burst is {}", spec.burst),
          "give 1 or more packets");
  require(spec.delay.count() >= 0 && spec.delay <= seconds(kLongest_s) && spec.jitter.count() >= 0 &&
              spec.jitter <= seconds(kLongest_s),
          where, "a delay is out of range", "give 0 to 3600 s");
  if (spec.bytes_per_s != 0) require_rate(spec.bytes_per_s, where);
  require(spec.loss < 1 || spec.burst == 1, where, "everything is lost, in bursts", "give a loss below 1");
  // A bottleneck is one: two rates in a row would need two queues.
  require(!spec.trace || spec.bytes_per_s == 0 || std::holds_alternative<PacketTrace>(*spec.trace), where,
          "there is a rate besides that of the trace", "leave one of them out");
}

LineSpec read_line_spec(const std::filesystem::path& file) {
  const std::string ending = file.extension().string();
  LineSpec line;
  if (ending != ".yaml" && ending != ".yml") {
    const LineTraces traces = read_line_traces(file);
    line.up.trace = traces.up;
    line.down.trace = traces.down;
    return line;
  }
  const YamlMap map = YamlMap::load(file);
  map.require_known({"seed", "up", "down"});
  if (map.has("seed")) line.seed = static_cast<std::uint64_t>(map.integer("seed", 0, 1'000'000'000));
  if (map.has("up")) line.up = read_direction(map.map("up"), true);
  if (map.has("down")) line.down = read_direction(map.map("down"), false);
  return line;
}

}  // namespace foresight
