#include "apps/replay.hpp"

#include <fmt/core.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <csignal>
#include <deque>
#include <iostream>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <thread>

#include "apps/output_files.hpp"
#include "apps/replay_outputs.hpp"
#include "apps/replay_refinement.hpp"
#include "apps/replay_report/contact_sheet.hpp"
#include "apps/replay_report/html_report.hpp"
#include "apps/replay_report/image_metrics.hpp"
#include "apps/replay_report/instants.hpp"
#include "apps/replay_report/progress_bar.hpp"
#include "apps/replay_report/replay_report.hpp"
#include "apps/replay_session.hpp"
#include "common/atomic_file.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

namespace fs = std::filesystem;
using Clock = std::chrono::steady_clock;

constexpr double kLastPicture = 3;  // seconds for which the window shows the last instant

std::atomic<bool> interrupted = false;
extern "C" void on_interrupt(int) {
  interrupted = true;
  std::signal(SIGINT, SIG_DFL);  // a second Ctrl-C ends the program even where a driver hangs
}

/// For each image time, the number of images that have arrived by then: those not newer than the
/// time minus the delay. Throws InputError for a delay that no image outlives.
std::vector<std::size_t> arrivals(const RunFolder& run, const ReplayOptions& options) {
  const auto& frames = run.frames();
  std::vector<std::size_t> arrived(frames.size());
  for (std::size_t i = 0; i < frames.size(); ++i) {
    if (options.delay_frames) {
      const auto delay = static_cast<std::size_t>(*options.delay_frames);
      arrived[i] = i + 1 > delay ? i + 1 - delay : 0;
    } else {
      const RobotTime newest = frames[i].left.time - seconds(options.delay_ms.value_or(0) * 1e-3);
      arrived[i] = i ? arrived[i - 1] : 0;
      while (arrived[i] < frames.size() && frames[arrived[i]].left.time <= newest) ++arrived[i];
    }
  }
  if (arrived.back() == 0)
    throw InputError(options.delay_frames ? "--delay-frames" : "--delay-ms", "the delay is longer than the run",
                     options.delay_frames
                         ? "give at most " + std::to_string(frames.size() - 1) + " images"
                         : "give at most " +
                               std::to_string(to_seconds(frames.back().left.time - frames.front().left.time) * 1e3) +
                               " ms");
  return arrived;
}

/// Nothing where the core is to do it. The thesis' own resolution is the default there.
std::optional<thesis::Options> thesis_options(const ReplayOptions& options) {
  if (options.pipeline == ReplayPipeline::core) return std::nullopt;
  thesis::Options out;
  if (options.textures.texels_per_metre > 0) out.texels_per_metre = options.textures.texels_per_metre;
  if (options.textures.max_texture > 0) out.max_texture = options.textures.max_texture;
  return out;
}

cv::Mat as_colour(const cv::Mat& pixels) {
  if (pixels.channels() == 3) return pixels;
  cv::Mat colour;
  cv::cvtColor(pixels, colour, cv::COLOR_GRAY2BGR);
  return colour;
}

void write_png(const fs::path& file, const cv::Mat& picture) {
  std::vector<unsigned char> bytes;
  cv::imencode(".png", picture, bytes, {cv::IMWRITE_PNG_COMPRESSION, 3});
  write_file_atomically(file, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

/// One replay, from the checked run to the written reports.
class Replay {
 public:
  Replay(const RunFolder& run, const ReplayOptions& options, std::vector<std::size_t> arrived)
      : run_(run),
        options_(options),
        arrived_(std::move(arrived)),
        session_(run, options.textures, thesis_options(options), options.window),
        bar_("replay", "images", run.frames().size(), Clock::now(), ProgressBar::for_stderr()) {
    describe();
    if (options.out) make_folder(*options.out / "predicted");
    if (options.refine) refinement_.emplace(run, session_, options.textures.margin_px);
  }

  int play() {
    options_.real_time ? play_by_the_clock() : play_step_by_step();
    if (!interrupted) session_.linger(kLastPicture);
    std::cerr << bar_.finish(record_.frames.size(), Clock::now());
    record_.complete = !interrupted && !closed_;
    if (options_.real_time) record_.drops += session_.textures().replaced();
    note_policy();
    write_reports();
    print_summary();
    return interrupted ? 130 : 0;
  }

 private:
  void describe() {
    const Lens& lens = run_.lens_left();
    record_.run = fs::absolute(options_.run).lexically_normal().filename().string();
    if (record_.run.empty())
      record_.run = fs::absolute(options_.run).lexically_normal().parent_path().filename().string();
    record_.image_width_px = lens.width();
    record_.image_height_px = lens.height();
    record_.cameras = run_.lens_right() ? 2 : 1;
    record_.lens_model = to_string(lens.model());
    record_.scene_triangles = run_.scene()->triangle_count();
    for (const Node& node : run_.scene()->nodes()) record_.degenerate_triangles += node.mesh.dropped_degenerate;
    record_.charts = session_.surface_count();
    record_.renderer = session_.driver().renderer + ", OpenGL " + session_.driver().version;
    record_.version = FORESIGHT_VERSION;
    record_.options.push_back({"pipeline", std::string(options_.pipeline == ReplayPipeline::core ? "core" : "thesis")});
    const TextureOptions& t = options_.textures;
    if (options_.delay_frames)
      record_.options.push_back({"delay_frames", std::int64_t{*options_.delay_frames}});
    else
      record_.options.push_back({"delay_ms", options_.delay_ms.value_or(0)});
    record_.options.push_back({"margin_px", t.margin_px});
    record_.options.push_back({"texels_per_metre", t.texels_per_metre});
    record_.options.push_back({"max_texture", std::int64_t{t.max_texture}});
    record_.options.push_back({"texture_memory_mb", static_cast<std::int64_t>(t.memory_bytes >> 20)});
    record_.options.push_back({"model_accuracy_m", t.depth_tolerance});
    record_.options.push_back({"real_time", options_.real_time});
    record_.options.push_back({"refine", options_.refine});
    if (options_.scene) record_.options.push_back({"scene", options_.scene->string()});
    if (run_.unpaired_right())
      record_.notes.push_back(std::to_string(run_.unpaired_right()) +
                              " right images have no left one and were left out.");
  }

  void play_step_by_step() {
    std::size_t fed = 0;
    for (std::size_t i = 0; i < arrived_.size() && !stopped(); ++i) {
      FrameRecord record = new_record(i);
      while (fed < arrived_[i] && !stopped()) {
        PosedFrame frame = session_.load(fed++);
        if (refinement_) refinement_->refine(fed - 1, frame);
        delayed_ = as_colour(frame.left.pixels);
        delayed_time_ = frame.left.time;
        const auto arrival = Clock::now();
        const ExtractionReport report = session_.process(std::move(frame));
        record.arrival_to_publish_ms = std::chrono::duration<double, std::milli>(Clock::now() - arrival).count();
        take(report, record);
      }
      if (arrived_[i] == 0 || stopped()) continue;
      show_and_measure(i, record);
    }
  }

  bool stopped() const { return interrupted || closed_; }

  /// Every image arrives when the clock says so, whether the last one is done or not; image times
  /// that have passed before they can be drawn are dropped.
  void play_by_the_clock() {
    const auto& frames = run_.frames();
    const auto start = Clock::now();
    const auto due = [&](std::size_t i) {
      return start + std::chrono::duration_cast<Clock::duration>(frames[i].left.time - frames.front().left.time);
    };
    std::size_t fed = 0;
    for (std::size_t i = 0; i < arrived_.size() && !stopped(); ++i) {
      sleep_until(due(i));
      FrameRecord record = new_record(i);
      if (i + 1 < frames.size() && Clock::now() > due(i + 1)) {
        record.dropped = true;
        if (arrived_[i] > 0) record_.frames.push_back(std::move(record));
        continue;
      }
      if (arrived_[i] > fed) {
        // The newest wins: images that came meanwhile are never even decoded.
        record_.drops += arrived_[i] - fed - 1;
        fed = arrived_[i];
        PosedFrame frame = session_.load(fed - 1);
        delayed_ = as_colour(frame.left.pixels);
        delayed_time_ = frame.left.time;
        if (refinement_) refinement_->refine(fed - 1, frame);
        submitted_.emplace_back(Clock::now(), frame.left.time);
        session_.textures().submit(std::move(frame));
      }
      if (const auto report = session_.textures().take_report()) {
        take(*report, record);
        record.arrival_to_publish_ms = publish_latency(*report);
      }
      if (arrived_[i] > 0 && !stopped()) show_and_measure(i, record);
    }
  }

  /// In short naps, so that Ctrl-C does not wait for a gap of the run.
  void sleep_until(Clock::time_point wake) const {
    while (!stopped() && Clock::now() < wake)
      std::this_thread::sleep_until(std::min(wake, Clock::now() + std::chrono::milliseconds(50)));
  }

  std::optional<double> publish_latency(const ExtractionReport& report) {
    while (!submitted_.empty() && submitted_.front().second < report.newest_image) submitted_.pop_front();
    if (submitted_.empty() || submitted_.front().second != report.newest_image) return std::nullopt;
    return std::chrono::duration<double, std::milli>(report.published_at - submitted_.front().first).count();
  }

  FrameRecord new_record(std::size_t i) const {
    FrameRecord record;
    record.stem = run_.frames()[i].left.stem;
    record.time_s = static_cast<double>(run_.frames()[i].left.time.ns) * 1e-9;
    record.texture_bytes_used = bytes_used_;
    record.texture_bytes_budget = options_.textures.memory_bytes;
    record.gain = gain_;
    return record;
  }

  void take(const ExtractionReport& report, FrameRecord& record) {
    if (!report.published) {
      ++record_.drops;
      return;
    }
    for (const StageCost& cost : report.stages)
      record.stages.push_back({cost.name, cost.cpu_ms, cost.gpu_ms, StagePart::texture});
    record.texture_bytes_used = bytes_used_ = report.bytes_in_use;
    record.gain = gain_ = std::exp(2.2 * report.log_gain);  // from 8-bit values to linear light
    record_.texels = std::max(record_.texels, report.texels_resident);
    policy_ = report.policy;
  }

  /// Draws the view of image time i, compares, writes.
  void show_and_measure(std::size_t i, FrameRecord& record) {
    record.delay_s = to_seconds(run_.frames()[i].left.time - delayed_time_);
    const double before = process_cpu_ms();
    const RunImage& image = run_.frames()[i].left;
    const cv::Mat predicted =
        session_.predict(refinement_ ? refinement_->predict(i) : image.T_world_camera, run_.state_at(image.time));
    if (predicted.empty()) {  // real time: the first image is still in work
      record.dropped = true;
      record_.frames.push_back(record);
      return;
    }
    const double drawn = process_cpu_ms();
    const cv::Mat actual = as_colour(read_run_image(image, run_.lens_left()));
    const ImageComparison comparison(actual, seen_mask(predicted));
    record.predicted = comparison.measure(predicted);
    record.delayed = comparison.measure(delayed_);
    record.coverage = measure_coverage(predicted);
    if (options_.out) write_png(*options_.out / "predicted" / (record.stem + ".png"), predicted);
    record.stages.push_back({"view", drawn - before, std::nullopt, StagePart::view});
    record.stages.push_back({"measure", process_cpu_ms() - drawn, std::nullopt, StagePart::measure});
    keeper_.offer(record, delayed_, predicted, actual);
    record_.frames.push_back(record);
    std::cerr << bar_.update(i + 1, Clock::now()) << std::flush;
    closed_ = !session_.show(
        delayed_, predicted, actual,
        fmt::format("Foresight replay: {:.0f} ms delayed {:.1f} dB | predicted {:.1f} dB | actual",
                    record.delay_s * 1e3, record.delayed.psnr_db.value_or(0), record.predicted.psnr_db.value_or(0)));
  }

  void note_policy() {
    if (refinement_) record_.refinement = refinement_->record();
    if (refinement_)
      for (std::string& note : refinement_->notes()) record_.notes.push_back(std::move(note));
    if (policy_.evicted_pages)
      record_.notes.push_back("The texture budget was reached: " + std::to_string(policy_.evicted_pages) +
                              " pages out of view, unseen for longest, gave up their place.");
    if (policy_.steps_down)
      record_.notes.push_back("The view did not fit the texture budget: all resolutions were lowered " +
                              std::to_string(policy_.steps_down) + " times and raised " +
                              std::to_string(policy_.steps_up) + " times by a factor of 1.19; now " +
                              std::to_string(policy_.bias) + " steps.");
  }

  void write_reports() {
    const auto instants = keeper_.instants();
    if (options_.out && !instants.empty())
      write_contact_sheet("Foresight replay of " + record_.run, instants, *options_.out / "contact_sheet.png");
    if (options_.report)
      make_folder(fs::absolute(*options_.report).parent_path()), write_json_report(record_, *options_.report);
    if (options_.html)
      make_folder(fs::absolute(*options_.html).parent_path()), write_html_report(record_, instants, *options_.html);
  }

  void print_summary() const {
    const Summary s = summarise(record_);
    if (s.frames == 0) {
      std::printf("no image time was shown\n");
      return;
    }
    std::printf("%zu image times: predicted %.2f dB, delayed image %.2f dB on the same pixels\n", s.frames,
                s.predicted.psnr_db.mean, s.delayed.psnr_db.mean);
    std::printf("seen %.3f, filled %.3f, empty %.3f of the image; sharpness %.2f of the real image's\n",
                s.coverage.seen, s.coverage.filled, s.coverage.empty(), s.predicted.sharpness.mean);
    std::printf("%.1f images per core-second, %.1f CPU-ms per image; renderer: %s\n", s.images_per_core_second,
                s.texture_cpu_ms, record_.renderer.c_str());
    for (const std::string& note : record_.notes) std::printf("%s\n", note.c_str());
  }

  const RunFolder& run_;
  const ReplayOptions& options_;
  std::vector<std::size_t> arrived_;
  ReplaySession session_;
  ProgressBar bar_;
  RunRecord record_;
  std::optional<ReplayRefinement> refinement_;
  InstantKeeper keeper_{4};
  cv::Mat delayed_;
  RobotTime delayed_time_;
  std::deque<std::pair<Clock::time_point, RobotTime>> submitted_;  // real time: when each image came
  std::uint64_t bytes_used_ = 0;
  double gain_ = 1;
  ChartAtlas::Policy policy_;
  bool closed_ = false;  // the window
};

}  // namespace

int replay(const ReplayOptions& given) {
  if (given.delay_frames && given.delay_ms)
    throw InputError("--delay-ms", "--delay-frames is given too", "give one of the two");
  if (given.pipeline == ReplayPipeline::thesis && given.refine)
    throw InputError("--refine", "the thesis' pipeline has no view to align images to",
                     "leave --refine away, or use --pipeline core");
  if (given.pipeline == ReplayPipeline::thesis && given.real_time)
    throw InputError("--real-time", "the thesis' pipeline draws and extracts in one thread",
                     "leave --real-time away, or use --pipeline core");
  ReplayOptions options = given;
  const RunFolder run = open_run(options);
  const std::vector<std::size_t> arrived = arrivals(run, options);
  check_outputs(options, run);
  check_images(run);
  interrupted = false;
  std::signal(SIGINT, on_interrupt);
  return Replay(run, options, arrived).play();
}

}  // namespace foresight
