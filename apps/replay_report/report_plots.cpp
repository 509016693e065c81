#include "apps/replay_report/report_plots.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <initializer_list>

#include "apps/replay_report/contact_sheet.hpp"
#include "common/svg_plot.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

constexpr double kMiB = 1024.0 * 1024.0;

using Value = std::function<double(const FrameRecord&)>;

// The run in columns of equal numbers of frames.
class Columns {
 public:
  explicit Columns(const std::vector<FrameRecord>& frames)
      : frames_(frames), count_(std::min(frames.size(), kPlotColumns)) {
    const double start = frames.empty() ? 0 : frames.front().time_s;
    time_ = means([start](const FrameRecord& f) { return f.time_s - start; });
  }

  const std::vector<double>& time() const { return time_; }
  std::size_t size() const { return count_; }
  SvgPlot::Range span() const { return count_ ? SvgPlot::Range{time_.front(), time_.back()} : SvgPlot::Range{}; }

  // Mean of the finite values of each column, NaN where there is none.
  std::vector<double> means(const Value& value) const {
    std::vector<double> out(count_, kNaN);
    for (std::size_t c = 0; c < count_; ++c) {
      std::vector<double> in_column;
      for (std::size_t i = c * frames_.size() / count_; i < (c + 1) * frames_.size() / count_; ++i)
        in_column.push_back(value(frames_[i]));
      out[c] = statistic_of(std::move(in_column)).mean;
    }
    return out;
  }

 private:
  const std::vector<FrameRecord>& frames_;
  std::size_t count_;
  std::vector<double> time_;
};

double largest(std::initializer_list<std::vector<double>> lists) {
  double most = kNaN;
  for (const auto& list : lists)
    for (const double v : list) most = std::fmax(most, v);
  return most;
}

double least(std::initializer_list<std::vector<double>> lists) {
  double low = kNaN;
  for (const auto& list : lists)
    for (const double v : list) low = std::fmin(low, v);
  return low;
}

struct Key {
  std::string css_class, text;
};

std::string legend(const std::vector<Key>& keys) {
  std::string out = "<div class=\"legend\">";
  for (const Key& key : keys)
    out += "<span><i class=\"" + key.css_class + "\"></i>" + escape_html(key.text) + "</span>";
  return out + "</div>";
}

ReportPlot quality_plot(const Columns& columns, const std::string& title, const std::string& unit, int digits,
                        const std::function<std::optional<double>(const ImageQuality&)>& measure) {
  const auto of = [&](ImageQuality FrameRecord::*which) {
    return columns.means([&](const FrameRecord& f) { return f.dropped ? kNaN : measure(f.*which).value_or(kNaN); });
  };
  const auto predicted = of(&FrameRecord::predicted), delayed = of(&FrameRecord::delayed);
  const double low = least({predicted, delayed}), high = largest({predicted, delayed});
  const double pad = std::isfinite(high - low) ? 0.12 * (high - low) : 0;
  SvgPlot plot(title, columns.span(), {low - pad, high + pad}, "s", unit);
  plot.line(columns.time(), delayed, "s-delayed", "delayed");
  plot.line(columns.time(), predicted, "s-predicted", "predicted");
  const SvgPlot::Series series[] = {{"predicted", predicted}, {"delayed", delayed}};
  plot.readout(columns.time(), series, digits, unit);
  return {title, legend({{"s-predicted", "predicted view"}, {"s-delayed", "delayed image"}}) + plot.str(), plot.data()};
}

ReportPlot coverage_plot(const Columns& columns) {
  struct Layer {
    Key key;
    double Coverage::*share;
  };
  const Layer layers[] = {{{"c-seen", "seen by a camera"}, &Coverage::seen},
                          {{"c-filled", "filled hole"}, &Coverage::filled},
                          {{"c-uncoloured", "model without colour"}, &Coverage::uncoloured},
                          {{"c-none", "no model"}, &Coverage::no_model}};
  SvgPlot plot("Coverage", columns.span(), {0, 100}, "s", "% of the image");
  std::vector<double> low(columns.size(), 0), high = low;
  std::vector<Key> keys;
  std::vector<SvgPlot::Series> series;
  for (const Layer& layer : layers) {
    const auto shares =
        columns.means([&](const FrameRecord& f) { return f.dropped ? kNaN : 100 * f.coverage.*layer.share; });
    for (std::size_t i = 0; i < shares.size(); ++i) high[i] = low[i] + shares[i];
    plot.area(columns.time(), low, high, layer.key.css_class, layer.key.text);
    low = high;
    keys.push_back(layer.key);
    series.push_back({layer.key.text, shares});
  }
  plot.readout(columns.time(), series, 1, "%");
  return {"What the predicted view is made of", legend(keys) + plot.str(), plot.data()};
}

ReportPlot stage_plot(const Columns& columns, const Summary& summary) {
  std::vector<Key> keys;
  std::vector<std::vector<double>> stages;
  std::vector<SvgPlot::Series> series;
  for (const StageSummary& stage : summary.stages) {
    if (stage.part != StagePart::texture) continue;
    stages.push_back(columns.means([&](const FrameRecord& f) {
      if (f.stages.empty()) return kNaN;
      double ms = 0;
      for (const StageTime& s : f.stages) ms += s.name == stage.name ? s.cpu_ms : 0;
      return ms;
    }));
    keys.push_back({"k" + std::to_string(keys.size() % 8), stage.name});
    series.push_back({stage.name, stages.back()});
  }
  std::vector<double> base(columns.size(), 0), totals = base;
  for (const auto& stage : stages)
    for (std::size_t i = 0; i < stage.size(); ++i) totals[i] += stage[i];
  const SvgPlot::Range span = columns.span();
  const double step = columns.size() > 1 ? (span.max - span.min) / static_cast<double>(columns.size() - 1) : 1;
  SvgPlot plot("CPU time per image and stage", {span.min - step / 2, span.max + step / 2},
               {0, 1.08 * std::fmax(1e-3, largest({totals}))}, "s", "ms of one core");
  for (std::size_t s = 0; s < stages.size(); ++s)
    for (std::size_t i = 0; i < columns.size(); ++i) {
      if (!std::isfinite(stages[s][i])) continue;
      const double middle = columns.time()[i];
      plot.bar({middle - 0.42 * step, middle + 0.42 * step}, {base[i], base[i] + stages[s][i]}, keys[s].css_class,
               keys[s].text);
      base[i] += stages[s][i];
    }
  plot.readout(columns.time(), series, 1, "ms");
  return {"CPU time per image, image to texture", legend(keys) + plot.str(), plot.data()};
}

ReportPlot latency_plot(const RunRecord& run, const Summary& summary) {
  constexpr int kBins = 36;
  const Statistic& all = summary.arrival_to_publish_ms;
  const double high = std::isfinite(all.max) ? 1.04 * std::max(all.max, 1e-3) : 1;
  std::vector<double> counts(kBins, 0);
  for (const FrameRecord& f : run.frames) {
    const double ms = f.dropped ? kNaN : f.arrival_to_publish_ms.value_or(kNaN);
    if (std::isfinite(ms)) counts[static_cast<std::size_t>(std::clamp(ms / high, 0.0, 0.999) * kBins)] += 1;
  }
  SvgPlot plot("Arrival to publish", {0, high}, {0, std::max(1.0, 1.12 * largest({counts}))}, "ms", "images");
  for (int i = 0; i < kBins; ++i) {
    const double from = high * i / kBins;
    plot.bar({from + 0.06 * high / kBins, from + 0.94 * high / kBins}, {0, counts[static_cast<std::size_t>(i)]},
             "s-predicted", "images");
  }
  plot.mark_x(all.median, "p50 " + readable(all.median, 1, " ms"), "m-strong");
  // Where the two texts would overlap, the tail matters less than a readable plot.
  if (all.p99 - all.median > 0.02 * high) plot.mark_x(all.p99, "p99 " + readable(all.p99, 1, " ms"), "m-strong");
  return {"From an image's arrival to its textures", legend({{"s-predicted", "images"}}) + plot.str(), plot.data()};
}

ReportPlot memory_plot(const Columns& columns, const Summary& summary) {
  const auto used =
      columns.means([](const FrameRecord& f) { return static_cast<double>(f.texture_bytes_used) / kMiB; });
  const double budget = static_cast<double>(summary.texture_bytes_budget) / kMiB, most = largest({used});
  // A budget far away would press the curve onto the axis.
  const bool near = budget < 4 * most;
  SvgPlot plot("Texture memory", columns.span(), {0, 1.15 * std::fmax(near ? budget : 0, std::fmax(most, 1e-3))}, "s",
               "MiB");
  plot.area(columns.time(), std::vector<double>(used.size(), 0), used, "a-soft", "in use");
  plot.line(columns.time(), used, "s-predicted", "in use");
  if (near && budget > 0) plot.mark_y(budget, "budget " + readable(budget, 0, " MiB"), "m-strong");
  const SvgPlot::Series series[] = {{"used", used}};
  plot.readout(columns.time(), series, 1, "MiB");
  const std::string title = "Texture memory" + (near ? "" : " (budget " + readable(budget, 0, " MiB)"));
  return {title, legend({{"s-predicted", "in use, both generations"}}) + plot.str(), plot.data()};
}

ReportPlot gain_plot(const Columns& columns) {
  const auto gain = columns.means([](const FrameRecord& f) { return f.gain; });
  const double low = std::fmin(0.9, least({gain})), high = std::fmax(1.1, largest({gain}));
  SvgPlot plot("Exposure gain", columns.span(), {low - 0.02, high + 0.02}, "s", "factor, linear light");
  plot.line(columns.time(), gain, "s-predicted", "gain");
  const SvgPlot::Series series[] = {{"gain", gain}};
  plot.readout(columns.time(), series, 3, "");
  return {"Exposure gain of the newest image", legend({{"s-predicted", "gain"}}) + plot.str(), plot.data()};
}

}  // namespace

std::vector<ReportPlot> plots_of(const RunRecord& run, const Summary& summary) {
  const Columns columns(run.frames);
  return {quality_plot(columns, "Likeness to the actual image", "dB", 1, [](const auto& q) { return q.psnr_db; }),
          coverage_plot(columns),
          quality_plot(columns, "Structural similarity", "SSIM", 3, [](const auto& q) { return q.ssim; }),
          quality_plot(columns, "Sharpness relative to the actual image", "1 = as sharp", 2,
                       [](const auto& q) { return q.sharpness; }),
          stage_plot(columns, summary),
          latency_plot(run, summary),
          memory_plot(columns, summary),
          gain_plot(columns)};
}

}  // namespace foresight
