// What the texture thread hands to the display: one whole generation of textures.
#pragma once

#include <Eigen/Core>
#include <atomic>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

#include "common/time.hpp"
#include "gl/objects.hpp"

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
  gl::BufferTexture table;                     ///< R32UI: colour slot of each page
  gl::BufferTexture charts;                    ///< RGBA32F: five texels a chart (chart_record.glsl)
  gl::BufferTexture coarse;                    ///< RGBA16F: filled mean of each page
  gl::BufferTexture means;                     ///< RGBA16F: filled mean of each chart
  std::vector<ChartPlace> places;              ///< one per chart
  std::shared_ptr<const gl::Texture> colours;  ///< the atlas, shared by all generations

  /// Bind for lookup.glsl: units 11 to 15.
  void bind() const;

  mutable std::atomic<int> leases{0};
};

/// Keeps one generation from being written over. Hold it until the GPU has finished the commands
/// that read it (a fence has passed), not only until they are issued. The last one may delete
/// textures: let go of it where a context of their share group is current.
class TextureLease {
 public:
  TextureLease() = default;
  explicit TextureLease(std::shared_ptr<const PublishedTextures> textures) : textures_(std::move(textures)) {}
  TextureLease(TextureLease&& other) noexcept : textures_(std::move(other.textures_)) {}
  TextureLease& operator=(TextureLease&& other) noexcept {
    if (this != &other) {
      reset();
      textures_ = std::move(other.textures_);
    }
    return *this;
  }
  ~TextureLease() { reset(); }

  explicit operator bool() const { return textures_ != nullptr; }
  const PublishedTextures& operator*() const { return *textures_; }
  const PublishedTextures* operator->() const { return textures_.get(); }

 private:
  void reset() {
    if (textures_) textures_->leases.fetch_sub(1, std::memory_order_release);
    textures_.reset();
  }
  std::shared_ptr<const PublishedTextures> textures_;
};

/// The table flip: one pointer, swapped whole. Any thread; holds its lock for a few instructions.
class LatestTextures {
 public:
  /// The newest generation, or an empty lease before the first.
  TextureLease acquire() const {
    const std::scoped_lock lock(mutex_);
    if (latest_) latest_->leases.fetch_add(1, std::memory_order_relaxed);
    return TextureLease(latest_);
  }
  void publish(std::shared_ptr<const PublishedTextures> next) {
    const std::scoped_lock lock(mutex_);
    latest_.swap(next);
  }

 private:
  mutable std::mutex mutex_;
  std::shared_ptr<const PublishedTextures> latest_;
};

}  // namespace foresight
