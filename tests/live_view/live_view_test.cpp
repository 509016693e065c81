// The rasterised lab against the ray caster's, which shares none of its code.
#include "sim/live_view/live_view.hpp"

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "drivers/camera/frame.hpp"
#include "sim/live_lab.hpp"
#include "sim/picture.hpp"
#include "sim/synth_run.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::sim {
namespace {

/// One lit lab for all tests.
struct World {
  LiveLab live{{0.002, 1, {}}};
  LightMap light{live.lab(), 4};
  LabState state = live.true_state(shafts_at_rest, 0);
  LightMap::Irradiance irradiance = light.lit(state);
  Pose T_world_camera = live.T_world_left(shafts_at_rest);
};
const World& world() {
  static const World built;
  return built;
}

Lens lens_of(bool fisheye, bool distortion) {
  SynthOptions options;
  options.width = 320;
  options.height = 240;
  options.fisheye = fisheye;
  options.distortion = distortion;
  return synth_lens(options, false);
}

cv::Mat bgr_of(std::vector<std::uint8_t> yuyv, const Lens& lens) {
  CameraFrame frame;
  frame.format = PixelFormat::yuyv;
  frame.width = lens.width();
  frame.height = lens.height();
  frame.stride = std::size_t{2} * lens.width();
  frame.bytes = yuyv;
  cv::Mat out;
  EXPECT_EQ(to_bgr(frame, out), Conversion::ok);
  return out;
}

class LiveViewTest : public HeadlessTest {
 protected:
  cv::Mat seen(const Lens& lens, const Sensor& sensor, std::uint64_t number = 0, double gain = 1) const {
    const auto buffers = std::make_shared<const LabBuffers>(world().live.lab(), world().light, world().irradiance);
    LiveView view(buffers, lens, sensor);
    EXPECT_TRUE(view.draw(world().T_world_camera, world().state, gain, number));
    std::vector<std::uint8_t> yuyv(std::size_t{2} * lens.width() * lens.height());
    EXPECT_TRUE(view.take(yuyv, true));
    EXPECT_FALSE(view.take(yuyv, true));
    return bgr_of(yuyv, lens);
  }
};

TEST_F(LiveViewTest, SeesWhatTheRayCasterSees) {
  struct Case {
    const char* name;
    bool fisheye, distortion;
  };
  for (const Case& c : {Case{"pinhole", false, false}, Case{"distorted", false, true}, Case{"fisheye", true, false}}) {
    SCOPED_TRACE(c.name);
    const Lens lens = lens_of(c.fisheye, c.distortion);
    const Sensor sensor{.vignetting = 0.2};
    const Picture picture = Renderer(world().live.lab(), world().light)
                                .render(RayTable(lens), world().T_world_camera, world().state, world().irradiance);
    const cv::Mat truth = sensor.develop(picture.light, 0, 0), made = seen(lens, sensor);
    const double psnr = cv::PSNR(truth, made);
    RecordProperty(c.name, std::to_string(psnr));
    std::printf("%s: %.2f dB\n", c.name, psnr);
    EXPECT_GT(psnr, 30);
    cv::Scalar mean, deviation;
    cv::meanStdDev(truth, mean, deviation);
    EXPECT_GT(deviation[0], 20);  // there is something to see
    if (const char* folder = std::getenv("FORESIGHT_KEEP_IMAGES")) {
      cv::imwrite(std::string(folder) + "/" + c.name + "_truth.png", truth);
      cv::imwrite(std::string(folder) + "/" + c.name + "_made.png", made);
    }
  }
}

TEST_F(LiveViewTest, HasTheNoiseAskedForAndTheSameEachTime) {
  const Lens lens = lens_of(false, true);
  Sensor sensor;
  const cv::Mat clean = seen(lens, sensor);
  sensor.noise = 4;
  const cv::Mat noisy = seen(lens, sensor, 5), same = seen(lens, sensor, 5), other = seen(lens, sensor, 6);
  EXPECT_EQ(cv::norm(noisy, same, cv::NORM_INF), 0);
  EXPECT_GT(cv::norm(noisy, other, cv::NORM_INF), 4);
  // Of green at mid grey, which subsampled colours hardly smooth.
  double sum = 0;
  int count = 0;
  for (int v = 0; v < clean.rows; ++v)
    for (int u = 0; u < clean.cols; ++u) {
      const cv::Vec3b& c = clean.at<cv::Vec3b>(v, u);
      if (std::abs(c[0] - 128) > 20 || std::abs(c[1] - 128) > 20 || std::abs(c[2] - 128) > 20) continue;
      const double d = noisy.at<cv::Vec3b>(v, u)[1] - c[1];
      sum += d * d;
      ++count;
    }
  ASSERT_GT(count, 500);
  EXPECT_NEAR(std::sqrt(sum / count), 4, 1.5);
}

TEST_F(LiveViewTest, ExposureBrightens) {
  const Lens lens = lens_of(false, true);
  EXPECT_GT(cv::mean(seen(lens, {}, 0, 1.5))[1], cv::mean(seen(lens, {}))[1] + 10);
}

}  // namespace
}  // namespace foresight::sim
