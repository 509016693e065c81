#include "gl/kept_fences.hpp"

#include "gl/context.hpp"

namespace foresight::gl {
namespace {

// Scenes that may be under way (MAX_SCENES of Mesa), and more: one that began after all of them has its fence counted
// up only when the threads have left theirs.
constexpr std::size_t kMost = 2 * 64;

}  // namespace

KeptFences::KeptFences() : keeps_(query_driver().is_software) {}

void KeptFences::operator()() const {
  if (!keeps_) return;
  fences_.push_back(Fence::insert());
  if (fences_.size() > kMost) fences_.pop_front();
}

}  // namespace foresight::gl
