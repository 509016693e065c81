// Texture memory that grows, and what was in it.
#include "texture_gpu/atlas_store.hpp"

#include "scene/primitives.hpp"
#include "tests/support/headless_test.hpp"
#include "texture_gpu/surface_patches.hpp"

namespace foresight::atlas_store_test {
namespace {

using AtlasStoreTest = HeadlessTest;
using Texels = std::vector<std::uint16_t>;

Texels read(const gl::Texture& texture, int level, GLenum format, int channels) {
  const int width = texture.width() >> level, height = texture.height() >> level;
  Texels out(static_cast<std::size_t>(width) * static_cast<std::size_t>(height * texture.layers() * channels));
  glPixelStorei(GL_PACK_ALIGNMENT, 1);
  glGetTextureImage(texture.name(), level, format, channels == 4 ? GL_HALF_FLOAT : GL_UNSIGNED_SHORT,
                    static_cast<GLsizei>(out.size() * sizeof(std::uint16_t)), out.data());
  return out;
}

/// Numbers that name level and place: small normal halves, so that they come back bit for bit.
Texels pattern(std::size_t count, int level) {
  Texels out(count);
  for (std::size_t i = 0; i < count; ++i)
    out[i] = static_cast<std::uint16_t>(0x0400 + (i * 7 + static_cast<std::size_t>(level) * 1013) % 0x3800);
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
  for (int level = 0; level < atlas::kLevels; ++level) {
    const gl::Texture& texture = *store.colours;
    const int width = texture.width() >> level, height = texture.height() >> level;
    const std::size_t count = static_cast<std::size_t>(width) * static_cast<std::size_t>(height * texture.layers()) * 4;
    colours.push_back(pattern(count, level));
    glTextureSubImage3D(texture.name(), level, 0, 0, 0, width, height, texture.layers(), GL_RGBA, GL_HALF_FLOAT,
                        colours.back().data());
  }
  const Texels heights = pattern(static_cast<std::size_t>(store.heights.width() * store.heights.height()), 9);
  glTextureSubImage3D(store.heights.name(), 0, 0, 0, 0, store.heights.width(), store.heights.height(), 1,
                      GL_RED_INTEGER, GL_UNSIGNED_SHORT, heights.data());

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
  for (int level = 0; level < atlas::kLevels; ++level) {
    const Texels now = read(*store.colours, level, GL_RGBA, 4);
    const Texels& then = colours[static_cast<std::size_t>(level)];
    EXPECT_TRUE(std::equal(then.begin(), then.end(), now.begin())) << "level " << level;
    EXPECT_EQ(read(*shown, level, GL_RGBA, 4), then) << "what is shown stays, level " << level;
  }
  const Texels now = read(store.heights, 0, GL_RED_INTEGER, 1);
  EXPECT_TRUE(std::equal(heights.begin(), heights.end(), now.begin()));
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
