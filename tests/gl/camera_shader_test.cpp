// camera.glsl against common/lens.hpp and gl/faces.hpp.
#include <Eigen/Geometry>
#include <random>

#include "gl/camera_block.hpp"
#include "gl/program.hpp"
#include "tests/support/headless_test.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::gl::camera_shader_test {
namespace {

const char* const kProbe = R"(
#include "camera.glsl"
layout(local_size_x = 64) in;
layout(std140, binding = 0) uniform Camera { CameraBlock camera; };
layout(binding = 0) uniform samplerBuffer points;
struct Answer { vec4 lens; vec4 face; vec4 round_trip; };
layout(binding = 0, std430) writeonly buffer Answers { Answer answers[]; };

void main() {
  int i = int(gl_GlobalInvocationID.x);
  vec3 p = texelFetch(points, i).xyz;
  vec2 pixel;
  bool in_lens = project_lens(camera, p, pixel);
  vec3 place;
  float inverse_z;
  bool on_face = project_face(camera, p, place, inverse_z);
  vec3 ray = vec3((place.xy - camera.face.zw) / camera.face.xy, 1.0);
  if (has_cube_faces(camera)) ray = from_cube_face(ray, int(place.z));
  answers[i] = Answer(vec4(pixel, in_lens ? 1.0 : 0.0, inverse_z), vec4(place, on_face ? 1.0 : 0.0), vec4(normalize(ray), 0.0));
}
)";

struct Answer {
  Eigen::Vector4f lens, face, round_trip;
};

/// Points all around a camera, half of them in the solid angle of its lens.
std::vector<Eigen::Vector4f> points_around(const Lens& lens) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> unit(0, 1);
  std::vector<Eigen::Vector4f> points;
  for (int i = 0; i < 4096; ++i) {
    const double angle = (i % 2 ? lens.max_angle() : M_PI) * unit(random), around = 2 * M_PI * unit(random);
    const double r = 0.1 + 5 * unit(random);
    const Eigen::Vector3d p =
        r * Eigen::Vector3d(std::sin(angle) * std::cos(around), std::sin(angle) * std::sin(around), std::cos(angle));
    points.push_back(Eigen::Vector4d(p.x(), p.y(), p.z(), 0).cast<float>());
  }
  return points;
}

std::vector<Answer> ask(const Lens& lens, const Faces& faces, const std::vector<Eigen::Vector4f>& points,
                        const std::vector<std::string>& defines) {
  const Program program = Program::compute({{"probe.comp", kProbe}}, "probe.comp", defines);
  Buffer camera(sizeof(CameraBlock), "camera"), out(points.size() * sizeof(Answer), "answers");
  const CameraBlock block = make_camera_block(lens, faces);
  camera.write(std::span(&block, 1));
  BufferTexture in(GL_RGBA32F, 16, "points");
  in.assign(std::span<const Eigen::Vector4f>(points));
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, camera.name());
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, out.name());
  glBindTextureUnit(0, in.texture());
  program.dispatch(static_cast<int>(points.size()));
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::vector<Answer> answers(points.size());
  out.read(std::span<Answer>(answers));
  return answers;
}

class CameraShader : public HeadlessTest, public testing::WithParamInterface<const char*> {};

// float has 24 bits: 6e-8 of values up to some hundred pixels, times a few for polynomials and the
// fold, where the slope is small. A hundredth of a pixel is a tenth of what anybody could see.
constexpr double kPixels = 2e-3;

TEST_P(CameraShader, ProjectsAsTheLensDoes) {
  const Lens lens = small_lens(GetParam());
  const Faces faces = faces_for(lens, 4);
  const auto points = points_around(lens);
  for (const auto& defines : {std::vector<std::string>{}, camera_defines(std::span(&lens, 1))}) {
    const auto answers = ask(lens, faces, points, defines);
    int seen = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Eigen::Vector3d p = points[i].head<3>().cast<double>();
      const auto pixel = lens.project(p);
      const double radius =
          lens.model() == LensModel::equidistant ? std::atan2(p.head<2>().norm(), p.z()) : p.head<2>().norm() / p.z();
      const bool at_the_border =
          std::abs(radius - lens.max_radius()) < 1e-4 * lens.max_radius() || std::abs(p.z()) < 1e-6;
      // Where nothing is distorted the shader skips the test of the radius: 60 is 89 degrees.
      if (at_the_border || (!lens.has_distortion() && radius > lens.max_radius())) continue;
      ASSERT_EQ(answers[i].lens.z() > 0.5, pixel.has_value()) << p.transpose();
      if (!pixel || pixel->norm() > 1e4) continue;  // far outside of any image
      ++seen;
      const double scale = std::max(1.0, pixel->norm() / 300);
      ASSERT_LT((answers[i].lens.head<2>().cast<double>() - *pixel).norm(), kPixels * scale) << p.transpose();
    }
    EXPECT_GT(seen, 2000);
  }
}

TEST_P(CameraShader, PlacesPointsOnTheFaceThatShowsThem) {
  const Lens lens = small_lens(GetParam());
  const Faces faces = faces_for(lens, 4);
  const auto points = points_around(lens);
  const auto answers = ask(lens, faces, points, {});
  int placed = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Eigen::Vector3d p = points[i].head<3>().cast<double>();
    const auto layer = static_cast<int>(answers[i].face.z());
    const Eigen::Vector3d q = Faces::rotation(layer) * p;
    const Eigen::Vector2d at(faces.fx * q.x() / q.z() + faces.cx, faces.fy * q.y() / q.z() + faces.cy);
    const bool inside =
        q.z() >= kNearPlane && at.minCoeff() >= -0.5 && at.x() <= faces.width - 0.5 && at.y() <= faces.height - 0.5;
    const double to_border =
        std::min({at.x() + 0.5, at.y() + 0.5, faces.width - 0.5 - at.x(), faces.height - 0.5 - at.y()});
    if (std::abs(to_border) > 1e-2) {
      ASSERT_EQ(answers[i].face.w() > 0.5, inside) << p.transpose();
    }
    if (!inside) continue;
    ++placed;
    ASSERT_GE(q.z(), q.head<2>().cwiseAbs().maxCoeff() * (faces.count == 6 ? 1 - 1e-6 : 0)) << "the wrong face";
    ASSERT_LT((answers[i].face.head<2>().cast<double>() - at).norm(), kPixels);
    ASSERT_NEAR(answers[i].lens.w() * q.z(), 1, 1e-6);
    ASSERT_LT((answers[i].round_trip.head<3>().cast<double>() - p.normalized()).norm(), 1e-5) << "from_cube_face";
  }
  EXPECT_GT(placed, faces.count == 6 ? 4000 : 400);
}

INSTANTIATE_TEST_SUITE_P(Lenses, CameraShader, testing::ValuesIn(kLensKinds),
                         [](const auto& i) { return std::string(i.param); });

TEST(CameraDefines, AreEmptyForCamerasThatDifferInKind) {
  const std::vector<Lens> same{small_lens("plumb_bob"), small_lens("rational")};
  EXPECT_EQ(camera_defines(same), (std::vector<std::string>{"LENS_MODEL 1", "CUBE_FACES 0", "FACE_IS_IMAGE 0"}));
  const std::vector<Lens> mixed{small_lens("plumb_bob"), small_lens("fisheye")};
  EXPECT_TRUE(camera_defines(mixed).empty());
  const std::vector<Lens> wide{small_lens("wide_fisheye")};
  EXPECT_EQ(camera_defines(wide), (std::vector<std::string>{"LENS_MODEL 2", "CUBE_FACES 1", "FACE_IS_IMAGE 0"}));
}

TEST(NodeRows, MapNodePointsToTheCamera) {
  const auto scene = small_scene();
  const SceneState state = state_of(*scene, 0.1);
  const Pose T_world_camera = usual_view();
  std::vector<Eigen::Vector4f> rows;
  append_node_rows(T_world_camera, state, rows);
  ASSERT_EQ(rows.size(), 3 * state.T_world_node.size());
  const Eigen::Vector3d p_node(0.03, -0.02, 0.05);
  for (std::size_t n = 0; n < state.T_world_node.size(); ++n) {
    const Eigen::Vector3d expected = T_world_camera.inverse() * state.T_world_node[n] * p_node;
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(rows[3 * n + static_cast<std::size_t>(i)].cast<double>().dot(p_node.homogeneous()), expected[i],
                  1e-6);
  }
}

}  // namespace
}  // namespace foresight::gl::camera_shader_test
