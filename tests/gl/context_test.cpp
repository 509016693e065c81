#include <epoxy/gl.h>
#include <gmock/gmock.h>

#include <thread>

#include "gl/objects.hpp"
#include "gl/program.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::gl::context_test {
namespace {

using ContextTest = HeadlessTest;

TEST_F(ContextTest, TellsWhatTheDriverIs) {
  EXPECT_FALSE(driver_.vendor.empty());
  EXPECT_FALSE(driver_.renderer.empty());
  EXPECT_GE(epoxy_gl_version(), 45);
  EXPECT_EQ(driver_.is_software, driver_.renderer.find("pipe") != std::string::npos) << driver_.renderer;
}

TEST_F(ContextTest, SharesObjectsWithASecondContextOnAnotherThread) {
  Buffer buffer(16, "shared");
  const std::array<int, 4> sent{1, -2, 3, 1 << 30};
  buffer.write(std::span<const int>(sent));
  glFinish();
  auto second = context_->create_shared();
  std::array<int, 4> received{};
  std::jthread([&] {
    second->make_current();
    set_up_context();
    buffer.read(std::span<int>(received));
    check_errors("the second context");
    second->release();
  }).join();
  EXPECT_EQ(received, sent);
}

// Mock cameras and a view each open the device for themselves.
TEST_F(ContextTest, EndsWithoutEndingOthersOnTheSameDevice) {
  {
    auto other = create_headless_context();
    other->make_current();
    other->release();
  }
  context_->make_current();
  Buffer buffer(16, "after the other");
  const std::array<int, 4> sent{1, 2, 3, 4};
  buffer.write(std::span<const int>(sent));
  std::array<int, 4> received{};
  buffer.read(std::span<int>(received));
  check_errors("the first context");
  EXPECT_EQ(received, sent);
}

TEST_F(ContextTest, ErrorsNameTheCaller) {
  glEnable(0xffff);
  try {
    check_errors("a pass of the test");
    FAIL() << "no error";
  } catch (const RuntimeFailure& failure) {
    EXPECT_THAT(failure.what(),
                testing::AllOf(testing::HasSubstr("GL_INVALID_ENUM"), testing::HasSubstr("a pass of the test")));
  }
  EXPECT_NO_THROW(check_errors("the next pass"));  // reported once
}

TEST_F(ContextTest, DepthIsNotRemapped) {
  GLint depth_mode = 0, alignment = 0;
  glGetIntegerv(GL_CLIP_DEPTH_MODE, &depth_mode);
  glGetIntegerv(GL_UNPACK_ALIGNMENT, &alignment);
  EXPECT_EQ(depth_mode, GL_ZERO_TO_ONE);
  EXPECT_EQ(alignment, 1);
}

// Between two neighbouring grey levels there are others: a renderer that filters in 8 bits finds none.
TEST_F(ContextTest, FiltersImagesOf8BitsFinerThanTheirSteps) {
  const char* const look = R"(
layout(local_size_x = 8) in;
layout(binding = 0) uniform sampler2D image;
layout(binding = 0, std430) writeonly buffer Answers { float answers[]; };
void main() {
  int i = int(gl_GlobalInvocationID.x);
  answers[i] = 255.0 * textureLod(image, vec2((float(i) + 0.5) / 8.0 / 2.0 + 0.25, 0.5), 0.0).r;
}
)";
  const Texture image(GL_RGBA8, 2, 1, 0, 1, "two levels");
  const std::array<std::uint8_t, 8> levels{100, 100, 100, 255, 101, 101, 101, 255};
  glTextureSubImage2D(image.name(), 0, 0, 0, 2, 1, GL_RGBA, GL_UNSIGNED_BYTE, levels.data());
  for (const GLenum filter : {GL_TEXTURE_MIN_FILTER, GL_TEXTURE_MAG_FILTER})
    glTextureParameteri(image.name(), filter, GL_LINEAR);
  Buffer buffer(8 * sizeof(float), "answers");
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, buffer.name());
  glBindTextureUnit(0, image.name());
  Program::compute({{"look.comp", look}}, "look.comp").use();
  glDispatchCompute(1, 1, 1);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::array<float, 8> found{};
  buffer.read(std::span<float>(found));
  check_errors("the test");
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], 100 + (static_cast<double>(i) + 0.5) / 8, 0.01) << "place " << i;  // GPUs have 256 places
}

}  // namespace
}  // namespace foresight::gl::context_test
