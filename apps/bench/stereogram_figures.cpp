#include "apps/bench/stereogram_figures.hpp"

#include <chrono>
#include <cstdio>
#include <nlohmann/json.hpp>
#include <opencv2/imgproc.hpp>

#include "common/cpu_time.hpp"
#include "common/statistics.hpp"
#include "display/stereogram/decode.hpp"
#include "display/stereogram/stereogram.hpp"
#include "gl/raster_pass.hpp"
#include "gl/read_texture.hpp"

namespace foresight {
namespace {

constexpr int kRounds = 9;
constexpr double kShareOfWidth = 0.25;  // the eyes' distance, of the picture

Lens pinhole(const Lens& camera, int width) {
  Lens::Parameters p;
  p.width = width;
  p.height = 3 * width / 4;
  p.fx = p.fy = camera.parameters().fx * width / camera.width();
  p.cx = (p.width - 1) / 2.0;
  p.cy = (p.height - 1) / 2.0;
  return Lens(p);
}

cv::Mat clouds() {
  cv::Mat noise(96, 96, CV_8UC3), out;
  cv::RNG(1).fill(noise, cv::RNG::UNIFORM, 0, 256);
  cv::GaussianBlur(noise, out, {}, 1.5);
  return out;
}

}  // namespace

nlohmann::json stereogram_figures(const RunFolder& run, int smaller) {
  const RunImage& image = run.frames().front().left;
  const gl::RasterPass raster(std::make_shared<gl::SceneBuffers>(*run.scene()), false);
  nlohmann::json rows = nlohmann::json::array();
  std::printf("stereograms                  size       strips  pattern  CPU-ms  pictures/s  read within 1 px\n");
  for (const int width : {smaller, 2 * smaller}) {
    const Lens lens = pinhole(run.lens_left(), width);
    const gl::FaceImages faces(gl::faces_for(lens, 0), false);
    raster(image.T_world_camera, run.state_at(image.time), faces);
    const cv::Mat inverse = gl::read_texture(faces.depth) / gl::kNearPlane;
    const DepthRange range = depth_range(inverse);
    for (const bool dots : {true, false}) {
      Stereogram stereogram(lens.width(), lens.height(), dots ? cv::Mat() : clouds());
      for (const StripPictures pictures : {StripPictures::one, StripPictures::two}) {
        StereogramOptions options;
        options.depth.eye_distance = kShareOfWidth * width;
        options.pictures = pictures;
        std::vector<double> cpu_ms, wall_s;
        for (int i = 0; i < kRounds; ++i) {
          options.frame = static_cast<unsigned>(i);
          glFinish();
          const auto began = std::chrono::steady_clock::now();
          const double cpu = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
          stereogram(faces.depth, range, options);
          glFinish();
          cpu_ms.push_back(1e3 * (cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - cpu));
          wall_s.push_back(std::chrono::duration<double>(std::chrono::steady_clock::now() - began).count());
        }
        const cv::Mat decoded = decode_stereogram(stereogram.read(), options.depth.least(), options.depth.most());
        const double read = share_decoded(nearness(inverse, range), decoded, options.depth, 1);
        const char* const strips = pictures == StripPictures::one ? "one" : "two";
        const char* const pattern = dots ? "dots" : "picture";
        std::printf("                             %4dx%-4d  %-6s  %-7s  %6.1f  %10.1f  %5.1f %%\n", lens.width(),
                    lens.height(), strips, pattern, median(cpu_ms), 1 / median(wall_s), 1e2 * read);
        rows.push_back({{"width", lens.width()},
                        {"height", lens.height()},
                        {"strips", strips},
                        {"pattern", pattern},
                        {"cpu_ms", median(cpu_ms)},
                        {"pictures_per_s", 1 / median(wall_s)},
                        {"read_within_1_px", read},
                        {"steps_px", options.depth.most() - options.depth.least()}});
      }
    }
  }
  return rows;
}

}  // namespace foresight
