// The picture of all textures shows at each point's place what the textures hold there.
#include "texture_gpu/baked_atlas.hpp"

#include <opencv2/imgproc.hpp>
#include <random>

#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/gltf_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::baked_atlas_test {
namespace {

constexpr int kLargest = 4096;

/// Calls f(x, y, weight) for the four neighbours of a place, centres at integers.
template <typename F>
void bilinear(const Eigen::Vector2d& at, const cv::Mat& picture, F&& f) {
  const Eigen::Vector2d base = at.array().floor(), part = at - base;
  for (int i = 0; i < 4; ++i)
    f(std::clamp(static_cast<int>(base.x()) + (i & 1), 0, picture.cols - 1),
      std::clamp(static_cast<int>(base.y()) + (i >> 1), 0, picture.rows - 1),
      (i & 1 ? part.x() : 1 - part.x()) * (i >> 1 ? part.y() : 1 - part.y()));
}

class BakedAtlasTest : public HeadlessTest {
 protected:
  void extract(const std::vector<Pose>& views) {
    TextureCore core(scene_, surface_, lens_, std::nullopt, {.memory_bytes = 8 << 20}, driver_.is_software);
    LatestTextures latest;
    double gain = 1;
    for (const Pose& view : views) {
      core.process({posed_photograph(*scene_, state_of(*scene_), lens_, view, gain), std::nullopt}, latest);
      gain *= 0.9;
    }
    const TextureLease lease = latest.acquire();
    display_gain_ = lease->display_gain;
    textures_.emplace(*lease, surface_);
  }

  struct SurfacePoint {
    int patch, node;
    Eigen::Vector3d p;
  };
  /// Evenly over the triangles, not over their area: small ones count as much.
  std::vector<SurfacePoint> points(int count) const {
    std::mt19937 random(1);
    std::uniform_real_distribution<double> part(0, 1);
    std::vector<SurfacePoint> out;
    for (int i = 0; i < count; ++i) {
      const std::size_t t = random() % surface_->corners.size();
      double b = part(random), c = part(random);
      if (b + c > 1) b = 1 - b, c = 1 - c;
      const auto& corner = surface_->corners[t];
      const int patch = surface_->patch_of_triangle[t];
      out.push_back({patch, surface_->patches[static_cast<std::size_t>(patch)].node,
                     (1 - b - c) * corner[0] + b * corner[1] + c * corner[2]});
    }
    return out;
  }

  /// What a view shows at a point, from the texels of its chart; alpha 255 where most of it was seen.
  cv::Vec4d stored(const SurfacePoint& point) {
    const Patch& patch = surface_->patches[static_cast<std::size_t>(point.patch)];
    const Eigen::Vector3d p = point.p - patch.origin;
    const Eigen::Vector2d uv(p.dot(patch.eu), p.dot(patch.ev));
    const Eigen::Array2i cell =
        (uv.array() / patch.cell_size().array()).floor().cast<int>().max(0).min(patch.cells.array() - 1);
    const int index = patch.first_chart + cell.y() * patch.cells.x() + cell.x();
    cv::Vec4d sum(0, 0, 0, 0);
    double weight = 0;
    if (textures_->resolution(index).x() > 0) {
      if (!charts_.count(index)) charts_.emplace(index, *textures_->chart(index));
      const ChartTexels& texels = charts_.at(index);
      bilinear((uv - texels.raster.uv0).cwiseProduct(texels.raster.density), texels.colours,
               [&](int x, int y, double w) {
                 const cv::Vec4b c = texels.colours.at<cv::Vec4b>(y, x);
                 if (c[3] < 128) return;
                 sum += w * cv::Vec4d(c);
                 weight += w;
               });
    }
    return weight > 0 ? sum / weight : cv::Vec4d(textures_->mean(index));
  }

  static Eigen::Vector3d sample(const cv::Mat& level, const Eigen::Vector2d& texcoord) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    bilinear(texcoord.cwiseProduct(Eigen::Vector2d(level.cols, level.rows)) - Eigen::Vector2d(0.5, 0.5), level,
             [&](int x, int y, double w) {
               const cv::Vec3b c = level.at<cv::Vec3b>(y, x);
               sum += w * Eigen::Vector3d(c[0], c[1], c[2]);
             });
    return sum;
  }

  /// Mean over the points of the largest difference of the three colours, and the share above 12.
  std::pair<double, double> error(const BakedAtlas& atlas, const cv::Mat& level) {
    double sum = 0, wrong = 0;
    const auto all = points(4000);
    for (const SurfacePoint& point : all) {
      if (at_contact(state_of(*scene_), point.node, point.p, 0.04)) continue;  // colours of two surfaces side by side
      const cv::Vec4d expected = stored(point);
      if (expected[3] < 128) continue;
      const Eigen::Vector3d got = sample(level, atlas.texcoord(*surface_, point.patch, point.p));
      const double off = (got - Eigen::Vector3d(expected[0], expected[1], expected[2])).cwiseAbs().maxCoeff();
      sum += off;
      wrong += off > 12;
    }
    return {sum / static_cast<double>(all.size()), wrong / static_cast<double>(all.size())};
  }

  static cv::Mat next_level(const cv::Mat& level) {
    cv::Mat out;
    cv::resize(level, out, {level.cols / 2, level.rows / 2}, 0, 0, cv::INTER_AREA);
    return out;
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ =
      std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {.chart_extent = 0.2}));
  Lens lens_ = small_lens("plumb_bob");
  std::optional<TextureReadback> textures_;
  float display_gain_ = 1;
  std::map<int, ChartTexels> charts_;
};

TEST_F(BakedAtlasTest, ShowsWhatTheTexturesHold) {
  extract({usual_view(), look_at({-0.97, -0.48, 0.8}, {0.02, 0, 0.1}), look_at({-0.94, -0.51, 0.8}, {0.02, 0, 0.1})});
  ASSERT_NEAR(display_gain_, 0.81, 0.02);
  const BakedAtlas atlas = bake_atlas(*textures_, kLargest);
  EXPECT_EQ(atlas.scale, 1);
  const auto [mean, wrong] = error(atlas, atlas.colours);
  EXPECT_LT(mean, 0.7);  // rounding, twice
  EXPECT_LT(wrong, 0.005);
  // Coarser levels blur, also over the folds between charts, but never take in another patch.
  const cv::Mat level1 = next_level(atlas.colours), level2 = next_level(level1);
  EXPECT_LT(error(atlas, level1).first, 1.6);
  EXPECT_LT(error(atlas, level2).first, 3);
  EXPECT_LT(error(atlas, level2).second, 0.045);
}

TEST_F(BakedAtlasTest, NoFilterReachesAnotherPatch) {
  extract({usual_view()});
  const BakedAtlas atlas = bake_atlas(*textures_, kLargest);
  EXPECT_EQ(atlas.colours.cols % 4 + atlas.colours.rows % 4, 0);
  cv::Mat taken(atlas.colours.size(), CV_8U, cv::Scalar(0));
  for (std::size_t i = 0; i < surface_->patches.size(); ++i) {
    const BakedAtlas::Place& place = atlas.places[i];
    EXPECT_EQ(cv::countNonZero(taken(place.rectangle)), 0);
    taken(place.rectangle).setTo(1);
    for (int level = 0; level <= 2; ++level) {
      const double side = 1 << level;
      const Eigen::Array2d from = place.corner,
                           to = from + (surface_->patches[i].size.cwiseProduct(place.density)).array();
      const Eigen::Array2d first = ((from / side - 0.5).floor()) * side, last = ((to / side - 0.5).floor() + 2) * side;
      EXPECT_GE(first.x(), place.rectangle.x);
      EXPECT_GE(first.y(), place.rectangle.y);
      EXPECT_LE(last.x(), place.rectangle.br().x);
      EXPECT_LE(last.y(), place.rectangle.br().y);
    }
  }
}

// The corner of an L is a cell without surface; filters at its rim still find the L's colours.
TEST_F(BakedAtlasTest, CellsWithoutSurfaceContinueTheirNeighbours) {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.8F, 0, 0}, {0.8F, 0.2F, 0}, {0.2F, 0.2F, 0}, {0.2F, 0.8F, 0}, {0, 0.8F, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}, {0, 3, 5}, {3, 4, 5}};
  scene_ = std::make_shared<SceneModel>(std::vector<Node>{{"L", mesh, -1, Pose::Identity()}});
  surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {.chart_extent = 0.1}));
  ASSERT_EQ(surface_->patches.size(), 1u);
  ASSERT_TRUE(
      std::any_of(surface_->charts.begin(), surface_->charts.end(), [](const Chart& c) { return c.radius == 0; }));
  extract({look_at({0.2, 0.3, 1.3}, {0.3, 0.3, 0})});
  const BakedAtlas atlas = bake_atlas(*textures_, kLargest);
  const cv::Mat rectangle = atlas.colours(atlas.places[0].rectangle);
  for (int y = 0; y < rectangle.rows; ++y)
    for (int x = 0; x < rectangle.cols; ++x)
      ASSERT_NE(rectangle.at<cv::Vec3b>(y, x), cv::Vec3b(128, 128, 128)) << "grey at " << x << ", " << y;
}

TEST_F(BakedAtlasTest, IsScaledDownToFit) {
  extract({usual_view()});
  const BakedAtlas full = bake_atlas(*textures_, kLargest);
  const int most = std::max(full.colours.cols, full.colours.rows) / 2;
  const BakedAtlas small = bake_atlas(*textures_, most);
  EXPECT_LT(small.scale, 0.7);
  EXPECT_LE(std::max(small.colours.cols, small.colours.rows), most);
  EXPECT_LT(error(small, small.colours).first, 3);
  EXPECT_THROW(bake_atlas(*textures_, 40), InputError);
}

TEST_F(BakedAtlasTest, WhatWasNeverSeenIsGrey) {
  extract({look_at({0, 0, 1}, {0.1, 0, 2})});
  const BakedAtlas atlas = bake_atlas(*textures_, kLargest);
  EXPECT_EQ(cv::norm(atlas.colours, cv::Mat(atlas.colours.size(), CV_8UC3, cv::Scalar::all(128)), cv::NORM_INF), 0);
}

TEST_F(BakedAtlasTest, NodesKeepTheirTrianglesAndPoses) {
  extract({usual_view()});
  const BakedAtlas atlas = bake_atlas(*textures_, kLargest);
  const SceneState state = state_of(*scene_, 0.1);
  const auto nodes = gltf_nodes(*scene_, state, *surface_, atlas);
  ASSERT_EQ(nodes.size(), scene_->nodes().size());
  for (std::size_t n = 0; n < nodes.size(); ++n) {
    const Mesh& mesh = scene_->nodes()[n].mesh;
    EXPECT_TRUE(nodes[n].T_world_node.isApprox(state.T_world_node[n]));
    ASSERT_EQ(nodes[n].triangles.size(), mesh.triangles.size());
    ASSERT_EQ(nodes[n].vertices.size(), nodes[n].texcoords.size());
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
      for (std::size_t i = 0; i < 3; ++i)
        EXPECT_EQ(nodes[n].vertices[nodes[n].triangles[t][i]], mesh.vertices[mesh.triangles[t][i]]);
    for (const Eigen::Vector2f& texcoord : nodes[n].texcoords)
      EXPECT_TRUE((texcoord.array() > 0).all() && (texcoord.array() < 1).all());
  }
}

}  // namespace
}  // namespace foresight::baked_atlas_test
