// Texture memory that grows, and what was in it.
#include "texture_gpu/atlas_store.hpp"

#include "scene/primitives.hpp"
#include "tests/support/headless_test.hpp"
#include "texture_gpu/shaders.hpp"
#include "texture_gpu/surface_patches.hpp"

namespace foresight::atlas_store_test {
namespace {

using AtlasStoreTest = HeadlessTest;
using Texels = std::vector<std::uint32_t>;

std::size_t texels_of(const gl::Texture& texture, int level) {
  const int width = texture.width() >> level, height = texture.height() >> level;
  return static_cast<std::size_t>(width) * static_cast<std::size_t>(height * texture.layers());
}

/// How GL calls what is in a number.
struct Kind {
  GLenum format, type;
};
constexpr Kind kColours{GL_RGBA, GL_UNSIGNED_INT_8_8_8_8_REV}, kHeights{GL_RED_INTEGER, GL_UNSIGNED_INT};

Texels read(const gl::Texture& texture, int level, Kind kind) {
  Texels out(texels_of(texture, level));
  glGetTextureImage(texture.name(), level, kind.format, kind.type, static_cast<GLsizei>(out.size() * sizeof(out[0])),
                    out.data());
  return out;
}

/// Writes numbers that name level and place into a level; the same are returned.
Texels fill(const gl::Texture& texture, int level, Kind kind) {
  Texels out(texels_of(texture, level));
  for (std::size_t i = 0; i < out.size(); ++i)
    out[i] = static_cast<std::uint32_t>((i * 7 + static_cast<std::size_t>(level) * 1013) % 0x10000);
  glTextureSubImage3D(texture.name(), level, 0, 0, 0, texture.width() >> level, texture.height() >> level,
                      texture.layers(), kind.format, kind.type, out.data());
  return out;
}

TEST_F(AtlasStoreTest, GrowsByHalfAtLeastAndKeepsWhatItHeld) {
  const SceneModel scene({{"sphere", make_sphere(0.3), -1, Pose::Identity()}});
  const ChartAtlas atlas(std::make_shared<SurfacePatches>(find_surface_patches(scene, {})),
                         {.memory_bytes = 256u << 20});
  AtlasStore store(atlas);
  const ChartAtlas::Slots first = store.held();
  EXPECT_LT(first.bytes(), 8u << 20) << "little before anything is seen";

  std::vector<Texels> colours;
  for (int level = 0; level < atlas::kLevels; ++level) colours.push_back(fill(*store.colours, level, kColours));
  const Texels heights = fill(store.heights, 0, kHeights);

  const auto shown = store.colours;  // as a published generation does
  ASSERT_TRUE(store.hold(first));
  EXPECT_EQ(store.colours, shown) << "there was room";

  ASSERT_TRUE(store.hold({first.colours + 1, first.heights + 1}));
  EXPECT_GE(store.held().colours, first.colours * 3 / 2);
  EXPECT_GE(store.held().heights, first.heights * 3 / 2);
  EXPECT_LT(store.held().bytes(), 2 * first.bytes());

  // And over the edge of a layer.
  ASSERT_TRUE(store.hold({2 * atlas::kSlotsPerLayer + 5, atlas::kSlotsPerLayer + 5}));
  EXPECT_EQ(store.colours->layers(), 3);
  EXPECT_EQ(store.heights.layers(), 2);
  for (const int height : {shown->height(), store.colours->height(), store.heights.height()})
    EXPECT_FALSE(std::has_single_bit(static_cast<unsigned>(height))) << height;  // gl::no_power_of_two
  for (int level = 0; level < atlas::kLevels; ++level) {
    const Texels now = read(*store.colours, level, kColours);
    const Texels& then = colours[static_cast<std::size_t>(level)];
    EXPECT_TRUE(std::equal(then.begin(), then.end(), now.begin())) << "level " << level;
    EXPECT_EQ(read(*shown, level, kColours), then) << "what is shown stays, level " << level;
  }
  const Texels now = read(store.heights, 0, kHeights);
  EXPECT_TRUE(std::equal(heights.begin(), heights.end(), now.begin()));
}

TEST_F(AtlasStoreTest, ShadersFindSlotsWhereTheLayoutHasThem) {
  gl::ShaderSources sources = gl::texture_gpu_shaders();
  sources["probe.comp"] = R"(
#include "atlas.glsl"
layout(local_size_x = 64) in;
layout(binding = 0, std430) buffer Places { ivec4 places[]; };
uniform int level;
void main() {
  uint slot = gl_GlobalInvocationID.x;
  if (slot < uint(places.length())) places[slot] = ivec4(slot_origin(slot, level), 0);
}
)";
  const gl::Program program = gl::Program::compute(sources, "probe.comp");
  std::vector<Eigen::Vector4i> places(3 * atlas::kSlotsPerLayer);
  const gl::Buffer out(sizeof(places[0]) * places.size(), "places");
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, 0, out.name());
  for (int level = 0; level < atlas::kLevels; ++level) {
    program.set("level", level);
    program.dispatch(static_cast<int>(places.size()));
    glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
    out.read(std::span(places));
    const int side = atlas::kPage >> level;
    for (int slot = 0; slot < 3 * atlas::kSlotsPerLayer; ++slot) {
      const int row = slot / atlas::kSlotsPerRow % atlas::kRowsPerLayer;
      const Eigen::Vector4i want(slot % atlas::kSlotsPerRow * side, row * side, slot / atlas::kSlotsPerLayer, 0);
      ASSERT_EQ(places[static_cast<std::size_t>(slot)], want) << "slot " << slot << ", level " << level;
    }
  }
}

TEST_F(AtlasStoreTest, NeverHoldsMoreThanTheBudget) {
  const SceneModel scene({{"sphere", make_sphere(0.3), -1, Pose::Identity()}});
  const ChartAtlas atlas(std::make_shared<SurfacePatches>(find_surface_patches(scene, {})),
                         {.memory_bytes = 40u << 20});
  AtlasStore store(atlas);
  for (std::uint32_t slots = 1; slots < atlas.colour_capacity(); slots = slots * 3 / 2 + 1) {
    ASSERT_TRUE(store.hold({slots, slots / 2}));
    EXPECT_GE(store.held().colours, slots);
    EXPECT_LE(store.held().bytes(), 40u << 20);
  }
  ASSERT_TRUE(store.hold({atlas.colour_capacity(), atlas.height_capacity()}));
  EXPECT_LE(store.held().bytes(), 40u << 20);
}

}  // namespace
}  // namespace foresight::atlas_store_test
