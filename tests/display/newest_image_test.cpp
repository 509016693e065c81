// The newest image looked up directly: where it saw a point, its own colour is shown, and nothing else has changed.
#include <array>
#include <map>
#include <opencv2/imgproc.hpp>
#include <optional>

#include "display/predicted_view.hpp"
#include "pictures/view_alpha.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"
#include "tests/texture_gpu/reference/ray_caster.hpp"
#include "texture_gpu/texture_core.hpp"

namespace foresight::newest_image_test {
namespace {

/// Red and blue change places: a colour tells which image it is from.
cv::Vec3d other_hue(const Eigen::Vector3d& bgr) {
  return {255 * bgr.z(), 255 * bgr.y(), 255 * bgr.x()};
}

struct Kinds {
  const char* image;
  const char* view;
};

class NewestImage : public HeadlessTest, public testing::WithParamInterface<Kinds> {
 protected:
  void SetUp() override {
    HeadlessTest::SetUp();
    if (IsSkipped()) return;
    core_ = std::make_unique<TextureCore>(scene_, surface_, small_lens(GetParam().image), std::nullopt,
                                          TextureOptions{.memory_bytes = 6 << 20, .even_exposure = false},
                                          driver_.is_software);
  }
  PosedFrame seen_from(const Pose& T_world_camera, const SceneState& state) const {
    return {posed_photograph(*scene_, state, small_lens(GetParam().image), T_world_camera), std::nullopt};
  }
  PredictedView view() const {
    return {std::make_shared<gl::SceneBuffers>(*scene_), std::make_shared<SurfaceRecords>(*surface_),
            small_lens(GetParam().view)};
  }

  std::shared_ptr<const SceneModel> scene_ = small_scene();
  std::shared_ptr<const SurfacePatches> surface_ = std::make_shared<SurfacePatches>(find_surface_patches(*scene_, {}));
  std::unique_ptr<TextureCore> core_;
  LatestTextures textures_;
  LatestImages images_;
};

/// A point that a view's pixel shows.
struct Shown {
  int node;
  Eigen::Vector3d p_node;
  std::array<Eigen::Vector3d, 4> around;  // of the same node, half a pixel to the left, right, above, below
};

/// What the image's camera has in view, judged by rays alone.
class Witness {
 public:
  Witness(const SceneModel& scene, const SceneState& state, const Lens& lens, const Pose& T_world_camera)
      : caster_(scene, state), state_(state), lens_(lens), T_world_camera_(T_world_camera) {}

  enum class Answer { seen, hidden, hard_to_say };
  /// `p` of a node.
  Answer sees(const Eigen::Vector3d& p_node, int node) const {
    const Eigen::Vector3d p = state_.T_world_node[static_cast<std::size_t>(node)] * p_node;
    const auto pixel = lens_.project(T_world_camera_.inverse() * p);
    constexpr double kBeside = 4, kRim = 8;  // px
    if (!pixel || pixel->x() < -1 || pixel->y() < -1 || pixel->x() > lens_.width() || pixel->y() > lens_.height())
      return Answer::hidden;
    if (pixel->x() < kRim || pixel->y() < kRim || pixel->x() > lens_.width() - kRim ||
        pixel->y() > lens_.height() - kRim)
      return Answer::hard_to_say;
    int same = 0, others = 0;
    for (int i = 0; i < 9; ++i) {
      const auto ray = lens_.unproject(*pixel + kBeside * Eigen::Vector2d(i % 3 - 1, i / 3 - 1));
      if (!ray) return Answer::hard_to_say;
      const auto hit = caster_.cast(T_world_camera_.translation(), T_world_camera_.linear() * *ray, gl::kNearPlane);
      const bool near = hit && hit->node == node && (hit->p_world - p).norm() < 0.15;
      const bool before = hit && (hit->p_world - T_world_camera_.translation()).norm() + 0.05 <
                                     (p - T_world_camera_.translation()).norm();
      same += near && !before;
      others += before;
    }
    return same == 9 ? Answer::seen : others == 9 ? Answer::hidden : Answer::hard_to_say;
  }

  /// How far apart the image shows what the view shows a pixel apart: the root of an area.
  double pixels_between(const Shown& point) const;

 private:
  reference::RayCaster caster_;
  SceneState state_;
  Lens lens_;
  Pose T_world_camera_;
};

double Witness::pixels_between(const Shown& point) const {
  const auto project = [&](std::size_t i) {
    const Eigen::Vector3d p = state_.T_world_node[static_cast<std::size_t>(point.node)] * point.around[i];
    return lens_.project(T_world_camera_.inverse() * p).value_or(Eigen::Vector2d::Zero());
  };
  Eigen::Matrix2d area;
  area << project(1) - project(0), project(3) - project(2);
  return std::sqrt(std::abs(area.determinant()));
}

/// Nothing where another renderer might show another triangle.
std::optional<Shown> shown_at(const reference::RayCaster& caster, const SceneState& state, const Lens& lens,
                              const Pose& T_world_camera, const Eigen::Vector2d& pixel) {
  const auto hit_at = [&](double dx, double dy) {
    const auto ray = lens.unproject(pixel + Eigen::Vector2d(dx, dy));
    return ray ? caster.cast(T_world_camera.translation(), T_world_camera.linear() * *ray, gl::kNearPlane)
               : std::nullopt;
  };
  const auto hit = hit_at(0, 0);
  if (!hit) return std::nullopt;
  for (int i = 0; i < 4; ++i) {
    const auto beside = hit_at(i % 2 ? 1.5 : -1.5, i / 2 ? 1.5 : -1.5);
    if (!beside || beside->triangle != hit->triangle) return std::nullopt;
  }
  const Pose T_node_world = state.T_world_node[static_cast<std::size_t>(hit->node)].inverse();
  const auto around = [&](double dx, double dy) { return (T_node_world * hit_at(dx, dy)->p_world).eval(); };
  return Shown{
      hit->node, T_node_world * hit->p_world, {around(-0.5, 0), around(0.5, 0), around(0, -0.5), around(0, 0.5)}};
}

struct Count {
  int seen = 0, wrong = 0, hidden = 0, changed = 0;
};

void compare(const Witness& witness, const Shown& point, const cv::Vec4b& with, const cv::Vec4b& without,
             Count& count) {
  const Witness::Answer answer = witness.sees(point.p_node, point.node);
  if (answer == Witness::Answer::hidden) {
    ++count.hidden;
    count.changed += cv::norm(with, without, cv::NORM_INF) > 1;
  }
  // Shown far coarser or finer than it was seen, it comes from the textures.
  const double pixels = witness.pixels_between(point);
  if (answer != Witness::Answer::seen || pixels < 0.4 || pixels > 1.2) return;
  ++count.seen;
  const cv::Vec3d difference = cv::Vec3d(with[0], with[1], with[2]) - other_hue(paint(point.node, point.p_node));
  count.wrong += with[3] != 255 || cv::norm(difference, cv::NORM_INF) > 8;
}

TEST_P(NewestImage, IsShownWhereItSawAPoint) {
  const SceneState before = state_of(*scene_), then = state_of(*scene_, 0.1), shown = state_of(*scene_, 0.2);
  core_->process(seen_from(look_at({-0.5, -1.1, 0.9}, {0.1, 0, 0.1}), before), textures_);
  core_->process(seen_from(usual_view(), before), textures_);
  PosedFrame newest = seen_from(usual_view(), then);
  cv::cvtColor(newest.left.pixels, newest.left.pixels, cv::COLOR_BGR2RGB);
  ASSERT_TRUE(core_->look(newest, images_));
  const ImagesLease image = images_.acquire();
  const TextureLease textures = textures_.acquire();
  ASSERT_TRUE(image);

  PredictedView with = view(), without = view();
  const Lens lens = small_lens(GetParam().view);
  const Witness witness(*scene_, then, small_lens(GetParam().image), usual_view());
  const reference::RayCaster caster(*scene_, shown);
  Count count;
  for (const Pose& T_world_camera :
       {look_at({-0.7, -0.9, 0.75}, {0, 0, 0.1}), look_at({-0.4, -0.9, 0.5}, {0.1, 0, 0.1})}) {
    with.draw(T_world_camera, shown, *textures, *image);
    without.draw(T_world_camera, shown, *textures);
    const cv::Mat picture = with.read(), old = without.read();
    for (int y = 2; y < picture.rows - 2; y += 2)
      for (int x = 2; x < picture.cols - 2; x += 2)
        if (const auto point = shown_at(caster, shown, lens, T_world_camera, {x, y}))
          compare(witness, *point, picture.at<cv::Vec4b>(y, x), old.at<cv::Vec4b>(y, x), count);
  }
  EXPECT_GT(count.seen, 100);
  EXPECT_GT(count.hidden, 20);
  EXPECT_LE(count.wrong, count.seen / 200);
  EXPECT_EQ(count.changed, 0);
}

// Before and after it has become textures.
// Of both images and of textures, in bands, each when a gate lets it, it is the same picture.
TEST_P(NewestImage, BandsAreOnePicture) {
  const SceneState state = state_of(*scene_);
  for (const Pose& T_world_camera : {usual_view(), look_at({-0.5, -1.1, 0.9}, {0.1, 0, 0.1})}) {
    core_->look(seen_from(T_world_camera, state), images_);
    core_->extract(textures_);
  }
  ASSERT_TRUE(core_->look(seen_from(look_at({-0.4, -0.4, 0.4}, {0.1, 0, 0.1}), state), images_));
  const ImagesLease images = images_.acquire();
  ASSERT_TRUE(images && images->before);
  PredictedView whole = view(), banded = view();
  MonotonicClock clock;
  FrameGate gate(clock);
  banded.use(&gate);
  whole.draw(usual_view(), state, *textures_.acquire(), *images);
  for (int i = 0; i < 2; ++i)  // what bands cost is not known at first: they are as large as it goes
    banded.draw(usual_view(), state, *textures_.acquire(), *images);
  EXPECT_EQ(cv::norm(whole.read(), banded.read(), cv::NORM_INF), 0);
}

TEST_P(NewestImage, WhatItDoesNotSeeTheImageBeforeShows) {
  const SceneState state = state_of(*scene_);
  const Pose from_before = usual_view(), from_newest = look_at({-0.4, -0.4, 0.4}, {0.1, 0, 0.1});
  core_->process(seen_from(from_before, state), textures_);
  PosedFrame before = seen_from(from_before, state);
  cv::cvtColor(before.left.pixels, before.left.pixels, cv::COLOR_BGR2RGB);
  ASSERT_TRUE(core_->look(before, images_));
  core_->extract(textures_);
  ASSERT_TRUE(core_->look(seen_from(from_newest, state), images_));

  const Lens lens = small_lens(GetParam().view), image_lens = small_lens(GetParam().image);
  const Witness witness_before(*scene_, state, image_lens, from_before),
      witness_newest(*scene_, state, image_lens, from_newest);
  const reference::RayCaster caster(*scene_, state);
  PredictedView drawn = view();
  const auto expect_image_before = [&](const char* when) {
    drawn.draw(from_before, state, *textures_.acquire(), *images_.acquire());
    const cv::Mat picture = drawn.read();
    int shown = 0, wrong = 0;
    for (int y = 2; y < picture.rows - 2; y += 2)
      for (int x = 2; x < picture.cols - 2; x += 2) {
        const auto point = shown_at(caster, state, lens, from_before, {x, y});
        if (!point || witness_newest.sees(point->p_node, point->node) != Witness::Answer::hidden ||
            witness_before.sees(point->p_node, point->node) != Witness::Answer::seen)
          continue;
        const cv::Vec4b& pixel = picture.at<cv::Vec4b>(y, x);
        ++shown;
        wrong += cv::norm(cv::Vec3d(pixel[0], pixel[1], pixel[2]) - other_hue(paint(point->node, point->p_node)),
                          cv::NORM_INF) > 8;
      }
    EXPECT_GT(shown, 100) << when;
    EXPECT_LE(wrong, shown / 100) << when;
  };
  expect_image_before("before its textures");
  ASSERT_TRUE(images_.acquire()->before);
  core_->extract(textures_, &images_);
  EXPECT_FALSE(images_.acquire()->before) << "textures hold it";
  expect_image_before("with its textures");
}

/// Least and largest value of each colour in the 4x4 pixels around a place.
std::array<cv::Vec3b, 2> range_around(const cv::Mat& image, const Eigen::Vector2d& pixel) {
  std::array<cv::Vec3b, 2> out{cv::Vec3b::all(255), cv::Vec3b::all(0)};
  for (int i = 0; i < 16; ++i) {
    const int x = static_cast<int>(std::floor(pixel.x())) + i % 4 - 1,
              y = static_cast<int>(std::floor(pixel.y())) + i / 4 - 1;
    const auto& value = image.at<cv::Vec3b>(std::clamp(y, 0, image.rows - 1), std::clamp(x, 0, image.cols - 1));
    for (int c = 0; c < 3; ++c) {
      out[0][c] = std::min(out[0][c], value[c]);
      out[1][c] = std::max(out[1][c], value[c]);
    }
  }
  return out;
}

// Outermost pixels of what stands in front may show what is behind it: rather than fills, but not rather than what
// another image has seen well.
TEST_P(NewestImage, UncertainPixelsAreShownWhereNothingElseSawThePoint) {
  const SceneState state = state_of(*scene_);
  const Lens image_lens = small_lens(GetParam().image), view_lens = small_lens(GetParam().view);
  core_->process(seen_from(usual_view(), state), textures_);
  PosedFrame newest = seen_from(usual_view(), state);
  cv::cvtColor(newest.left.pixels, newest.left.pixels, cv::COLOR_BGR2RGB);
  ASSERT_TRUE(core_->look(newest, images_));
  PredictedView drawn = view();
  drawn.mix_silhouettes(false);
  const auto textures_alone = [&] {
    drawn.draw(usual_view(), state, *textures_.acquire());
    return drawn.read();
  };
  const auto with_image = [&] {
    drawn.draw(usual_view(), state, *textures_.acquire(), *images_.acquire());
    return drawn.read();
  };
  const cv::Mat old = textures_alone(), picture = with_image();
  cv::Mat stored = picture.clone();
  glGetTextureImage(drawn.picture().name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(stored.total() * 4),
                    stored.data);

  core_->process(seen_from(look_at({-0.5, -1.1, 0.9}, {0.1, 0, 0.1}), state), textures_);
  core_->process(seen_from(look_at({-0.9, -0.4, 0.9}, {0.1, 0, 0.1}), state), textures_);
  ASSERT_TRUE(core_->look(newest, images_));
  const cv::Mat later_old = textures_alone(), later_picture = with_image();

  const reference::RayCaster caster(*scene_, state);
  const auto distance = [&](double x, double y) {
    const auto ray = view_lens.unproject({x, y});
    const auto hit = caster.cast(usual_view().translation(), usual_view().linear() * *ray, gl::kNearPlane);
    return hit ? (hit->p_world - usual_view().translation()).norm() : 1e3;
  };
  int uncertain = 0, behind = 0, of_the_image = 0, seen_later = 0, changed = 0;
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      if (stored.at<cv::Vec4b>(y, x)[3] != view_alpha::kFromEdge) continue;
      ++uncertain;
      EXPECT_EQ(picture.at<cv::Vec4b>(y, x)[3], 255) << "a colour from a camera image";
      EXPECT_LT(old.at<cv::Vec4b>(y, x)[3], 255) << x << ' ' << y;
      bool hidden_beside = false;
      for (int i = 0; i < 9; ++i)
        hidden_beside = hidden_beside || distance(x + i % 3 - 1, y + i / 3 - 1) < distance(x, y) - 0.05;
      behind += hidden_beside;
      const auto pixel = image_lens.project(*view_lens.unproject({x, y}));
      ASSERT_TRUE(pixel);
      const auto range = range_around(newest.left.pixels, *pixel);
      bool within = true;
      for (int c = 0; c < 3; ++c) {
        const int value = picture.at<cv::Vec4b>(y, x)[c];
        within = within && value >= range[0][c] - 12 && value <= range[1][c] + 12;
      }
      of_the_image += within;
      if (later_old.at<cv::Vec4b>(y, x)[3] != 255) continue;
      ++seen_later;
      changed += cv::norm(later_picture.at<cv::Vec4b>(y, x), later_old.at<cv::Vec4b>(y, x), cv::NORM_INF) > 1;
    }
  RecordProperty("uncertain", uncertain);
  RecordProperty("seen later", seen_later);
  EXPECT_GT(uncertain, 80);
  // Beside silhouettes pixels that show the slope's own surface count, too; with those of far sides it is a quarter and
  // more.
  EXPECT_LE(behind, uncertain / 5) << "of a far side the image may show what stands before it";
  EXPECT_GT(of_the_image, 0.95 * uncertain);
  EXPECT_GT(seen_later, 20);
  EXPECT_LE(changed, seen_later / 20);
}

INSTANTIATE_TEST_SUITE_P(Lenses, NewestImage,
                         testing::Values(Kinds{"pinhole", "pinhole"}, Kinds{"plumb_bob", "plumb_bob"},
                                         Kinds{"fisheye", "pinhole"}),
                         [](const auto& i) { return std::string(i.param.image) + "_in_" + i.param.view; });

// Whoever draws with an image keeps it, however many come after.
TEST_P(NewestImage, StaysAsItIsWhileItIsLeased) {
  core_->process(seen_from(usual_view(), state_of(*scene_)), textures_);
  core_->look(seen_from(usual_view(), state_of(*scene_)), images_);
  const ImagesLease kept = images_.acquire();
  const auto pixels = [](const PublishedImage& image) {
    const gl::Texture& texture = image.camera->image();
    cv::Mat out(texture.height(), texture.width(), CV_8UC4);
    glGetTextureImage(texture.name(), 0, GL_BGRA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(out.total() * 4), out.data);
    return out;
  };
  const cv::Mat before = pixels(*kept->newest);
  std::map<const PublishedImage*, int> places;
  for (int i = 1; i <= 6; ++i) {
    const PosedFrame frame = seen_from(look_at({-0.9, -0.9 + 0.1 * i, 0.7}, {0, 0, 0.1}), state_of(*scene_, 0.02 * i));
    ASSERT_TRUE(core_->look(frame, images_));
    core_->extract(textures_);
    const ImagesLease newest = images_.acquire();
    ++places[&*newest->newest];
    EXPECT_GT(cv::norm(pixels(*newest->newest), before, cv::NORM_INF), 0);
  }
  EXPECT_EQ(cv::norm(pixels(*kept->newest), before, cv::NORM_INF), 0);
  EXPECT_EQ(places.size(), 3u) << "three places take turns: the one before is shown, too";
}

}  // namespace
}  // namespace foresight::newest_image_test
