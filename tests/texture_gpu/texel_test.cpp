// Colours in 32 bits, packed and unpacked by shaders and read by the CPU.
#include "texture_gpu/texel.hpp"

#include <random>

#include "tests/support/headless_test.hpp"
#include "texture_gpu/shaders.hpp"

namespace foresight::texel_test {
namespace {

const char* const kRoundTrip = R"(
#include "atlas.glsl"
layout(local_size_x = 64) in;
layout(binding = 0, std430) buffer Colours { vec4 colours[]; };
layout(binding = 1, std430) buffer Texels { uint texels[]; };
void main() {
  uint i = gl_GlobalInvocationID.x;
  if (i >= uint(colours.length())) return;
  texels[i] = pack_texel(colours[i]).r;
  colours[i] = unpack_texel(unpackUnorm4x8(texels[i]));
}
)";

class TexelTest : public HeadlessTest {
 protected:
  /// Replaces `colours` by what comes back.
  static std::vector<atlas::Texel> round_trip(std::vector<Eigen::Vector4f>& colours) {
    gl::ShaderSources sources = gl::texture_gpu_shaders();
    sources["probe.comp"] = kRoundTrip;
    const gl::Program program = gl::Program::compute(sources, "probe.comp");
    gl::Buffer in(16 * colours.size(), "colours"), out(4 * colours.size(), "texels");
    in.write(std::span<const Eigen::Vector4f>(colours));
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, in.name());
    glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 1, out.name());
    program.dispatch(static_cast<int>(colours.size()));
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    in.read(std::span(colours));
    std::vector<atlas::Texel> texels(colours.size());
    out.read(std::span(texels));
    return texels;
  }
};

TEST_F(TexelTest, KeepsColoursToHalfAStepOfTheLargest) {
  std::mt19937 random(7);
  std::uniform_real_distribution<float> octave(-14, 4.2f), share(0, 1);
  std::vector<Eigen::Vector4f> colours;
  for (int i = 0; i < 20000; ++i) {
    const float largest = std::exp2(octave(random));
    colours.emplace_back(largest * share(random), largest, largest * share(random), static_cast<float>(i % 32) / 31);
  }
  for (int step = 0; step <= 255; ++step)  // those of an image at the reference exposure
    colours.emplace_back(static_cast<float>(step) / 255, 0, 0, 1);
  auto got = colours;
  const auto texels = round_trip(got);
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const Eigen::Array3f want = colours[i].head<3>().array().min(15.9375f);
    // Steps are 1/256 of the power of two above the largest, but that a mantissa of 256 takes the next one.
    const float step = std::max(std::exp2(std::floor(std::log2(want.maxCoeff() * 1.003f)) - 7), std::exp2(-11.f));
    ASSERT_LE((got[i].head<3>().array() - want).abs().maxCoeff(), 0.501f * step) << colours[i].transpose();
    ASSERT_TRUE(texels[i].colour().isApprox(got[i].head<3>().array(), 1e-6f)) << "CPU and shader read the same";
    ASSERT_EQ(texels[i].code(), std::lround(31 * colours[i].w()));
    ASSERT_FLOAT_EQ(got[i].w(), colours[i].w());
  }
}

TEST_F(TexelTest, CutsOffWhatItCannotHold) {
  std::vector<Eigen::Vector4f> colours{{-1, 0.5f, 1e-5f, 0}, {1e30f, 16, 0, 1}, {0, 0, 0, 0}};
  const auto texels = round_trip(colours);
  EXPECT_TRUE(colours[0].head<3>().isApprox(Eigen::Vector3f(0, 0.5f, 0), 1e-6f));
  EXPECT_TRUE(colours[1].head<3>().isApprox(Eigen::Vector3f(15.9375f, 15.9375f, 0), 1e-6f));
  EXPECT_EQ(texels[2].bits, 0u);
}

}  // namespace
}  // namespace foresight::texel_test
