#include <fmt/chrono.h>
#include <fmt/core.h>

#include <array>
#include <iostream>

#include "apps/can_jobs.hpp"
#include "apps/can_words.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

constexpr std::size_t kErrorsShown = 12;

double since(Duration time, Duration begin) {
  return to_seconds(time - begin);
}

/// What a log is about.
struct Summary {
  std::optional<Duration> first, last;  // the least and the largest: received frames keep the instant of their arrival,
                                        // and may stand behind ones that were sent later
  long long frames = 0, unknown = 0, errors = 0;
  std::map<std::string, std::map<std::string, long long>> kinds;  // by interface
  std::map<std::string, std::map<int, long long>> nodes;
  struct Trouble {
    std::optional<Duration> time;
    std::string text;
  };
  std::vector<Trouble> first_errors;

  void add(const CanLogEntry& entry, const ExplainedFrame& frame) {
    if (entry.time) {
      first = std::min(first.value_or(*entry.time), *entry.time);
      last = std::max(last.value_or(*entry.time), *entry.time);
    }
    ++frames;
    ++kinds[entry.interface][frame.kind];
    if (frame.node) ++nodes[entry.interface][*frame.node];
    if (frame.unknown) ++unknown;
    if (!frame.trouble) return;
    ++errors;
    if (first_errors.size() < kErrorsShown) first_errors.push_back({entry.time, entry.interface + " " + frame.text});
  }
  Duration begin() const { return first.value_or(Duration{0}); }
};

std::string begin_text(Duration begin) {
  const auto s = begin.count() / 1'000'000'000;
  constexpr long long kYear2000 = 946'684'800;
  const std::string seconds = fmt::format("{}.{:06d}", s, begin.count() / 1000 % 1'000'000);
  return s < kYear2000 ? seconds : fmt::format("{} ({:%Y-%m-%d %H:%M:%S} UTC)", seconds, fmt::gmtime(std::time_t{s}));
}

void print(const Summary& summary, const std::filesystem::path& file, const LogWords& words) {
  std::cout << "# " << file.string() << ": " << summary.frames << " frames";
  if (summary.first)
    std::cout << fmt::format(" in {:.6f} s, the first at {}", since(*summary.last, *summary.first),
                             begin_text(*summary.first));
  std::cout << "\n";
  for (const auto& [interface, kinds] : summary.kinds) {
    std::cout << "# " << interface << ":";
    const char* between = " ";
    for (const auto& [kind, count] : kinds) std::cout << std::exchange(between, ", ") << count << " " << kind;
    std::cout << "\n";
    const auto nodes = summary.nodes.find(interface);
    if (nodes == summary.nodes.end()) continue;
    std::cout << "#   nodes:";
    between = " ";
    for (const auto& [node, count] : nodes->second)
      std::cout << std::exchange(between, ", ") << words.node_name(interface, node) << " " << count;
    std::cout << "\n";
  }
  std::cout << "# " << summary.errors << " errors, " << summary.unknown << " frames unknown\n";
  for (const auto& [time, text] : summary.first_errors)
    std::cout << fmt::format("#   {:.6f} s {}\n", since(time.value_or(summary.begin()), summary.begin()), text);
  if (summary.errors > static_cast<long long>(kErrorsShown)) std::cout << "#   and more: --errors shows all\n";
}

bool is_wanted(const CanExplainOptions& options, const ExplainedFrame& frame, double time) {
  return (!options.node || frame.node == options.node) && (!options.errors || frame.trouble || frame.unknown) &&
         time >= options.from.value_or(time) && time <= options.to.value_or(time);
}

/// A line of the log, its time as it is or since `begin`.
std::string line_text(const CanLogEntry& entry, const std::optional<Duration>& begin) {
  std::array<char, kLongestLogLine> line;
  const Duration time = entry.time.value_or(Duration{0});
  const std::size_t length = write_log_line(time, entry.interface, entry.frame, entry.sent, line);
  const std::string text(line.data(), length - 1);
  return begin ? fmt::format("({:.6f}){}", entry.time ? since(time, *begin) : 0.0, text.substr(text.find(')') + 1))
               : text;
}

}  // namespace

int explain_can(const CanExplainOptions& options) {
  if (options.from && options.to && *options.from > *options.to)
    throw InputError("--from", "lies behind --to", "exchange them");
  Summary summary;
  {
    LogWords words(options);
    CandumpReader log(options.file);
    while (const auto entry = log.next()) summary.add(*entry, words.explain(*entry));
    print(summary, options.file, words);
  }
  LogWords words(options);  // anew: a frame means what was set up before it
  CandumpReader log(options.file);
  while (const auto entry = std::cout ? log.next() : std::nullopt) {
    const ExplainedFrame frame = words.explain(*entry);
    if (!is_wanted(options, frame, since(entry->time.value_or(summary.begin()), summary.begin()))) continue;
    std::cout << line_text(*entry, options.absolute ? std::nullopt : std::optional(summary.begin())) << "  "
              << frame.text << '\n';
  }
  std::cout << summary.frames << " frames, " << summary.unknown << " unknown\n";
  return summary.unknown == 0 ? 0 : 1;
}

}  // namespace foresight
