#include "apps/bench/display_bench.hpp"

#include <algorithm>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <set>

#include "apps/bench/bench_pipelines.hpp"
#include "apps/bench/display_trial.hpp"
#include "apps/bench/lab_pictures.hpp"
#include "apps/command_line/picture_size.hpp"
#include "common/clock.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"
#include "common/text.hpp"
#include "display/view_session.hpp"
#include "sim/motion.hpp"
#include "sim/polygons.hpp"
#include "sim/synth_run.hpp"
#include "texture_gpu/frame_gate.hpp"

namespace foresight {
namespace {

using nlohmann::json;

constexpr std::size_t kImages = 12;
constexpr int kViewsTried = 36;
constexpr double kSecondsTried = 1.0 / 3;       // between views that are tried
constexpr double kRates[] = {25, 33, 50, 100};  // thesis, table 7.5
constexpr double kJudgedRate = 25;
constexpr double kMostRatio = 1.5, kMostIntervalMs = 60, kLeastExtraction = 1.0 / 3, kMostBeyondMs = 2;
constexpr double kMostLate = 1e-3, kMostViewMs = 40;
constexpr int kViewsTimed = 40;
const cv::Size kTimedSize{640, 480};

cv::Size read_size(const std::string& text) {
  const auto [width, height] = parse_picture_size(text).value_or(std::array{0, 0});
  if (width < 16 || height < 16 || width > 4096 || height > 4096)
    throw InputError("--size", in_quotes(text) + " is no size", "give WIDTHxHEIGHT, 16x16 to 4096x4096");
  return {width, height};
}

Lens lens_of(cv::Size size) {
  return sim::synth_lens({.width = size.width, .height = size.height}, false);
}

struct BenchLab {
  DisplayScene scene;
  SceneState state;  // that is shown
  std::vector<int> polygon_of_triangle;
  int polygons = 0;
};

// The lab's own pictures are of the same parts as this one, which is only the shape: its paint may be coarse. `size`:
// of its images.
BenchLab make_bench_lab(cv::Size size) {
  const sim::Lab lab = sim::make_lab(0.05, 1);
  BenchLab out;
  const sim::Polygons polygons = sim::polygons_of(lab);
  out.polygon_of_triangle = polygons.of_facet;
  out.polygons = polygons.count;
  out.scene.model = std::make_shared<const SceneModel>(sim::model_of(lab, lab.at_rest()));
  out.scene.camera = lens_of(size);
  std::fprintf(stderr, "display: rendering %zu pictures of the lab\n", kImages);
  const LabPictures pictures(size, kImages, [](std::size_t, std::size_t) {});
  std::vector<ExpectedView> views;
  for (std::size_t i = 0; i < kImages; ++i) {
    const double t = static_cast<double>(i) / LabPictures::kPairsPerSecond;
    const RobotTime time = RobotTime{} + seconds(t);
    const SceneState state{time, StateStatus::exact, sim::lab_state_at(lab, t)};
    views.push_back({sim::T_world_camera_at(t), state});
    out.scene.images.push_back({{pictures.at(time).left, time, views.back().T_world_camera, state}, std::nullopt});
  }
  out.scene.surface = surface_for(*out.scene.model, out.scene.camera, views);
  out.state = views.back().scene;
  return out;
}

/// Polygons of which the last drawing shows something.
std::size_t polygons_in(const PredictedView& view, const BenchLab& lab) {
  const gl::Texture& surface = view.faces().surface;
  std::vector<std::uint32_t> triangles(static_cast<std::size_t>(surface.width()) *
                                       static_cast<std::size_t>(surface.height()) *
                                       static_cast<std::size_t>(std::max(1, surface.layers())));
  glGetTextureImage(surface.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT,
                    static_cast<GLsizei>(triangles.size() * sizeof(std::uint32_t)), triangles.data());
  std::set<int> seen;
  for (const std::uint32_t t : triangles)
    if (t > 0 && t <= lab.polygon_of_triangle.size()) seen.insert(lab.polygon_of_triangle[t - 1]);
  return seen.size();
}

struct View {
  const char* name;
  Pose T_world_eye;
  std::size_t polygons = 0;
};

/// Along the head's way, where it sees fewest and most.
std::vector<View> few_and_many(PredictedView& view, const BenchLab& lab, const BusyTextures& textures) {
  View few{"few", {}, SIZE_MAX}, many{"many", {}, 0};
  const TextureLease lease = textures.textures().acquire();
  for (int i = 0; i < kViewsTried; ++i) {
    const Pose T_world_eye = sim::T_world_camera_at(i * kSecondsTried);
    view.draw(T_world_eye, lab.state, *lease);
    const std::size_t count = polygons_in(view, lab);
    if (count < few.polygons) few.T_world_eye = T_world_eye, few.polygons = count;
    if (count > many.polygons) many.T_world_eye = T_world_eye, many.polygons = count;
  }
  return {few, many};
}

double cpu_ms_of_view(PredictedView& view, const BenchLab& lab, const BusyTextures& textures, const View& from) {
  const TextureLease lease = textures.textures().acquire();
  std::vector<double> all;
  for (int i = 0; i < kViewsTimed; ++i)
    all.push_back(cpu_ms_of([&] {
      view.draw(from.T_world_eye, lab.state, *lease);
      glFinish();
    }));
  return median(all);
}

json to_json(const DisplayFigures& f) {
  return {{"frames", f.frames},
          {"interval_ms_p50", f.interval_p50},
          {"interval_ms_p99", f.interval_p99},
          {"drawing_ms_p50", f.drawing_p50},
          {"drawing_ms_p99", f.drawing_p99},
          {"input_to_swap_ms_p99", f.input_to_swap_p99},
          {"input_to_swap_beyond_drawing_ms_p99", f.input_beyond_drawing_p99},
          {"late_share", f.late_share},
          {"late_share_own", f.late_share_own},
          {"images_per_s", f.images_per_s}};
}

void print_row(const char* view, double rate, const char* what, const DisplayFigures& f) {
  std::printf("%-5s %4.0f  %-22s %6.1f %7.1f %9.1f %7.1f %9.1f %9.2f %8.1f\n", view, rate, what, f.interval_p50,
              f.interval_p99, f.drawing_p50, f.drawing_p99, f.input_to_swap_p99, 1e3 * f.late_share_own,
              f.images_per_s);
  std::fflush(stdout);
}

struct Bar {
  std::string what;
  double value, limit;
  bool at_least;
  bool met() const { return at_least ? value >= limit : value <= limit; }
};

struct Bench {
  const DisplayBenchOptions& options;
  cv::Size image_size;
  BenchLab lab = make_bench_lab(image_size);
  std::unique_ptr<gl::Context> context = gl::create_headless_context();
  gl::DriverInfo driver = gl::query_driver();
  MonotonicClock clock = {};
  std::shared_ptr<FrameGate> gate = std::make_shared<FrameGate>(clock);
  std::vector<Bar> bars = {};
  json rows = json::array();

  double extraction_alone(BusyTextures& textures) {
    const std::uint64_t before = textures.finished();
    const RobotTime start = clock.now();
    textures.run(true);
    clock.sleep_until(start + seconds(options.seconds));
    textures.run(false);
    const double rate = static_cast<double>(textures.finished() - before) / to_seconds(clock.now() - start);
    textures.finish(1);
    return rate;
  }

  void judge(const std::string& where, const DisplayFigures& alone, const DisplayFigures& both, double rate,
             double undisturbed) {
    bars.push_back({where + ": interval p99 beside the extraction, of that alone",
                    both.interval_p99 / alone.interval_p99, kMostRatio, false});
    bars.push_back({where + ": interval p99 beside the extraction, ms", both.interval_p99, kMostIntervalMs, false});
    bars.push_back(
        {where + ": extraction, of its undisturbed rate", both.images_per_s / undisturbed, kLeastExtraction, true});
    bars.push_back({where + ": input to swap p99 less the drawing, ms", both.input_beyond_drawing_p99,
                    1e3 / rate + kMostBeyondMs, false});
    bars.push_back({where + ": share of frames later than 3 intervals", both.late_share_own, kMostLate, false});
  }

  void round(PredictedView& view, const View& from, double rate, BusyTextures& paced, BusyTextures& unpaced,
             double undisturbed) {
    DisplayRound how{rate, options.seconds, true, from.T_world_eye};
    const auto show = [&](const char* what, BusyTextures& textures, bool extracting) {
      textures.run(extracting);
      const DisplayFigures f = show_frames(view, lab.state, how, textures, how.paced ? gate : nullptr);
      textures.run(false);
      textures.finish(1);
      print_row(from.name, rate, what, f);
      rows.push_back({{"view", from.name}, {"rate_hz", rate}, {"what", what}, {"figures", to_json(f)}});
      return f;
    };
    const DisplayFigures alone = show("frames alone", paced, false), both = show("beside the extraction", paced, true);
    how.paced = false;
    show("the same, not paced", unpaced, true);
    if (rate == kJudgedRate) judge(from.name, alone, both, rate, undisturbed);
  }
};

json report(const Bench& bench, const std::vector<View>& views, double undisturbed, double view_ms) {
  json out;
  out["renderer"] = bench.driver.renderer + ", OpenGL " + bench.driver.version;
  out["polygons"] = bench.lab.polygons;
  for (const View& view : views) out["polygons_in_view"][view.name] = view.polygons;
  out["extraction_alone_images_per_s"] = undisturbed;
  out["view_cpu_ms_640x480"] = view_ms;
  out["rounds"] = bench.rows;
  for (const Bar& bar : bench.bars)
    out["bars"].push_back({{"what", bar.what}, {"value", bar.value}, {"limit", bar.limit}, {"met", bar.met()}});
  return out;
}

}  // namespace

int bench_display(const DisplayBenchOptions& options) {
  const cv::Size size = read_size(options.size);
  // Small views get small images, which are rendered sooner.
  Bench bench{options, size.area() < kTimedSize.area() ? size : kTimedSize};
  gl::set_up_context();
  const auto buffers = std::make_shared<const gl::SceneBuffers>(*bench.lab.scene.model);
  const auto records = std::make_shared<const SurfaceRecords>(*bench.lab.scene.surface);
  BusyTextures paced(*bench.context, bench.lab.scene, bench.gate), unpaced(*bench.context, bench.lab.scene, nullptr);
  paced.finish(kImages);
  unpaced.finish(kImages);
  PredictedView view(buffers, records, lens_of(size)), timed(buffers, records, lens_of(kTimedSize));
  const auto views = few_and_many(view, bench.lab, paced);
  const double view_ms = cpu_ms_of_view(timed, bench.lab, paced, views[1]);
  const double undisturbed = bench.extraction_alone(unpaced);
  std::printf("%d polygons, in view few %zu, many %zu; views of %d x %d px; %s\n", bench.lab.polygons,
              views[0].polygons, views[1].polygons, size.width, size.height, bench.driver.renderer.c_str());
  std::printf("extraction alone: %.1f images of %d x %d px per second; a view of 640 x 480 px: %.1f CPU-ms\n\n",
              undisturbed, bench.image_size.width, bench.image_size.height, view_ms);
  std::printf(
      "view  rate  what                   interval p50, p99   drawing p50, p99   input p99  late/1000 images/s\n");
  const std::vector<double> rates =
      options.rate_hz > 0 ? std::vector{options.rate_hz} : std::vector<double>(std::begin(kRates), std::end(kRates));
  for (const double rate : rates)
    for (const View& from : views) bench.round(view, from, rate, paced, unpaced, undisturbed);
  bench.bars.push_back({"a view of 640 x 480 px, CPU-ms", view_ms, kMostViewMs, false});
  std::printf("\n");
  for (const Bar& bar : bench.bars)
    std::printf("%-70s %8.3g, %s %.3g: %s\n", bar.what.c_str(), bar.value, bar.at_least ? "at least" : "at most",
                bar.limit, bar.met() ? "met" : "MISSED");
  write_numbers(options.json, report(bench, views, undisturbed, view_ms).dump(2));
  return std::ranges::all_of(bench.bars, &Bar::met) ? 0 : 1;
}

}  // namespace foresight
