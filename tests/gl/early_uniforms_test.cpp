#include "gl/early_uniforms.hpp"

#include <gtest/gtest.h>

#include "gl/program.hpp"
#include "gl/read_texture.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::gl::early_uniforms_test {
namespace {

TEST(EarlyUniforms, AreGlobalsOfTheSameName) {
  EXPECT_EQ(with_early_uniforms("uniform float sharp;  // share\n"),
            "uniform float sharp_given; float sharp = min(sharp_given, sharp_given);  // share\n");
  EXPECT_EQ(with_early_uniforms("uniform ivec2 size, way;\n"),
            "uniform ivec2 size_given, way_given; ivec2 size = min(size_given, size_given);"
            " ivec2 way = min(way_given, way_given);\n");
  EXPECT_EQ(with_early_uniforms("layout(std140, binding = 1) uniform Others { CameraBlock others[2]; };\n"),
            "layout(std140, binding = 1) uniform Others { CameraBlock others_given[2]; }; "
            "CameraBlock[2] others = CameraBlock[2](at_start(others_given[0]), at_start(others_given[1]));\n");
}

TEST(EarlyUniforms, LeaveTheRestAsItIs) {
  for (const char* line : {"layout(binding = 0) uniform sampler2D depth;\n", "uniform int layer_of[FRAMES];  // each\n",
                           "uniform bool each;\n", "// a uniform float\n", "  float sharp;\n"})
    EXPECT_EQ(with_early_uniforms(line), line);
}

using EarlyUniformsTest = HeadlessTest;

TEST_F(EarlyUniformsTest, AreSetByTheirNames) {
  const ShaderSources sources{
      {"sum.comp",
       "layout(local_size_x = 1) in;\n"
       "layout(binding = 0, r32f) uniform writeonly image2D place;\n"
       "uniform float a, b;\n"
       "uniform ivec2 c;\n"
       "uniform mat4 m;\n"
       "void main() {\n"
       "  if (a > 0.0) imageStore(place, ivec2(0), vec4(a + 10.0 * b + 100.0 * float(c.y) + 1000.0 * m[2].w));\n"
       "}\n"}};
  const Program program = Program::compute(sources, "sum.comp");
  program.set("a", 1.0F);
  program.set("b", 2.0F);
  program.set("c", Eigen::Vector2i(7, 3));
  Eigen::Matrix4f m = Eigen::Matrix4f::Zero();
  m(3, 2) = 4;
  program.set("m", m);
  const Texture place(GL_R32F, 1, 1, 0, 1, "place");
  glBindImageTexture(0, place.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
  program.dispatch(1);
  glMemoryBarrier(GL_TEXTURE_UPDATE_BARRIER_BIT);
  EXPECT_EQ(read_texture(place.name()).at<float>(0, 0), 4321.0F);
}

}  // namespace
}  // namespace foresight::gl::early_uniforms_test
