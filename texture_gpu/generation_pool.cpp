#include "texture_gpu/generation_pool.hpp"

#include <chrono>
#include <thread>

namespace foresight {
namespace {

constexpr std::chrono::milliseconds kDisplayTimeout{5000};  // for the display to move on to newer textures

}  // namespace

GenerationPool::Generation GenerationPool::take(const AtlasStore& store) {
  Generation out;
  if (!free_.empty()) {
    out = std::move(free_.back());
    free_.pop_back();
  } else {
    out = std::make_shared<PublishedTextures>();
    out->table = gl::BufferTexture(GL_R32UI, 16, "page table");
    out->charts = gl::BufferTexture(GL_RGBA32F, 16, "charts");
    out->coarse = gl::BufferTexture(atlas::kMeanFormat, 16, "page means");
    out->means = gl::BufferTexture(atlas::kMeanFormat, 16, "chart means");
    out->ages = gl::BufferTexture(GL_R32F, 16, "page ages");
  }
  out->colours = store.colours;
  return out;
}

void GenerationPool::retire(Generation generation, std::vector<std::uint32_t> slots) {
  retired_.push_back({std::move(generation), std::move(slots)});
}

void GenerationPool::reclaim(ChartAtlas& atlas) {
  while (!retired_.empty() && retired_.front().generation->leases.load(std::memory_order_acquire) == 0) {
    atlas.give_back_colours(retired_.front().slots);
    free_.push_back(std::move(retired_.front().generation));
    free_.back()->colours.reset();  // an atlas that was outgrown goes with the last that shows it
    retired_.pop_front();
  }
}

bool GenerationPool::wait_for_slots(ChartAtlas& atlas, std::size_t needed) {
  const auto deadline = std::chrono::steady_clock::now() + kDisplayTimeout;
  reclaim(atlas);
  while (atlas.free_colour_slots() < needed && !retired_.empty()) {
    if (std::chrono::steady_clock::now() > deadline) return false;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    reclaim(atlas);
  }
  return true;  // with all of them back, the atlas decides by its policy
}

}  // namespace foresight
