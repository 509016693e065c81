#include "gl/faces.hpp"

#include <gtest/gtest.h>

#include <Eigen/LU>

#include "tests/support/small_scene.hpp"

namespace foresight::gl::faces_test {
namespace {

/// Place of a ray on the face that its direction points to.
Eigen::Vector2d place_on(const Faces& faces, const Eigen::Vector3d& ray) {
  int face = 0;
  if (faces.count == 6) {
    double most = 0;
    for (int i = 0; i < 6; ++i) {
      const double z = (Faces::rotation(i) * ray).z();
      if (z > most) most = z, face = i;
    }
  }
  const Eigen::Vector3d p = Faces::rotation(face) * ray;
  return {faces.fx * p.x() / p.z() + faces.cx, faces.fy * p.y() / p.z() + faces.cy};
}

TEST(Faces, HoldAllThatTheLensSeesWithTheBorderAround) {
  constexpr int kBorder = 5;
  for (const char* kind : kLensKinds) {
    const Lens lens = small_lens(kind);
    const Faces faces = faces_for(lens, kBorder);
    EXPECT_EQ(faces.count, std::string(kind) == "wide_fisheye" ? 6 : 1) << kind;
    // An undistorted lens is its own face; a margin beyond its image shows nothing that is used.
    const double border = lens.has_distortion() ? kBorder : 0;
    int seen = 0;
    for (double v = -0.5; v <= lens.height(); v += 1)
      for (double u = -0.5; u <= lens.width(); u += 1) {
        const auto ray = lens.unproject({u, v});
        if (!ray) continue;
        const Eigen::Vector2d at = place_on(faces, *ray);
        ++seen;
        ASSERT_GE(at.minCoeff(), border - 0.5 - 1e-6) << kind << " at " << u << ", " << v;
        ASSERT_LE(at.x(), faces.width - 0.5 - border + 1e-6) << kind << " at " << u << ", " << v;
        ASSERT_LE(at.y(), faces.height - 0.5 - border + 1e-6) << kind << " at " << u << ", " << v;
      }
    EXPECT_GT(seen, 15000) << kind;
  }
}

TEST(Faces, HaveTheImagesResolutionOnTheAxis) {
  for (const char* kind : kLensKinds) {
    const Lens lens = small_lens(kind);
    const Faces faces = faces_for(lens, 4);
    EXPECT_NEAR(faces.fx, lens.parameters().fx, 0.01 * lens.parameters().fx) << kind;
    EXPECT_NEAR(faces.fy, lens.parameters().fy, 0.01 * lens.parameters().fy) << kind;
  }
}

TEST(Faces, CubeFacesAreRotationsInTheStatedOrder) {
  const Eigen::Vector3d outwards[] = {{0, 0, 1}, {1, 0, 0}, {0, 0, -1}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}};
  for (int i = 0; i < 6; ++i) {
    const Eigen::Matrix3d R = Faces::rotation(i);
    EXPECT_NEAR(R.determinant(), 1, 1e-12) << i;
    EXPECT_TRUE((R * R.transpose()).isIdentity(1e-12)) << i;
    EXPECT_TRUE(R.row(2).transpose().isApprox(outwards[i])) << i;
  }
}

TEST(Faces, AreNeverLargerThanATextureMayBe) {
  Lens::Parameters p;
  p.width = 16000, p.height = 12000, p.fx = p.fy = 6000, p.cx = 8000, p.cy = 6000;
  p.model = LensModel::equidistant;
  const Faces cube = faces_for(Lens(p), 10);
  EXPECT_EQ(cube.count, 6);
  EXPECT_LE(cube.width, 8192);
  p.fx = p.fy = 11000;
  const Faces single = faces_for(Lens(p), 10);
  EXPECT_EQ(single.count, 1);
  EXPECT_LE(std::max(single.width, single.height), 8192);
}

}  // namespace
}  // namespace foresight::gl::faces_test
