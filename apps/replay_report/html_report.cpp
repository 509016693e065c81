#include "apps/replay_report/html_report.hpp"

#include <cmath>
#include <map>
#include <stdexcept>
#include <string_view>

#include "apps/replay_report/contact_sheet.hpp"
#include "apps/replay_report/report_plots.hpp"
#include "common/html_page.hpp"
#include "common/plot_data.hpp"
#include "common/svg_plot.hpp"
#include "common/text.hpp"
#include "pictures/encode.hpp"

namespace foresight {

extern const std::string_view kReportTemplate;  // report.html, embedded by CMake

namespace {

using Fields = std::map<std::string, std::string, std::less<>>;

// Replaces each {{name}} of the template once; what is put in is not searched again.
std::string fill(std::string_view text, const Fields& fields) {
  std::string out;
  while (true) {
    const auto open = text.find("{{");
    out += text.substr(0, open);
    if (open == std::string_view::npos) return out;
    const auto close = text.find("}}", open);
    const auto field = fields.find(text.substr(open + 2, close - open - 2));
    if (field == fields.end()) throw std::logic_error("report.html names an unknown field");
    out += field->second;
    text.remove_prefix(close + 2);
  }
}

std::string image_tag(const cv::Mat& picture, const std::string& view, const std::string& alt) {
  const std::vector<std::uint8_t> jpeg = encode_jpeg(picture, 88);
  return "<img data-view=\"" + view + "\" width=\"" + std::to_string(picture.cols) + "\" height=\"" +
         std::to_string(picture.rows) + "\" alt=\"" + escape_html(alt) + "\" src=\"" + data_uri("image/jpeg", jpeg) +
         "\">";
}

std::string figure(const Instant& instant, const cv::Mat& picture, const std::string& view, const std::string& caption,
                   double start_s) {
  const std::string alt = view + " view at " + readable(instant.frame.time_s - start_s, 2, " s");
  return "<figure>" + image_tag(picture, view, alt) + "<figcaption>" + caption + "</figcaption></figure>";
}

std::string instant_row(const Instant& instant, double start_s) {
  const FrameRecord& f = instant.frame;
  const auto quality = [](const ImageQuality& q) {
    return "<b>" + readable(q.psnr_db, 1, " dB") + "</b> SSIM " + readable(q.ssim, 2) + ", sharpness " +
           readable(q.sharpness, 2);
  };
  const std::string time = readable(f.time_s - start_s, 2, " s");
  return "<div class=\"instant\" data-time=\"" + time + "\">" +
         figure(instant, instant.delayed, "delayed", quality(f.delayed), start_s) +
         figure(instant, instant.predicted, "predicted", quality(f.predicted), start_s) +
         figure(instant, instant.actual, "actual", "at " + time + ", image " + escape_html(f.stem), start_s) +
         figure(instant, instant.error, "error",
                readable(100 * f.coverage.seen, 1, " % seen, ") + readable(100 * f.coverage.filled, 1, " % filled"),
                start_s) +
         "</div>\n";
}

std::string instant_rows(std::span<const Instant> instants, double start_s) {
  std::string rows;
  for (const Instant& instant : instants) rows += instant_row(instant, start_s);
  return rows.empty() ? "<p>No image was replayed.</p>" : rows;
}

std::string tile(const std::string& name, const std::string& value, const std::string& more) {
  return "<div class=\"tile\"><span>" + name + "</span><strong>" + value + "</strong><small>" + more +
         "</small></div>\n";
}

std::string key_figures(const RunRecord& run, const Summary& s) {
  const double mib = 1024.0 * 1024.0;
  const auto megabytes = [mib](std::uint64_t bytes) { return readable(static_cast<double>(bytes) / mib, 1, " MiB"); };
  std::string out =
      tile("PSNR", readable(s.predicted.psnr_db.mean, 1, " dB"),
           "delayed image " + readable(s.delayed.psnr_db.mean, 1, " dB")) +
      tile("SSIM", readable(s.predicted.ssim.mean, 2), "delayed image " + readable(s.delayed.ssim.mean, 2)) +
      tile("Sharpness", readable(s.predicted.sharpness.mean, 2), "1 is as sharp as the actual image") +
      tile("Seen", readable(100 * s.coverage.seen, 1, " %"),
           "of the image; " + readable(100 * s.coloured_of_model.mean, 1, " %") + " of the model has a colour") +
      tile("Images per core-second", readable(s.images_per_core_second, 1),
           readable(s.texture_cpu_ms, 1, " ms CPU") + " per image") +
      tile("Arrival to publish", readable(s.arrival_to_publish_ms.median, 0, " ms"),
           "p99 " + readable(s.arrival_to_publish_ms.p99, 0, " ms")) +
      tile("Texture memory", megabytes(s.texture_bytes_max),
           "of " + megabytes(s.texture_bytes_budget) + "; " + readable(s.bytes_per_texel, 1, " bytes per texel")) +
      tile("Images", std::to_string(s.frames), std::to_string(run.drops) + " dropped");
  if (std::isfinite(s.texture_gpu_ms))
    out += tile("GPU time", readable(s.texture_gpu_ms, 2, " ms"), "per image, image to texture");
  return out;
}

std::string plot_cards(std::span<const ReportPlot> plots) {
  std::string out;
  for (const ReportPlot& plot : plots)
    out += "<section class=\"card plot\"><h3>" + escape_html(plot.title) + "</h3>" + plot.body + "</section>\n";
  return out;
}

std::string stage_rows(const Summary& summary) {
  double most = 1e-9;
  for (const StageSummary& s : summary.stages) most = std::max(most, s.cpu_ms);
  std::string rows;
  for (const StageSummary& s : summary.stages)
    rows += "<tr><td>" + escape_html(s.name) + "</td><td class=\"faint\">" + to_string(s.part) +
            "</td><td class=\"n\">" + readable(s.cpu_ms, 2) + "</td><td class=\"n\">" + readable(s.gpu_ms, 3) +
            "</td><td class=\"meter\"><i style=\"width:" + readable(100 * s.cpu_ms / most, 1) + "%\"></i></td></tr>\n";
  return rows;
}

std::string fact(const std::string& name, const std::string& value) {
  return "<tr><td class=\"faint\">" + escape_html(name) + "</td><td>" + escape_html(value) + "</td></tr>\n";
}

std::string fact_rows(const RunRecord& run) {
  const std::string degenerate =
      run.degenerate_triangles ? " (" + std::to_string(run.degenerate_triangles) + " degenerate ones dropped)" : "";
  std::string rows =
      fact("run", run.run) +
      fact("images", std::to_string(run.image_width_px) + " x " + std::to_string(run.image_height_px) + ", " +
                         run.lens_model + (run.cameras == 1 ? "" : ", " + std::to_string(run.cameras) + " cameras")) +
      fact("model", std::to_string(run.scene_triangles) + " triangles" + degenerate + ", " +
                        std::to_string(run.charts) + " charts, " + std::to_string(run.texels) + " texels") +
      fact("renderer", run.renderer) + fact("foresight", run.version);
  for (const OptionRecord& option : run.options) {
    struct {
      std::string operator()(bool v) const { return v ? "yes" : "no"; }
      std::string operator()(std::int64_t v) const { return std::to_string(v); }
      std::string operator()(double v) const { return readable(v, v == std::floor(v) ? 0 : 3); }
      std::string operator()(const std::string& v) const { return v; }
    } text;
    rows += fact(option.name, std::visit(text, option.value));
  }
  return rows;
}

std::string notes_of(const RunRecord& run) {
  std::string items;
  if (!run.complete)
    items += "<li><b>The replay was interrupted.</b> This report holds the images that were finished.</li>";
  for (const std::string& note : run.notes) items += "<li>" + escape_html(note) + "</li>";
  return items.empty() ? "" : "<ul class=\"notes\">" + items + "</ul>";
}

std::string headline(const Summary& s) {
  const double gain = s.predicted.psnr_db.mean - s.delayed.psnr_db.mean;
  if (!std::isfinite(gain)) return "No pixel could be compared.";
  if (gain < 0)
    return "The predicted view is <b>" + readable(-gain, 1, " dB") +
           "</b> less like the actual image than the delayed one.";
  return "The predicted view is <b>" + readable(gain, 1, " dB") +
         "</b> closer to the actual image than the delayed one.";
}

std::string render(const RunRecord& run, const Summary& summary, std::span<const ReportPlot> plots,
                   std::span<const Instant> instants) {
  std::vector<double> delays;
  for (const FrameRecord& f : run.frames) delays.push_back(1000 * f.delay_s);
  const double start_s = run.frames.empty() ? 0 : run.frames.front().time_s;
  return fill(kReportTemplate, {{"style", std::string(page_style())},
                                {"run", escape_html(run.run)},
                                {"delay", readable(statistic_of(delays).median, 0, " ms")},
                                {"headline", headline(summary)},
                                {"notes", notes_of(run)},
                                {"key_figures", key_figures(run, summary)},
                                {"instants", instant_rows(instants, start_s)},
                                {"plots", plot_cards(plots)},
                                {"stages", stage_rows(summary)},
                                {"facts", fact_rows(run)},
                                {"error_range", readable(kErrorRange, 0)}});
}

}  // namespace

std::string render_html_report(const RunRecord& run, std::span<const Instant> instants) {
  const Summary summary = summarise(run);
  return render(run, summary, plots_of(run, summary), instants);
}

void write_html_report(const RunRecord& run, std::span<const Instant> instants, const std::filesystem::path& file) {
  const Summary summary = summarise(run);
  const std::vector<ReportPlot> plots = plots_of(run, summary);
  std::vector<std::string> data;
  for (const ReportPlot& plot : plots) data.push_back(plot.data);
  write_page(file, render(run, summary, plots, instants), run.run, data);
}

}  // namespace foresight
