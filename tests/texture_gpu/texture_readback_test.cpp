// What is read back lies where the extraction put it, and counts each point of the surface once.
#include "texture_gpu/texture_readback.hpp"

#include <algorithm>
#include <set>

#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/texture_gpu/reference/atlas_pixels.hpp"
#include "tests/texture_gpu/reference/ray_caster.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::texture_readback_test {
namespace {

/// No rim of the surface within two texels: there the picture's filter mixes in what is beside it.
bool away_from_rims(const ChartTexels& texels, int x, int y) {
  for (int dy = -2; dy <= 2; ++dy)
    for (int dx = -2; dx <= 2; ++dx) {
      if (x + dx < 0 || y + dy < 0 || x + dx >= texels.width() || y + dy >= texels.height()) return false;
      if (!(texels.raster.raw[texels.index(x + dx, y + dy)] & ChartRaster::kCore)) return false;
    }
  return true;
}

/// BGR that tells a point of a node, each axis in steps of 6.25 mm; level faces get whole numbers.
Eigen::Vector3d position_code(const Eigen::Vector3d& p_node) {
  return 128 + 160 * p_node.array();
}

cv::Mat photograph_of_positions(const SceneModel& scene, const SceneState& state, const Lens& lens, const Pose& T) {
  const reference::RayCaster caster(scene, state);
  cv::Mat image(lens.height(), lens.width(), CV_8UC3, cv::Scalar::all(0));
  for (int y = 0; y < image.rows; ++y)
    for (int x = 0; x < image.cols; ++x) {
      const auto hit = caster.cast(T.translation(), T.linear() * *lens.unproject({x, y}), 0.01);
      if (!hit) continue;
      const Eigen::Vector3d code =
          position_code(state.T_world_node[static_cast<std::size_t>(hit->node)].inverse() * hit->p_world);
      for (int c = 0; c < 3; ++c) image.at<cv::Vec3b>(y, x)[c] = cv::saturate_cast<uchar>(code[c]);
    }
  return image;
}

class TextureReadbackTest : public HeadlessTest {
 protected:
  void extract(const std::shared_ptr<const SceneModel>& scene, const std::vector<Pose>& views,
               const PatchOptions& patches = {}, TextureOptions options = {.memory_bytes = 8 << 20}) {
    scene_ = scene;
    surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene, patches));
    options.even_exposure = false;  // positions are no brightness
    options.shadows = false;
    core_ = std::make_unique<TextureCore>(scene, surface_, lens_, std::nullopt, options, driver_.is_software);
    for (const Pose& T_world_camera : views) {
      const SceneState state = state_of(*scene);
      const cv::Mat image = photograph_of_positions(*scene, state, lens_, T_world_camera);
      ASSERT_TRUE(core_->process({{image, state.time, T_world_camera, state}, std::nullopt}, latest_).published);
    }
  }
  TextureReadback read() const { return {*latest_.acquire(), surface_}; }

  /// Calls f(texels, x, y) for every core texel.
  template <typename F>
  void for_core(const TextureReadback& textures, F&& f) const {
    for (int i = 0; i < static_cast<int>(surface_->charts.size()); ++i)
      if (const auto texels = textures.chart(i))
        for (int y = 0; y < texels->height(); ++y)
          for (int x = 0; x < texels->width(); ++x)
            if (texels->core(x, y)) f(*texels, x, y);
  }

  std::shared_ptr<const SceneModel> scene_;
  std::shared_ptr<const SurfacePatches> surface_;
  Lens lens_ = small_lens("plumb_bob");
  LatestTextures latest_;
  std::unique_ptr<TextureCore> core_;
};

TEST_F(TextureReadbackTest, ColoursTellTheTexelsPoint) {
  extract(small_scene(), {usual_view()});
  int seen = 0, off = 0;
  Eigen::Vector3d bias = Eigen::Vector3d::Zero();
  for_core(read(), [&](const ChartTexels& texels, int x, int y) {
    const cv::Vec4b c = texels.colours.at<cv::Vec4b>(y, x);
    if (c[3] != 255 || !away_from_rims(texels, x, y)) return;
    if (at_contact(state_of(*scene_), texels.node(), *texels.point(x, y), 0.03)) return;
    const Eigen::Vector3d difference = Eigen::Vector3d(c[0], c[1], c[2]) - position_code(*texels.point(x, y));
    bias += difference;
    ++seen;
    off += difference.cwiseAbs().maxCoeff() > 2;  // three roundings
  });
  EXPECT_GT(seen, 8000);
  EXPECT_LE(off, seen / 200);
  // Half a texel would be 0.8. Rounding steps of 255/256 to whole ones is off by up to half of one, upwards below the
  // middle of the range and downwards above it; which of them there are more of is left. Renderers that interpolate in
  // 8 bits give whole values back, others 0.1.
  EXPECT_LT((bias / seen).cwiseAbs().maxCoeff(), 0.25) << (bias / seen).transpose();
}

// The points of the published records, which the shaders walk along, and those read back are the same.
TEST_F(TextureReadbackTest, PointsAndColoursAreThoseOfTheShaders) {
  extract(small_scene(), {usual_view(), look_at({-0.2, -1.1, 0.9}, {0.1, 0, 0.1})}, {.chart_extent = 0.2});
  const TextureLease lease = latest_.acquire();
  const reference::Generation generation(*lease, surface_->charts.size());
  const reference::AtlasPixels pixels(*lease->colours);
  const TextureReadback textures(*lease, surface_);
  int guard = 0, states[256] = {};
  for (int i = 0; i < static_cast<int>(surface_->charts.size()); ++i) {
    const reference::ChartCopy& chart = generation.charts[static_cast<std::size_t>(i)];
    const auto texels = textures.chart(i);
    ASSERT_EQ(texels.has_value(), chart.density.x() > 0);
    if (!texels) continue;
    EXPECT_EQ(texels->node(), chart.node);
    for (int y = 0; y < texels->height(); ++y)
      for (int x = 0; x < texels->width(); ++x) {
        const auto point = texels->point(x, y);
        const cv::Vec4b got = texels->colours.at<cv::Vec4b>(y, x);
        ASSERT_EQ(point.has_value(), got[3] != 0);
        ++states[got[3]];
        if (!point) continue;
        const int raw = texels->raster.raw[texels->index(x, y)] & 0x7fff;
        const Eigen::Vector3d expected = chart.origin + x * chart.eu + y * chart.ev + (raw - 1) * chart.eh;
        ASSERT_LT((*point - expected).norm(), 2e-6);  // floats
        guard += !texels->core(x, y);
        const std::uint32_t slot =
            generation.table[static_cast<std::size_t>(chart.first_page + y / 16 * chart.pages.x() + x / 16)];
        if (slot == atlas::kNoSlot) {
          ASSERT_NE(got[3], 255);
          continue;
        }
        const reference::Texel stored = pixels.at(slot, 0, x % 16, y % 16);
        if (stored[3] == 0) continue;
        ASSERT_EQ(got[3], stored[3] > 1 ? 255 : 128);
        for (int c = 0; c < 3; ++c)  // at the exposure of the second image
          ASSERT_NEAR(got[c], stored[2 - c] * generation.display_gain, 1.01);
      }
  }
  EXPECT_GT(guard, 1000);
  EXPECT_GT(states[255], 8000);
  EXPECT_GT(states[128], 1000);
  EXPECT_EQ(states[64], 0) << "every chart has a neighbour that was seen";
}

TEST_F(TextureReadbackTest, CoreTexelsLieOnTheirTriangle) {
  extract(small_scene(), {usual_view()}, {.chart_extent = 0.2});
  for_core(read(), [&](const ChartTexels& texels, int x, int y) {
    const auto& c = surface_->corners[static_cast<std::size_t>(texels.triangle[texels.index(x, y)])];
    const Eigen::Vector3d n = (c[1] - c[0]).cross(c[2] - c[0]), p = *texels.point(x, y);
    EXPECT_LT(std::abs(n.normalized().dot(p - c[0])), 1e-5);  // the step of the heights
    for (std::size_t i = 0; i < 3; ++i)
      EXPECT_GT((c[(i + 1) % 3] - c[i]).cross(p - c[i]).dot(n) / n.squaredNorm(), -1e-4);
  });
}

// Small charts with their overlapping borders, each with a resolution of its own: together they
// cover the surface once.
TEST_F(TextureReadbackTest, CoreTexelsCountTheSurfaceOnce) {
  Lens::Parameters fine;  // texels are as fine as pixels: charts must be many texels wide for this
  fine.width = 1000, fine.height = 800;
  fine.fx = fine.fy = 900, fine.cx = 500, fine.cy = 400;
  lens_ = Lens(fine);
  extract(plane_scene(0.9, 0.7), {look_at({-0.02, 0.01, 1.2}, {0, 0, 0})}, {.chart_extent = 0.11},
          {.texels_per_metre = 480, .memory_bytes = 32 << 20});
  ASSERT_GT(surface_->charts.size(), 50u);
  const TextureReadback textures = read();
  double area = 0, nearly = 0;
  std::set<int> charts;
  for_core(textures, [&](const ChartTexels& texels, int, int) {
    area += texels.metres_per_texel().prod();
    charts.insert(texels.chart);
  });
  for (int i = 0; i < static_cast<int>(surface_->charts.size()); ++i)
    if (const auto texels = textures.chart(i))
      nearly += static_cast<double>(std::count_if(texels->raster.raw.begin(), texels->raster.raw.end(),
                                                  [](std::uint16_t raw) { return raw & ChartRaster::kCore; })) *
                texels->metres_per_texel().prod();
  EXPECT_EQ(charts.size(), surface_->charts.size());
  EXPECT_NEAR(area, 0.9 * 0.7, 0.002 * 0.63);
  EXPECT_GT(nearly, 1.1 * 0.63) << "the charts do overlap";
}

TEST_F(TextureReadbackTest, WithoutAViewThereIsNoColour) {
  extract(small_scene(), {look_at({0, 0, 1}, {0.1, 0, 2})});
  const TextureReadback textures = read();
  for (int i = 0; i < static_cast<int>(surface_->charts.size()); ++i) {
    EXPECT_FALSE(textures.chart(i));
    EXPECT_EQ(textures.mean(i), cv::Vec4b(0, 0, 0, 64));
  }
}

TEST_F(TextureReadbackTest, ItIsACopy) {
  extract(small_scene(), {usual_view()});
  const TextureReadback textures = read();
  const auto first = [&] {
    int i = 0;
    while (!textures.chart(i)) ++i;
    return textures.chart(i)->colours;
  };
  const cv::Mat before = first();
  core_.reset();
  EXPECT_EQ(cv::norm(before, first(), cv::NORM_L1), 0);
}

}  // namespace
}  // namespace foresight::texture_readback_test
