#include "gl/objects.hpp"

#include <gmock/gmock.h>

#include <numeric>

#include "gl/program.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::gl::objects_test {
namespace {

using ObjectsTest = HeadlessTest;

TEST_F(ObjectsTest, AHandleDeletesOnceAndMovesEmpty) {
  GLuint name = 0;
  {
    Buffer first(64, "moved");
    name = first.name();
    Buffer second = std::move(first);
    EXPECT_FALSE(first);  // NOLINT: what is left behind is the point
    EXPECT_EQ(second.name(), name);
    EXPECT_TRUE(glIsBuffer(name));
    second = Buffer(16, "replaces");
    EXPECT_FALSE(glIsBuffer(name));
    name = second.name();
  }
  EXPECT_FALSE(glIsBuffer(name));
}

TEST_F(ObjectsTest, BuffersRoundUpWriteAtOffsetsAndClear) {
  Buffer buffer(17, "odd");
  EXPECT_EQ(buffer.bytes(), 32u);
  buffer.clear_to_zero();
  const std::array<int, 2> two{7, 8};
  buffer.write(std::span<const int>(two), 8);
  std::array<int, 8> all{};
  buffer.read(std::span<int>(all));
  EXPECT_THAT(all, testing::ElementsAre(0, 0, 7, 8, 0, 0, 0, 0));
}

TEST_F(ObjectsTest, BufferTexturesGrowByHalvesAndKeepTheirPlaceOtherwise) {
  BufferTexture list(GL_R32UI, 64, "list");
  const GLuint name = list.texture();
  list.reserve(64);
  EXPECT_EQ(list.texture(), name);
  list.reserve(81);
  EXPECT_EQ(list.buffer().bytes(), 144u);
  list.assign(std::span<const int>());
  std::vector<int> numbers(100);
  std::iota(numbers.begin(), numbers.end(), 0);
  list.assign(std::span<const int>(numbers));
  std::vector<int> back(100);
  list.buffer().read(std::span<int>(back));
  EXPECT_EQ(back, numbers);
}

TEST_F(ObjectsTest, BufferTexturesAreNeverAsLargeAsAPowerOfTwo) {
  for (const std::size_t bytes : {64, 4096, 4097, 65536, 100000}) {
    BufferTexture list(GL_R32UI, bytes, "list");
    for (int i = 0; i < 4; ++i) {
      EXPECT_FALSE(std::has_single_bit(list.buffer().bytes())) << list.buffer().bytes();
      list.reserve(list.buffer().bytes() + 1);
    }
  }
}

TEST_F(ObjectsTest, FencesPassOnceTheCommandsAreDone) {
  EXPECT_TRUE(Fence().signalled());
  Fence fence = Fence::insert();
  fence.wait(10);
  EXPECT_TRUE(fence.signalled());
  const Fence moved = std::move(fence);
  EXPECT_TRUE(moved.signalled());
}

TEST_F(ObjectsTest, ProgramsIncludeFilesAndTakeDefines) {
  const ShaderSources sources{
      {"half.glsl", "uint half_of(uint v) { return v / DIVISOR; }\n"},
      {"main.comp",
       "#include \"half.glsl\"\nlayout(local_size_x = 4) in;\n"
       "layout(binding = 0, std430) buffer Out { uint values[]; };\nuniform uint start;\n"
       "void main() { values[gl_LocalInvocationIndex] = half_of(start + gl_LocalInvocationIndex); }\n"}};
  const Program program = Program::compute(sources, "main.comp", {"DIVISOR 2u"});
  Buffer out(16, "out");
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, out.name());
  program.set("start", 10u);
  program.set("no such uniform", 1);
  program.dispatch(4);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  std::array<unsigned, 4> values{};
  out.read(std::span<unsigned>(values));
  EXPECT_THAT(values, testing::ElementsAre(5u, 5u, 6u, 6u));
}

TEST_F(ObjectsTest, BadProgramsNameTheFile) {
  const auto message = [](const ShaderSources& sources, const std::string& file) {
    try {
      Program::compute(sources, file);
    } catch (const RuntimeFailure& failure) {
      return std::string(failure.what());
    }
    return std::string("accepted");
  };
  EXPECT_THAT(message({{"broken.comp", "layout(local_size_x = 1) in;\nvoid main() { nothing(); }\n"}}, "broken.comp"),
              testing::AllOf(testing::HasSubstr("broken.comp does not compile"), testing::HasSubstr("nothing")));
  EXPECT_THAT(message({}, "absent.comp"), testing::HasSubstr("absent.comp is not embedded"));
  EXPECT_THAT(message({{"a.comp", "#include \"gone.glsl\"\n"}}, "a.comp"), testing::HasSubstr("gone.glsl"));
}

TEST_F(ObjectsTest, DispatchesReachEveryInvocation) {
  const ShaderSources sources{{"count.comp",
                               "layout(local_size_x = 8, local_size_y = 2, local_size_z = 3) in;\n"
                               "layout(binding = 0, std430) buffer Out { uint last[3]; uint count; };\n"
                               "void main() {\n"
                               "  for (int i = 0; i < 3; ++i) atomicMax(last[i], gl_GlobalInvocationID[i]);\n"
                               "  atomicAdd(count, 1u);\n"
                               "}\n"}};
  const Program program = Program::compute(sources, "count.comp");
  const auto reached = [&](int across, int down, int deep) {
    Buffer out(16, "out");
    out.clear_to_zero();
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, out.name());
    program.dispatch(across, down, deep);
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    std::array<unsigned, 4> values{};
    out.read(std::span<unsigned>(values));
    return values;
  };
  EXPECT_THAT(reached(0, 1, 1), testing::ElementsAre(0u, 0u, 0u, 0u));
  EXPECT_THAT(reached(1, 1, 1), testing::ElementsAre(7u, 1u, 2u, 48u));
  EXPECT_THAT(reached(8, 2, 3), testing::ElementsAre(7u, 1u, 2u, 48u));
  EXPECT_THAT(reached(9, 5, 4), testing::ElementsAre(15u, 5u, 5u, 12u * 48u));
  EXPECT_EQ(program.groups(48), 1u);
  EXPECT_EQ(program.groups(49), 2u);
}

}  // namespace
}  // namespace foresight::gl::objects_test
