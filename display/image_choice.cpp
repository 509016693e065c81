#include "display/image_choice.hpp"

#include <algorithm>
#include <cmath>

#include "texture_gpu/kept_images.hpp"

namespace foresight {
namespace {

constexpr double kPerSecond = 0.03;     // rad: what an image is worse for each second of its age (kept.glsl)
constexpr double kAlike = 0.02;         // rad: images that differ by less share pixels
constexpr double kRest = 1e-3;          // m, rad
constexpr std::size_t kMostChosen = 2;  // each is drawn over the whole view

bool in_the_same_light(const PublishedImage& a, const PublishedImage& b) {
  if (a.light || b.light) return a.light && b.light;
  return std::ranges::equal(a.image.scene.T_world_node, b.image.scene.T_world_node, is_at_rest);
}

}  // namespace

bool is_at_rest(const Pose& T_world_now, const Pose& T_world_then) {
  return (T_world_now.matrix() - T_world_then.matrix()).cwiseAbs().maxCoeff() < kRest;
}

std::vector<ChosenImage> choose_images(const NewestImages& images, const Pose& T_world_eye) {
  struct Scored {
    double worse, age;
    const PublishedImage* image;
  };
  const PublishedImage& newest = *images.newest;
  const auto score = [&](const PublishedImage& image) {
    const double age = to_seconds(newest.image.time - image.image.time);
    const double angle = sight_angle(T_world_eye, image.image.T_world_camera.translation(), newest.range);
    return Scored{kPerSecond * age + angle, age, &image};
  };
  const double limit = score(newest).worse;
  std::vector<Scored> scored;
  for (const auto& lease : images.others) {
    const Scored one = score(*lease);
    if (one.age >= 0 && one.worse < limit && in_the_same_light(newest, *lease)) scored.push_back(one);
  }
  std::ranges::stable_sort(scored, {}, &Scored::worse);
  std::vector<ChosenImage> out;
  for (std::size_t i = 0; i < std::min(scored.size(), kMostChosen); ++i)
    out.push_back({scored[i].image, scored[i].age, 1});
  if (out.size() > 1)
    out.front().claim = static_cast<float>(std::min(1.0, 0.5 + 0.5 * (scored[1].worse - scored[0].worse) / kAlike));
  std::ranges::reverse(out);
  return out;
}

}  // namespace foresight
