// Textures that hold only what views cannot find in the newest image: all the same, views show what they would if every
// image had been extracted as a whole.
#include <opencv2/imgproc.hpp>

#include "display/predicted_view.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::needed_textures_test {
namespace {

class NeededTextures : public HeadlessTest {
 protected:
  struct Extraction {
    Extraction(const NeededTextures& test, bool only_what_is_needed, int images_to_rewrite = 1)
        : core(test.scene_, test.surface_, test.lens_, test.right_,
               TextureOptions{.memory_bytes = 12 << 20,
                              .even_exposure = false,
                              .only_what_is_needed = only_what_is_needed,
                              .images_to_rewrite = images_to_rewrite,
                              .shadows = false},
               test.driver_.is_software) {}
    void extract() { written += core.extract(textures, &images).texels_written; }
    void take(const PosedFrame& frame) {
      core.look(frame, images);
      extract();
    }
    TextureCore core;
    LatestTextures textures;
    LatestImages images;
    std::size_t written = 0;
  };

  /// Around the table, while the block moves on it. Darker from image to image: brightness tells which one a colour is
  /// from.
  static Pose camera(int i) { return look_at({-0.9 + 0.04 * i, -0.8 + 0.01 * i, 0.75}, {0.03 * i - 0.2, 0.05, 0.1}); }
  static SceneState state(const SceneModel& scene, int i) { return state_of(scene, 0.03 * i); }
  static double gain_of(int i) { return 1 - 0.04 * i; }
  PosedFrame frame(int i) const {
    const double gain = gain_of(i);
    PosedFrame out{posed_photograph(*scene_, state(*scene_, i), lens_, camera(i), gain), std::nullopt};
    if (right_) {
      Pose T_left_right = Pose::Identity();
      T_left_right.translation().x() = 0.12;
      out.right = posed_photograph(*scene_, state(*scene_, i), *right_, camera(i) * T_left_right, gain);
    }
    return out;
  }
  cv::Mat drawn(PredictedView& view, const Extraction& of, const Pose& T_world_camera, int i) const {
    view.draw(T_world_camera, state(*scene_, i), *of.textures.acquire(), *of.images.acquire());
    return view.read();
  }
  cv::Mat drawn(PredictedView& view, const Extraction& of, int i) const { return drawn(view, of, camera(i), i); }

  /// Pixels of another kind, or another image's colour, as shares of those that show the model.
  struct Difference {
    double all = 0;
    double areas = 0;  ///< of at least 3x3 pixels; the others are fringes of silhouettes
  };
  /// `brighter`: a's colour may be so many times b's, or anything between.
  static Difference difference(const cv::Mat& a, const cv::Mat& b, double brighter = 1) {
    cv::Mat differ(a.size(), CV_8U, cv::Scalar::all(0)), areas;
    double model = 0;
    for (int y = 0; y < a.rows; ++y)
      for (int x = 0; x < a.cols; ++x) {
        const cv::Vec4b& p = a.at<cv::Vec4b>(y, x);
        const cv::Vec4b& q = b.at<cv::Vec4b>(y, x);
        if (q[3] == 0) continue;
        ++model;
        bool other = p[3] != q[3];
        for (int c = 0; c < 3 && q[3] == 255; ++c) other = other || p[c] < q[c] - 4 || p[c] > brighter * q[c] + 4;
        differ.at<uchar>(y, x) = other;
      }
    cv::morphologyEx(differ, areas, cv::MORPH_OPEN, cv::Mat::ones(3, 3, CV_8U));
    return {cv::countNonZero(differ) / std::max(model, 1.0), cv::countNonZero(areas) / std::max(model, 1.0)};
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  Lens lens_ = small_lens("plumb_bob");
  std::optional<Lens> right_;
};

TEST_F(NeededTextures, ViewsAreWhatTheyWouldBe) {
  Extraction needed(*this, true), all(*this, false);
  PredictedView view(std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens_);
  view.mix_silhouettes(false);  // what is looked up is compared
  const auto compare = [&](int i, const char* when, double most_areas) {
    if (i < 2) return;
    for (const int of : {i - 2, i + 1, i + 4}) {
      const Difference d = difference(drawn(view, needed, of), drawn(view, all, of));
      // Towards the image's rim, older images are mixed in.
      EXPECT_LT(d.areas, most_areas) << "image " << i << " from where image " << of << " is taken, " << when;
      // What an edge keeps from being seen well takes its colour from texels around it, which may be older here.
      EXPECT_LT(d.all, 0.04) << "image " << i << " from where image " << of << " is taken, " << when;
    }
  };
  std::size_t first = 0, first_of_all = 0;
  for (int i = 0; i < 12; ++i) {
    needed.core.look(frame(i), needed.images);
    all.core.look(frame(i), all.images);
    EXPECT_EQ(bool(needed.images.acquire()) && needed.images.acquire()->before, i >= 2);
    compare(i, "before its textures", 0.005);
    needed.extract();
    all.extract();
    // The image before is not there any more; of each tile that it shows the textures took what was found to leave.
    compare(i, "with its textures", 0.01);
    if (i == 0) first = needed.written, first_of_all = all.written;
  }
  EXPECT_FALSE(needed.images.acquire()->before) << "what it shows is in the textures";
  EXPECT_FALSE(all.images.acquire()->before);
  EXPECT_EQ(first, first_of_all);
  EXPECT_LT(3 * (needed.written - first), 2 * (all.written - first_of_all)) << "of pictures that are all edges";
}

TEST_F(NeededTextures, ColoursStayForSomeImages) {
  constexpr int kStay = 2;
  Extraction each(*this, true), some(*this, true, kStay);
  PredictedView view(std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens_);
  view.mix_silhouettes(false);  // what is looked up is compared
  for (int i = 0; i < 12; ++i) {
    each.take(frame(i));
    some.take(frame(i));
    if (i < kStay) continue;
    for (const int of : {i - 2, i + 1, i + 4}) {
      const cv::Mat stayed = drawn(view, some, of), renewed = drawn(view, each, of);
      const Difference d = difference(stayed, renewed, gain_of(i - kStay) / gain_of(i));
      EXPECT_LT(d.areas, 0.002) << "older: image " << i << " from where image " << of << " is taken";
      EXPECT_LT(d.all, 0.006) << "older: image " << i << " from where image " << of << " is taken";
    }
  }
  EXPECT_LT(20 * some.written, 19 * each.written);
}

// Images are looked up from there, too, though a pixel of the view holds several of theirs.
TEST_F(NeededTextures, AViewFromFartherAwayIsAsNew) {
  Extraction needed(*this, true), all(*this, false);
  PredictedView view(std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens_);
  view.mix_silhouettes(false);  // what is looked up is compared
  for (int i = 0; i < 8; ++i) {
    needed.take(frame(i));
    all.take(frame(i));
  }
  for (const double share : {0.7, 1.1}) {
    Pose from = camera(7);
    from.translate(Eigen::Vector3d(0, 0, -share));
    const Difference d = difference(drawn(view, needed, from, 7), drawn(view, all, from, 7));
    EXPECT_LT(d.areas, 0.02) << share;
    EXPECT_LT(d.all, 0.1) << share;
  }
}

// Views look the left image up: what the right one sees beside is extracted at once.
TEST_F(NeededTextures, ARightImageIsNotLost) {
  right_ = lens_;
  Extraction needed(*this, true), all(*this, false);
  PredictedView view(std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_), lens_);
  view.mix_silhouettes(false);  // what is looked up is compared
  for (int i = 0; i < 5; ++i) {
    needed.take(frame(i));
    all.take(frame(i));
  }
  const Difference d = difference(drawn(view, needed, 5), drawn(view, all, 5));
  EXPECT_LT(d.areas, 0.005);
  EXPECT_LT(d.all, 0.04);
}

}  // namespace
}  // namespace foresight::needed_textures_test
