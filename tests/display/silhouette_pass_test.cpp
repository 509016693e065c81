// Where a surface ends before another one, pixels hold some of both; all others stay as they were.
#include "display/silhouette_pass.hpp"

#include <map>
#include <random>

#include "gl/camera_block.hpp"
#include "gl/lens_rays.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/texture_gpu/reference/ray_caster.hpp"

namespace foresight::silhouette_pass_test {
namespace {

class Silhouettes : public HeadlessTest, public testing::WithParamInterface<const char*> {
 protected:
  cv::Mat mixed(const cv::Mat& picture) const {
    gl::RasterPass raster(std::make_shared<gl::SceneBuffers>(*scene_), true);
    const gl::FaceImages faces(gl::faces_for(lens_, 2), true);
    raster(usual_view(), state_, faces);
    const gl::CameraBlock block = gl::make_camera_block(lens_, faces.faces);
    gl::Buffer camera(sizeof block, "camera");
    camera.write(std::span(&block, 1));
    const gl::Texture rays = gl::make_lens_rays(lens_), out(GL_RGBA8, picture.cols, picture.rows, 0, 1, "picture");
    glTextureSubImage2D(out.name(), 0, 0, 0, picture.cols, picture.rows, GL_BGRA, GL_UNSIGNED_BYTE, picture.data);
    SilhouettePass pass(lens_);
    pass({lens_, camera, faces, rays, out});
    glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
    cv::Mat read(picture.size(), CV_8UC4);
    glGetTextureImage(out.name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(read.total() * 4), read.data);
    return read;
  }
  /// Colours and kinds of pixels as chance has them; some have no colour.
  cv::Mat noise() const {
    cv::Mat out(lens_.height(), lens_.width(), CV_8UC4);
    std::mt19937 random(3);
    for (auto& pixel : cv::Mat_<cv::Vec4b>(out)) {
      for (int c = 0; c < 3; ++c) pixel[c] = static_cast<uchar>(random() % 256);
      pixel[3] = std::array<uchar, 4>{255, 255, 128, 64}[random() % 4];
    }
    return out;
  }
  struct Sight {
    int node = -1;
    double distance = 1e9;
  };
  Sight sight(int x, int y) const {
    const auto ray = lens_.unproject({x, y});
    if (!ray) return {};
    const Pose eye = usual_view();
    const auto hit = caster_.cast(eye.translation(), eye.linear() * *ray, gl::kNearPlane);
    return hit ? Sight{hit->node, (hit->p_world - eye.translation()).norm()} : Sight{};
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  const SceneState state_ = state_of(*scene_);
  const reference::RayCaster caster_{*scene_, state_};
  const Lens lens_ = small_lens(GetParam());
};

cv::Vec3d mean_around(const cv::Mat& picture, int x, int y) {
  cv::Vec3d sum;
  double all = 0;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= picture.cols || y + dy >= picture.rows) continue;
      const auto& pixel = picture.at<cv::Vec4b>(y + dy, x + dx);
      if (pixel[3] < 128) continue;
      const double weight = std::pow(0.25, (dx != 0) + (dy != 0));
      sum += weight * cv::Vec3d(pixel[0], pixel[1], pixel[2]);
      all += weight;
    }
  return sum / all;
}

TEST_P(Silhouettes, AreMixedAndNothingElseIs) {
  const cv::Mat before = noise(), after = mixed(before);
  int beside_steps = 0, left_out = 0, far_from_them = 0;
  for (int y = 4; y < before.rows - 4; ++y)
    for (int x = 4; x < before.cols - 4; ++x) {
      const auto &was = before.at<cv::Vec4b>(y, x), &is = after.at<cv::Vec4b>(y, x);
      ASSERT_EQ(is[3], was[3]);
      const cv::Vec3d now(is[0], is[1], is[2]), mean = mean_around(before, x, y);
      const bool same = is == was;
      if (was[3] < 128) {
        ASSERT_TRUE(same) << "without a colour: " << x << " " << y;
        continue;
      }
      ASSERT_TRUE(same || cv::norm(now - mean, cv::NORM_INF) <= 1.01) << x << " " << y;
      const Sight here = sight(x, y);
      const auto is_another = [&](int dx, int dy) {
        const Sight there = sight(x + dx, y + dy);
        return here.node >= 0 && there.node >= 0 && std::abs(there.distance - here.distance) > 0.15;
      };
      if (is_another(1, 0) || is_another(-1, 0) || is_another(0, 1) || is_another(0, -1)) {
        ++beside_steps;
        left_out += same;
        continue;
      }
      bool alone = true;
      for (int i = 0; i < 81 && alone; ++i) alone = sight(x + i % 9 - 4, y + i / 9 - 4).node == here.node;
      if (!alone) continue;
      ++far_from_them;
      EXPECT_TRUE(same) << "node " << here.node << " all around: " << x << " " << y;
    }
  EXPECT_GT(beside_steps, 60);
  EXPECT_GT(far_from_them, 2000);
  // A face's pixels are not those of the picture where the lens bends it.
  EXPECT_LE(left_out, GetParam() == std::string("pinhole") ? 0 : beside_steps / 8) << "of " << beside_steps;
}

INSTANTIATE_TEST_SUITE_P(Lenses, Silhouettes, testing::Values("pinhole", "plumb_bob", "wide_fisheye"),
                         [](const auto& i) { return std::string(i.param); });

}  // namespace
}  // namespace foresight::silhouette_pass_test
