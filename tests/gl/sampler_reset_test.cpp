#include "gl/sampler_reset.hpp"

#include <epoxy/gl.h>
#include <gmock/gmock.h>

#include "gl/context.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::gl::sampler_reset_test {
namespace {

using SamplerResetTest = HeadlessTest;

GLint bound(GLenum what, GLuint place) {
  GLint name = 0;
  glGetIntegeri_v(what, place, &name);
  return name;
}

// It runs in the middle of passes that have bound what they need.
TEST_F(SamplerResetTest, LeavesWhatIsBoundWherePassesBind) {
  constexpr GLuint kPlaces = 24;
  const SamplerReset reset;
  const Texture texture(GL_RGBA8, 4, 4, 0, 1, "of a pass");
  const Buffer buffer(64, "of a pass");
  for (GLuint unit = 0; unit < kPlaces; ++unit) glBindTextureUnit(unit, texture.name());
  for (GLuint block = 0; block < 4; ++block) glBindBufferBase(GL_SHADER_STORAGE_BUFFER, block, buffer.name());
  reset();
  for (GLuint unit = 0; unit < kPlaces; ++unit)
    EXPECT_EQ(bound(GL_TEXTURE_BINDING_2D, unit), static_cast<GLint>(texture.name())) << unit;
  for (GLuint block = 0; block < 4; ++block)
    EXPECT_EQ(bound(GL_SHADER_STORAGE_BUFFER_BINDING, block), static_cast<GLint>(buffer.name())) << block;
  EXPECT_NO_THROW(check_errors("the reset"));
}

// What has been bound in storage blocks is not written.
TEST_F(SamplerResetTest, WritesNothing) {
  const SamplerReset reset;
  Buffer buffer(64, "of a pass");
  const std::array<int, 4> sent{1, -2, 3, 1 << 30};
  buffer.write(std::span<const int>(sent));
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer.name());
  reset();
  std::array<int, 4> received{};
  buffer.read(std::span<int>(received));
  EXPECT_EQ(received, sent);
}

}  // namespace
}  // namespace foresight::gl::sampler_reset_test
