#include "sim/lab_builder.hpp"

#include <optional>

#include "common/parallel.hpp"
#include "sim/lab_prints.hpp"

namespace foresight::sim {

int LabBuilder::material(std::function<cv::Mat(double, unsigned)> print, double coarser, float gloss) {
  jobs_.push_back({std::move(print), texel_ * coarser, seed_ + 31 * static_cast<unsigned>(jobs_.size()), gloss});
  return static_cast<int>(jobs_.size()) - 1;
}

int LabBuilder::plain(std::uint32_t colour, double roughness, float gloss) {
  return material([=](double t, unsigned s) { return prints::plain(0.15, 0.15, t, colour, roughness, s); }, 1, gloss);
}

Facets& LabBuilder::part(const std::string& name, const Pose& T_world_part, double light_step, bool moves) {
  lab_.parts.push_back({name, {}, T_world_part, light_step, moves});
  return lab_.parts.back().facets;
}

Lab LabBuilder::finish() {
  std::vector<std::optional<Texture>> pictures(jobs_.size());
  parallel_for(jobs_.size(), [&](std::size_t i) {
    pictures[i].emplace(jobs_[i].print(jobs_[i].texel, jobs_[i].seed), jobs_[i].texel);
  });
  for (std::size_t i = 0; i < jobs_.size(); ++i) lab_.materials.push_back({std::move(*pictures[i]), jobs_[i].gloss});
  return std::move(lab_);
}

}  // namespace foresight::sim
