#include "apps/bench/view_bench.hpp"

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <iostream>
#include <nlohmann/json.hpp>

#include "apps/bench/bench_pipelines.hpp"
#include "apps/replay_report/progress_bar.hpp"
#include "common/error.hpp"
#include "common/numbers_file.hpp"
#include "common/statistics.hpp"
#include "display/predicted_view.hpp"
#include "display/recorded_source.hpp"
#include "pictures/image_metrics.hpp"

namespace foresight {
namespace {

using nlohmann::json;
using SteadyClock = std::chrono::steady_clock;

/// A way of drawing, and what it took and gave.
struct Way {
  const char* name;
  PredictedView view;
  std::vector<double> cpu_ms, psnr_db, sharpness;

  /// `newest`: looked up directly, if there.
  void draw(const ViewPlace& place, const PublishedTextures& textures, const NewestImages* newest) {
    cpu_ms.push_back(cpu_ms_of([&] {
      if (newest)
        view.draw(place.T_world_camera, place.scene, textures, *newest);
      else
        view.draw(place.T_world_camera, place.scene, textures);
      glFinish();
    }));
  }
  void judge(const cv::Mat& actual) {
    const cv::Mat picture = view.read();
    const ImageComparison comparison(actual, seen_mask(picture));
    if (const auto db = comparison.psnr_db(picture)) psnr_db.push_back(*db);
    if (const auto value = comparison.sharpness(picture)) sharpness.push_back(*value);
  }
  json row() const {
    return {{"cpu_ms", median(cpu_ms)}, {"psnr_db", median(psnr_db)}, {"sharpness", median(sharpness)}};
  }
};

}  // namespace

int bench_view(const ViewBenchOptions& options) {
  const RunFolder run = RunFolder::open(options.run, {});
  const std::size_t images = std::min(run.frames().size(), static_cast<std::size_t>(options.images));
  const auto ahead = static_cast<std::size_t>(options.ahead);
  if (images < 1 + ahead)
    throw InputError(options.run.string(), "has " + std::to_string(images) + " images",
                     "take a run of more than --ahead " + std::to_string(ahead));
  const auto context = gl::create_headless_context();
  const gl::DriverInfo driver = gl::query_driver();
  gl::set_up_context();
  TextureOptions textures;
  textures.depth_tolerance = run.scene()->accuracy().value_or(textures.depth_tolerance);
  BenchCore core(run.scene(), surface_for(run), run.lens_left(), textures, driver.is_software);
  const auto buffers = std::make_shared<const gl::SceneBuffers>(*run.scene());
  const auto records = std::make_shared<const SurfaceRecords>(*core.surface());
  Way ways[] = {{"single", {buffers, records, run.lens_left(), ViewPrograms::single}, {}, {}, {}},
                {"two", {buffers, records, run.lens_left()}, {}, {}, {}},
                {"newest", {buffers, records, run.lens_left()}, {}, {}, {}}};

  LatestImages newest;
  ProgressBar bar("view", "images", images - ahead, SteadyClock::now(), ProgressBar::for_stderr());
  for (std::size_t i = 0; i + ahead < images; ++i) {
    PosedFrame frame = load_posed_frame(run, i);
    frame.right.reset();
    core.process(frame, newest);
    std::cerr << bar.update(i + 1, SteadyClock::now()) << std::flush;
    if (i + ahead < images / 2) continue;
    const PosedImage next = load_posed_frame(run, i + ahead).left;
    const TextureLease lease = core.textures().acquire();
    const ImagesLease image = newest.acquire();
    for (int round = 0; round < options.rounds; ++round)
      for (Way& way : ways)
        way.draw({next.T_world_camera, next.scene}, *lease, &way == &ways[2] && image ? &*image : nullptr);
    for (Way& way : ways) way.judge(next.pixels);
  }
  std::cerr << bar.finish(images - ahead, SteadyClock::now());

  const Lens& lens = run.lens_left();
  std::printf("a view of %d x %d, %zu triangles; %s\n", lens.width(), lens.height(), run.scene()->triangle_count(),
              driver.renderer.c_str());
  json all{{"image_size_px", {lens.width(), lens.height()}},
           {"triangles", run.scene()->triangle_count()},
           {"renderer", driver.renderer + ", OpenGL " + driver.version}};
  for (const Way& way : ways) {
    all[way.name] = way.row();
    std::printf("%-8s %7.1f CPU-ms   %.2f dB   sharpness %.3f\n", way.name, median(way.cpu_ms), median(way.psnr_db),
                median(way.sharpness));
  }
  write_numbers(options.json, all.dump(2));
  return 0;
}

}  // namespace foresight
