#include "gl/lens_rays.hpp"

#include <gtest/gtest.h>

#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::gl::lens_rays_test {
namespace {

class LensRays : public HeadlessTest, public testing::WithParamInterface<const char*> {};

std::vector<Eigen::Vector4f> rays_of(const Lens& lens) {
  const Texture texture = make_lens_rays(lens);
  std::vector<Eigen::Vector4f> out(static_cast<std::size_t>(texture.width() * texture.height()));
  glGetTextureImage(texture.name(), 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(16 * out.size()), out.data());
  return out;
}

/// Every pixel has a ray where the model has one: px by which the farthest is off, and how many there are.
struct Agreement {
  double worst_px = 0;
  std::size_t seen = 0;
};
Agreement compared(const Lens& lens) {
  const std::vector<Eigen::Vector4f> rays = rays_of(lens);
  Agreement out;
  for (int y = 0; y < lens.height(); ++y)
    for (int x = 0; x < lens.width(); ++x) {
      const Eigen::Vector4f& ray = rays[static_cast<std::size_t>(y * lens.width() + x)];
      const auto exact = lens.unproject({x, y});
      EXPECT_EQ(ray.w(), exact ? 1 : 0) << x << ' ' << y;
      if (!exact || ray.w() != 1) continue;
      ++out.seen;
      EXPECT_NEAR(ray.head<3>().norm(), 1, 1e-6);
      const auto pixel = lens.project(ray.head<3>().cast<double>());
      EXPECT_TRUE(pixel || ray.head<3>().cast<double>().dot(*exact) > 1 - 1e-9) << "at the end of what it sees";
      if (pixel) out.worst_px = std::max(out.worst_px, (*pixel - Eigen::Vector2d(x, y)).norm());
    }
  return out;
}

TEST_P(LensRays, AreThoseOfTheModel) {
  const Lens lens = small_lens(GetParam());
  if (!lens.has_distortion()) {
    EXPECT_EQ(rays_of(lens).size(), 1u);
    return;
  }
  const Agreement agreement = compared(lens);
  EXPECT_GT(agreement.seen, 0.5 * lens.width() * lens.height());
  EXPECT_LT(agreement.worst_px, 1e-3);
}

INSTANTIATE_TEST_SUITE_P(Lenses, LensRays, testing::ValuesIn(kLensKinds),
                         [](const auto& i) { return std::string(i.param); });

// A lens that folds back within the image: there, and beyond, it sees nothing.
TEST_F(HeadlessTest, RaysEndWhereTheLensFoldsBack) {
  Lens::Parameters p = small_lens("plumb_bob").parameters();
  p.d = {-0.6};
  p.fx = p.fy = 0.5 * p.fx;
  const Lens lens(p);
  const Agreement agreement = compared(lens);
  EXPECT_GT(agreement.seen, 100u);
  EXPECT_LT(agreement.seen, static_cast<std::size_t>(lens.width() * lens.height() - 100));
  EXPECT_LT(agreement.worst_px, 1e-2);  // of a lens that folds within 32 px
}

}  // namespace
}  // namespace foresight::gl::lens_rays_test
