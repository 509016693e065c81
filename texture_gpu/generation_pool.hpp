// Published generations of textures that somebody may still show, and those that can be written again.
#pragma once

#include <deque>
#include <memory>
#include <vector>

#include "texture_gpu/atlas_store.hpp"
#include "texture_gpu/published_textures.hpp"

namespace foresight {

/// One thread, that of the texture core.
class GenerationPool {
 public:
  using Generation = std::shared_ptr<PublishedTextures>;

  /// One that nobody holds, to be filled. It shows the store's atlas as it is now.
  Generation take(const AtlasStore& store);

  /// Nobody takes a new lease of it; it alone still shows `slots`.
  void retire(Generation generation, std::vector<std::uint32_t> slots);

  /// Takes back what retired generations held, oldest first, as far as the display let go of them.
  void reclaim(ChartAtlas& atlas);

  /// The same, until the atlas has so many free slots for colours. False: the display does not let go of them for some
  /// seconds.
  bool wait_for_slots(ChartAtlas& atlas, std::size_t needed);

 private:
  struct Retired {
    Generation generation;
    std::vector<std::uint32_t> slots;
  };
  std::vector<Generation> free_;
  std::deque<Retired> retired_;
};

}  // namespace foresight
