// What the texture thread hands to the display: one whole generation of textures.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <memory>
#include <vector>

#include "common/time.hpp"
#include "gl/objects.hpp"
#include "texture_gpu/lease.hpp"
#include "texture_gpu/shadow_map.hpp"

namespace foresight {

/// Where a chart's texels lie: what `PublishedTextures::charts` says in floats, to the last bit. From
/// it the CPU finds the heights again that the extraction projected (texture_readback.hpp).
struct ChartPlace {
  Eigen::Vector2d density{0, 0};  ///< texels per metre along u and v; 0: the chart has no texels yet
  int first_page = 0;             ///< in the page table
};

/// Everything needed to draw the scene with the textures of one instant. Written by the texture
/// thread before it is published, then left alone until no lease is out. Owns all that it shows: a
/// lease outlives the core that made it, and the end of its thread by an error.
struct PublishedTextures {
  std::uint64_t number = 0;                    ///< counts up with each publish
  RobotTime newest_image;                      ///< capture instant of the newest image in it
  float display_gain = 1;                      ///< factor on colours that shows the newest image's exposure
  Eigen::Vector3f white_balance{1, 1, 1};      ///< likewise, its white balance: on red, green and blue
  Eigen::Vector2f vignetting{0, 0};            ///< of the newest image: a and b (exposure.hpp)
  float sharp = 0.6f;                          ///< share of the cubic filter that suits them (sharpness.hpp)
  gl::BufferTexture table;                     ///< R32UI: colour slot of each page
  gl::BufferTexture charts;                    ///< RGBA32F: five texels a chart (chart_record.glsl)
  gl::BufferTexture coarse;                    ///< RGBA16F: filled mean of each page
  gl::BufferTexture means;                     ///< RGBA16F: filled mean of each chart
  gl::BufferTexture ages;                      ///< R32F: s before `newest_image` that one saw each page; -1: none did
  std::shared_ptr<const SceneLight> light;     ///< shadows of what moves are not in the colours; null: they may be
  float light_age = -1;                        ///< seconds for which `light` was known then
  std::vector<ChartPlace> places;              ///< one per chart
  std::shared_ptr<const gl::Texture> colours;  ///< the atlas, shared by all generations

  /// Bind for lookup.glsl: units 11 to 15.
  void bind() const;

  mutable std::atomic<int> leases{0};
};

using TextureLease = Lease<PublishedTextures>;
using LatestTextures = Latest<PublishedTextures>;

}  // namespace foresight
