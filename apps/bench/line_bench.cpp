#include "apps/bench/line_bench.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <numeric>

#include "apps/bench/lab_pictures.hpp"
#include "apps/command_line/picture_size.hpp"
#include "apps/replay_report/progress_bar.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/text.hpp"
#include "link/send_control/line_trial.hpp"

namespace foresight {
namespace {

cv::Size read_size(const std::string& text) {
  const auto [width, height] = size_option(text, {32, 32}, {4096, 2048});
  return {width, height};
}

LineSpec line_of(const LineBenchOptions& options) {
  LineSpec line;
  if (options.line) line = read_line_spec(*options.line);
  line.seed = options.line ? line.seed : options.seed;
  if (options.trace) {
    const LineTraces traces = read_line_traces(*options.trace);
    line.up.trace = traces.up;
    line.down.trace = traces.down;
  }
  if (options.trace_down) {
    const LineTraces traces = read_line_traces(*options.trace_down);
    line.down.trace = traces.down ? traces.down : traces.up;
  }
  if (options.line) return line;
  for (DirectionSpec* way : {&line.up, &line.down}) {
    way->delay = seconds(options.delay_ms * 1e-3);
    way->loss = options.loss;
    way->burst = options.burst;
    check(*way, "the line");
  }
  return line;
}

double nearest_rank(std::vector<double> values, double share) {
  if (values.empty()) return -1;
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  const auto place = values.begin() + static_cast<std::ptrdiff_t>(std::max<std::size_t>(rank, 1) - 1);
  std::nth_element(values.begin(), place, values.end());
  return *place;
}

double mean_or_none(const std::vector<double>& values) {
  if (values.empty()) return -1;
  return std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
}

/// Of pieces of a minute, one every half minute, the worst p95 outside of gaps; -1 where there is none of which gaps
/// leave half.
double worst_minute(const LineTrialResult& result) {
  constexpr std::size_t kMinute_ms = 60'000, kHalf_ms = kMinute_ms / 2;
  double worst = -1;
  for (std::size_t begin = 0; begin + kMinute_ms <= result.age_beyond_ms.size(); begin += kHalf_ms) {
    std::vector<double> ages;
    for (std::size_t i = begin; i < begin + kMinute_ms; ++i)
      if (!result.in_gap[i]) ages.push_back(result.age_beyond_ms[i]);
    if (ages.size() >= kHalf_ms) worst = std::max(worst, nearest_rank(ages, 0.95));
  }
  return worst;
}

LabPictures render(cv::Size size, std::size_t count) {
  ProgressBar bar("render", "pairs", count, ProgressBar::Instant::clock::now(), ProgressBar::for_stderr());
  const LabPictures pictures({.size = size, .count = count}, [&](std::size_t done, std::size_t) {
    std::fputs(bar.update(done, ProgressBar::Instant::clock::now()).c_str(), stderr);
  });
  std::fputs(bar.finish(count, ProgressBar::Instant::clock::now()).c_str(), stderr);
  return pictures;
}

nlohmann::json figures(const LineTrialResult& result, double length_s) {
  std::vector<double> outside, psnr;
  for (std::size_t i = 0; i < result.age_beyond_ms.size(); ++i)
    if (!result.in_gap[i]) outside.push_back(result.age_beyond_ms[i]);
  for (const TrialPair& pair : result.pairs) psnr.push_back(pair.psnr_db);
  const double left_out_s = 1e-3 * static_cast<double>(result.age_beyond_ms.size() - outside.size());
  return {{"age_p50_ms", nearest_rank(outside, 0.5)},
          {"age_p95_ms", nearest_rank(outside, 0.95)},
          {"age_all_p95_ms", nearest_rank(result.age_beyond_ms, 0.95)},
          {"age_worst_minute_p95_ms", worst_minute(result)},
          {"pairs_per_s", static_cast<double>(result.pairs.size()) / length_s},
          {"psnr_db", mean_or_none(psnr)},
          {"psnr_p5_db", nearest_rank(psnr, 0.05)},
          {"bytes_per_s", static_cast<double>(result.up_bytes) / length_s},
          {"down_bytes_per_s", static_cast<double>(result.down_bytes) / length_s},
          {"gaps", result.gaps.size()},
          {"gaps_s", left_out_s},
          {"worst_recovery_ms",
           result.recovery_ms.empty() ? 0 : *std::max_element(result.recovery_ms.begin(), result.recovery_ms.end())},
          {"damaged", result.damaged},
          {"early_hand_overs", result.early},
          {"packets", result.packets},
          {"packets_to_spare", result.spares},
          {"packets_sent_again", result.copies},
          {"encode_ms", nearest_rank(result.encode_ms, 0.5)},
          {"decode_ms", nearest_rank(result.decode_ms, 0.5)}};
}

}  // namespace

int bench_line(const LineBenchOptions& options) {
  const cv::Size size = read_size(options.size);
  LineTrialOptions trial{.line = line_of(options), .length = seconds(options.seconds)};
  trial.coding = options.coding == "jpeg" ? Coding::jpeg : Coding::h264;
  const LabPictures pictures = render(size, static_cast<std::size_t>(options.pictures));
  const LineTrialResult result = run_line_trial(trial, [&](RobotTime time) { return pictures.at(time); });
  const nlohmann::json all = figures(result, options.seconds);
  const auto number = [&](const char* key) { return all.at(key).get<double>(); };
  const auto figure = [&](const char* key, int digits = 0) {  // "-" for what nothing came of
    return readable(number(key) >= 0 ? number(key) : NAN, digits);
  };
  std::printf("2 x %s, %.0f s of the line, %s; ages beyond those of a packet on the idle line\n", options.size.c_str(),
              options.seconds, options.coding.c_str());
  if (result.pairs.empty()) std::printf("  no picture came\n");
  std::printf("  age p50 / p95                %8s / %s ms\n", figure("age_p50_ms").c_str(),
              figure("age_p95_ms").c_str());
  if (!result.gaps.empty())
    std::printf("    without %.1f s in which the line stood still for 1 s and more; with them, p95 is %s ms\n",
                number("gaps_s"), figure("age_all_p95_ms").c_str());
  if (number("age_worst_minute_p95_ms") >= 0)
    std::printf("    p95 of the worst minute    %8.0f ms\n", number("age_worst_minute_p95_ms"));
  std::printf("  pairs per s                  %8.1f\n", number("pairs_per_s"));
  std::printf("  PSNR of luma, mean / p5      %8s / %s dB\n", figure("psnr_db", 1).c_str(),
              figure("psnr_p5_db", 1).c_str());
  std::printf("  sent                         %8.0f kB/s up, %.1f kB/s down\n", number("bytes_per_s") * 1e-3,
              number("down_bytes_per_s") * 1e-3);
  std::printf("  gaps of 1 s and more         %8.0f, worst recovery %.0f ms after 30 kB\n", number("gaps"),
              number("worst_recovery_ms"));
  std::printf("  packets to spare, again      %8.0f, %.0f of %.0f\n", number("packets_to_spare"),
              number("packets_sent_again"), number("packets"));
  std::printf("  damaged pictures shown       %8.0f\n", number("damaged"));
  std::printf("  hand-overs too early         %8.0f\n", number("early_hand_overs"));
  std::printf("  CPU time of a pair           %8s ms to encode, %s ms to decode\n", figure("encode_ms", 1).c_str(),
              figure("decode_ms", 1).c_str());
  write_numbers(options.json, all.dump(2));
  return result.damaged > 0 || result.early > 0 || result.pairs.empty() ? 1 : 0;
}

}  // namespace foresight
