#include "apps/replay_report/replay_report.hpp"

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "common/atomic_file.hpp"
#include "common/statistics.hpp"

namespace foresight {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) {
  return std::isfinite(value) ? Json(value) : Json(nullptr);
}
Json number(const std::optional<double>& value) {
  return number(value.value_or(kNaN));
}

template <typename Get>
Statistic over_frames(const RunRecord& run, Get get) {
  std::vector<double> values;
  for (const FrameRecord& frame : run.frames)
    if (!frame.dropped) values.push_back(std::optional<double>(get(frame)).value_or(kNaN));
  return statistic_of(std::move(values));
}

QualitySummary quality_over_frames(const RunRecord& run, ImageQuality FrameRecord::*which) {
  return {over_frames(run, [=](const FrameRecord& f) { return (f.*which).psnr_db; }),
          over_frames(run, [=](const FrameRecord& f) { return (f.*which).ssim; }),
          over_frames(run, [=](const FrameRecord& f) { return (f.*which).sharpness; })};
}

double mean_share(const RunRecord& run, double Coverage::*which) {
  const double mean = over_frames(run, [=](const FrameRecord& f) { return f.coverage.*which; }).mean;
  return std::isfinite(mean) ? mean : 0;
}

std::vector<StageSummary> sum_stages(const RunRecord& run) {
  std::vector<StageSummary> sums;
  for (const FrameRecord& frame : run.frames)
    for (const StageTime& stage : frame.stages) {
      auto it = std::find_if(sums.begin(), sums.end(), [&](const StageSummary& s) { return s.name == stage.name; });
      if (it == sums.end()) it = sums.insert(it, {stage.name, stage.part, 0, std::nullopt});
      it->cpu_ms += stage.cpu_ms;
      if (stage.gpu_ms) it->gpu_ms = it->gpu_ms.value_or(0) + *stage.gpu_ms;
    }
  return sums;
}

void summarise_stages(const RunRecord& run, Summary& summary) {
  summary.stages = sum_stages(run);
  const auto timed =
      std::count_if(run.frames.begin(), run.frames.end(), [](const auto& f) { return !f.stages.empty(); });
  bool gpu_timed = false;
  for (StageSummary& stage : summary.stages) {
    stage.cpu_ms /= static_cast<double>(timed);
    if (stage.gpu_ms) *stage.gpu_ms /= static_cast<double>(timed);
    if (stage.part != StagePart::texture) continue;
    summary.texture_cpu_ms += stage.cpu_ms;
    summary.texture_gpu_ms += stage.gpu_ms.value_or(0);
    gpu_timed |= stage.gpu_ms.has_value();
  }
  if (!gpu_timed) summary.texture_gpu_ms = kNaN;
  summary.images_per_core_second = summary.texture_cpu_ms > 0 ? 1000 / summary.texture_cpu_ms : kNaN;
}

Json json_of(const Statistic& s) {
  return {{"mean", number(s.mean)},
          {"median", number(s.median)},
          {"min", number(s.min)},
          {"max", number(s.max)},
          {"p99", number(s.p99)}};
}

Json json_of(const QualitySummary& q) {
  return {{"psnr_db", json_of(q.psnr_db)}, {"ssim", json_of(q.ssim)}, {"sharpness", json_of(q.sharpness)}};
}

Json json_of(const ImageQuality& q) {
  return {{"psnr_db", number(q.psnr_db)}, {"ssim", number(q.ssim)}, {"sharpness", number(q.sharpness)}};
}

Json json_of(const Coverage& c) {
  return {{"seen", c.seen},         {"filled", c.filled},
          {"empty", c.empty()},     {"model_without_colour", c.uncoloured},
          {"no_model", c.no_model}, {"coloured_of_model", number(c.coloured_of_model())}};
}

template <typename Stage>  // StageTime or StageSummary
Json json_of_stages(const std::vector<Stage>& stages) {
  Json list = Json::array();
  for (const Stage& s : stages)
    list.push_back(
        {{"name", s.name}, {"part", to_string(s.part)}, {"cpu_ms", number(s.cpu_ms)}, {"gpu_ms", number(s.gpu_ms)}});
  return list;
}

Json json_of(const FrameRecord& f) {
  Json json = {{"stem", f.stem}, {"time_s", number(f.time_s)}, {"delay_s", number(f.delay_s)}, {"dropped", f.dropped}};
  if (!f.dropped) {
    json["predicted"] = json_of(f.predicted);
    json["delayed"] = json_of(f.delayed);
    json["coverage"] = json_of(f.coverage);
  }
  json["arrival_to_publish_ms"] = number(f.arrival_to_publish_ms);
  json["arrival_to_visible_ms"] = number(f.arrival_to_visible_ms);
  json["arrival_to_visible_cpu_ms"] = number(f.arrival_to_visible_cpu_ms);
  json["texels_written"] = number(f.texels_written);
  json["texture_bytes_used"] = f.texture_bytes_used;
  json["texture_bytes_budget"] = f.texture_bytes_budget;
  json["gain"] = number(f.gain);
  json["misplacement_px"] = number(f.misplacement_px);
  json["stages"] = json_of_stages(f.stages);
  return json;
}

Json json_of(const RunRecord& run, const Summary& s) {
  return {{"frames", s.frames},
          {"dropped_frames", s.dropped_frames},
          {"dropped_images", run.drops},
          {"predicted", json_of(s.predicted)},
          {"delayed", json_of(s.delayed)},
          {"coverage", json_of(s.coverage)},
          {"coloured_of_model", json_of(s.coloured_of_model)},
          {"stages", json_of_stages(s.stages)},
          {"texture_cpu_ms_per_image", number(s.texture_cpu_ms)},
          {"texture_gpu_ms_per_image", number(s.texture_gpu_ms)},
          {"images_per_core_second", number(s.images_per_core_second)},
          {"arrival_to_publish_ms", json_of(s.arrival_to_publish_ms)},
          {"arrival_to_visible_ms", json_of(s.arrival_to_visible_ms)},
          {"arrival_to_visible_cpu_ms", json_of(s.arrival_to_visible_cpu_ms)},
          {"texels_written", json_of(s.texels_written)},
          {"texture_bytes_max", s.texture_bytes_max},
          {"texture_bytes_budget", s.texture_bytes_budget},
          {"bytes_per_texel", number(s.bytes_per_texel)}};
}

Json json_of_options(const std::vector<OptionRecord>& options) {
  Json json = Json::object();
  for (const OptionRecord& option : options)
    std::visit([&](const auto& value) { json[option.name] = value; }, option.value);
  return json;
}

}  // namespace

std::string to_string(StagePart part) {
  switch (part) {
    case StagePart::texture: return "texture";
    case StagePart::view: return "view";
    case StagePart::measure: return "measure";
  }
  return {};
}

Statistic statistic_of(std::vector<double> values) {
  std::erase_if(values, [](double v) { return !std::isfinite(v); });
  if (values.empty()) return {};
  const auto [least, most] = std::minmax_element(values.begin(), values.end());
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  return {mean, median(values), *least, *most, quantile(values, 0.99)};
}

Summary summarise(const RunRecord& run) {
  Summary s;
  for (const FrameRecord& f : run.frames) {
    (f.dropped ? s.dropped_frames : s.frames)++;
    s.texture_bytes_max = std::max(s.texture_bytes_max, f.texture_bytes_used);
    s.texture_bytes_budget = std::max(s.texture_bytes_budget, f.texture_bytes_budget);
  }
  s.predicted = quality_over_frames(run, &FrameRecord::predicted);
  s.delayed = quality_over_frames(run, &FrameRecord::delayed);
  s.coverage = {mean_share(run, &Coverage::seen), mean_share(run, &Coverage::filled),
                mean_share(run, &Coverage::uncoloured), mean_share(run, &Coverage::no_model)};
  s.coloured_of_model = over_frames(run, [](const FrameRecord& f) { return f.coverage.coloured_of_model(); });
  s.arrival_to_publish_ms = over_frames(run, [](const FrameRecord& f) { return f.arrival_to_publish_ms; });
  s.arrival_to_visible_ms = over_frames(run, [](const FrameRecord& f) { return f.arrival_to_visible_ms; });
  s.arrival_to_visible_cpu_ms = over_frames(run, [](const FrameRecord& f) { return f.arrival_to_visible_cpu_ms; });
  s.texels_written = over_frames(run, [](const FrameRecord& f) { return f.texels_written; });
  summarise_stages(run, s);
  s.bytes_per_texel = run.texels ? static_cast<double>(s.texture_bytes_max) / static_cast<double>(run.texels) : kNaN;
  return s;
}

Json to_json(const RunRecord& run) {
  Json json = {{"schema", "foresight_replay_report"},
               {"schema_version", 1},
               {"foresight_version", run.version},
               {"complete", run.complete}};
  json["run"] = {{"name", run.run},
                 {"image_width_px", run.image_width_px},
                 {"image_height_px", run.image_height_px},
                 {"cameras", run.cameras},
                 {"lens_model", run.lens_model},
                 {"scene_triangles", run.scene_triangles},
                 {"degenerate_triangles", run.degenerate_triangles},
                 {"charts", run.charts},
                 {"texels", run.texels},
                 {"images_kept", run.images_kept},
                 {"renderer", run.renderer}};
  json["options"] = json_of_options(run.options);
  json["summary"] = json_of(run, summarise(run));
  if (run.refinement)
    json["refinement"] = {{"refined_images", run.refinement->refined},
                          {"refused_images", run.refinement->refused},
                          {"vetoed_images", run.refinement->vetoed},
                          {"images_with_tags", run.refinement->with_tags}};
  json["notes"] = run.notes;
  json["frames"] = Json::array();
  for (const FrameRecord& frame : run.frames) json["frames"].push_back(json_of(frame));
  return json;
}

void write_json_report(const RunRecord& run, const std::filesystem::path& file) {
  // File names may hold any bytes; a report with a replaced character beats none.
  write_file_atomically(file, to_json(run).dump(1, ' ', false, Json::error_handler_t::replace) + "\n");
}

}  // namespace foresight
