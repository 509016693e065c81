#include "apps/view_measures.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>

#include "apps/level_options.hpp"
#include "common/error.hpp"
#include "common/text.hpp"
#include "pictures/image_metrics.hpp"
#include "pictures/picture_file.hpp"
#include "texture_gpu/stage_clock.hpp"

namespace foresight {
namespace {

cv::Mat as_colour(const cv::Mat& pixels) {
  if (pixels.channels() == 3) return pixels;
  cv::Mat colour;
  cv::cvtColor(pixels, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

}  // namespace

RunRecord describe(const ViewSession& session, const ViewSetup& setup) {
  RunRecord record;
  record.image_width_px = setup.left.width();
  record.image_height_px = setup.left.height();
  record.cameras = setup.right ? 2 : 1;
  record.lens_model = to_string(setup.left.model());
  record.scene_triangles = setup.scene->triangle_count();
  for (const Node& node : setup.scene->nodes()) record.degenerate_triangles += node.mesh.dropped_degenerate;
  record.charts = session.surface_count();
  record.renderer = session.driver().renderer + ", OpenGL " + session.driver().version;
  record.version = FORESIGHT_VERSION;
  record.options.push_back({"pipeline", std::string(setup.thesis ? "thesis" : "core")});
  record.options.push_back({"projection", setup.newest_image && !setup.thesis});
  record.options.push_back({"images", std::int64_t{setup.newest_image && !setup.thesis ? setup.textures.images : 0}});
  record.options.push_back({"detail", to_string(setup.levels ? setup.levels->rule : LevelRule::full)});
  for (const std::string& remark : session.level_remarks()) record.notes.push_back(remark + ".");
  return record;
}

void add_texture_options(RunRecord& record, const TextureOptions& textures) {
  record.options.push_back({"margin_px", textures.margin_px});
  record.options.push_back({"texels_per_metre", textures.texels_per_metre});
  record.options.push_back({"max_texture", std::int64_t{textures.max_texture}});
  record.options.push_back({"texture_memory_mb", static_cast<std::int64_t>(textures.memory_bytes >> 20)});
  record.options.push_back({"model_accuracy_m", textures.depth_tolerance});
  record.options.push_back({"exposure", textures.even_exposure});
  record.options.push_back({"shadows", textures.shadows});
  record.options.push_back({"full_extraction", !textures.only_what_is_needed});
}

ViewMeasures::ViewMeasures(RunRecord record, ViewOutputs outputs, const TextureOptions& textures)
    : record_(std::move(record)), outputs_(std::move(outputs)), textures_(textures) {
  if (outputs_.out) make_folder(*outputs_.out / "predicted");
}

void ViewMeasures::arrived(const PosedFrame& frame) {
  delayed_ = as_colour(frame.left.pixels);
  delayed_time_ = frame.left.time;
}

void ViewMeasures::stepped(const ViewStep& step, FrameSource& source, ViewSession& session) {
  FrameRecord record = new_record(step.instant);
  for (const ExtractionReport& report : step.reports) take(report, record);
  if (step.instant.blind) return;
  record.arrival_to_publish_ms = step.arrival_to_publish_ms;
  record.arrival_to_visible_ms = step.arrival_to_visible_ms;
  record.arrival_to_visible_cpu_ms = step.arrival_to_visible_cpu_ms;
  if (!step.instant.late) record.delay_s = to_seconds(step.instant.time - delayed_time_);
  if (step.drawn)
    measure(record, step.draw_cpu_ms, source, session);
  else
    record.dropped = true;  // late, or the first image is still in work
  record_.frames.push_back(std::move(record));
}

FrameRecord ViewMeasures::new_record(const ShownInstant& instant) const {
  FrameRecord record;
  record.stem = instant.name;
  record.time_s = static_cast<double>(instant.time.ns) * 1e-9;
  record.texture_bytes_used = bytes_used_;
  record.texture_bytes_budget = textures_.memory_bytes;
  record.gain = gain_;
  record.misplacement_px = misplacement_px_;
  return record;
}

void ViewMeasures::take(const ExtractionReport& report, FrameRecord& record) {
  if (!report.published) {
    ++record_.drops;
    return;
  }
  for (const StageCost& cost : report.stages)
    record.stages.push_back({cost.name, cost.cpu_ms, cost.gpu_ms, StagePart::texture});
  record.texels_written = record.texels_written.value_or(0) + static_cast<double>(report.texels_written);
  record.texture_bytes_used = bytes_used_ = report.bytes_in_use;
  record.gain = gain_ = std::exp(2.2 * report.log_gain);  // from 8-bit values to linear light
  record.misplacement_px = misplacement_px_ = report.misplacement_px;
  record_.texels = std::max(record_.texels, report.texels_resident);
  record_.images_kept = std::max<std::uint64_t>(record_.images_kept, report.images_kept);
  policy_ = report.policy;
  lamp_.add(report.lamp, report.newest_image);
  right_factors_ = report.right_factors;
}

void ViewMeasures::measure(FrameRecord& record, double draw_cpu_ms, FrameSource& source, ViewSession& session) {
  const double before = process_cpu_ms();
  const cv::Mat predicted = session.read();
  const double drawn = process_cpu_ms();
  const cv::Mat actual = as_colour(source.actual());
  const ImageComparison comparison(actual, seen_mask(predicted));
  record.predicted = comparison.measure(predicted);
  record.delayed = comparison.measure(delayed_);
  record.coverage = measure_coverage(predicted);
  if (outputs_.out) write_png(*outputs_.out / "predicted" / (record.stem + ".png"), predicted);
  record.stages.push_back({"view", draw_cpu_ms + drawn - before, std::nullopt, StagePart::view});
  record.stages.push_back({"measure", process_cpu_ms() - drawn, std::nullopt, StagePart::measure});
  if (outputs_.pictures()) keeper_.offer(record, delayed_, predicted, actual);
}

void ViewMeasures::note_policy() {
  if (policy_.evicted_pages)
    record_.notes.push_back("The texture budget was reached: " + std::to_string(policy_.evicted_pages) +
                            " pages out of view, unseen for longest, gave up their place.");
  if (policy_.steps_down)
    record_.notes.push_back("The view did not fit the texture budget: all resolutions were lowered " +
                            std::to_string(policy_.steps_down) + " times and raised " +
                            std::to_string(policy_.steps_up) + " times by a factor of 1.19; now " +
                            std::to_string(policy_.bias) + " steps.");
}

void ViewMeasures::finish(const FrameSource& source, const ViewSession& session, const std::string& title) {
  record_.drops += source.overtaken() + session.replaced();
  note_policy();
  if (std::string note = lamp_.in_words(); !note.empty()) record_.notes.push_back(std::move(note));
  if (right_factors_)
    record_.notes.push_back(
        fmt::format("The right camera's colours differ from the left one's: its red counted {:.2f} "
                    "times, its blue {:.2f} times.",
                    right_factors_->x(), right_factors_->y()));
  write_reports(outputs_, record_, keeper_.instants(), title);
}

void print_summary(const RunRecord& record) {
  const Summary s = summarise(record);
  if (s.frames == 0) {
    std::printf("no image time was shown\n");
    return;
  }
  std::printf("%zu image times: predicted %.2f dB, delayed image %.2f dB on the same pixels\n", s.frames,
              s.predicted.psnr_db.mean, s.delayed.psnr_db.mean);
  std::printf("seen %.3f, filled %.3f, empty %.3f of the image; sharpness %s of the real image's\n", s.coverage.seen,
              s.coverage.filled, s.coverage.empty(), readable(s.predicted.sharpness.mean, 2).c_str());
  std::printf("%.1f images per core-second, %.1f CPU-ms per image; renderer: %s\n", s.images_per_core_second,
              s.texture_cpu_ms, record.renderer.c_str());
  if (std::isfinite(s.arrival_to_visible_ms.median))
    std::printf("an image is seen %.0f ms after it arrived, %.0f CPU-ms\n", s.arrival_to_visible_ms.median,
                s.arrival_to_visible_cpu_ms.median);
  if (std::isfinite(s.texels_written.mean))
    std::printf("%.0f thousand texels of the textures written per image\n", 1e-3 * s.texels_written.mean);
  for (const std::string& note : record.notes) std::printf("%s\n", note.c_str());
}

}  // namespace foresight
