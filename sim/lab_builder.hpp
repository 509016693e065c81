// Collects the parts and materials of a lab; the pictures are painted at the end, on all cores.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "sim/lab.hpp"

namespace foresight::sim {

/// One thread.
class LabBuilder {
 public:
  LabBuilder(double texel, unsigned seed) : texel_(texel), seed_(seed) {}

  /// Index of a new material. `print(texel, seed)` paints its picture, later and on any thread.
  int material(std::function<cv::Mat(double, unsigned)> print, double coarser = 1, float gloss = 0);
  int plain(std::uint32_t colour, double roughness = 0.05, float gloss = 0);

  /// The facets of a new part; valid until the next part is added.
  Facets& part(const std::string& name, const Pose& T_world_part, double light_step, bool moves = false);
  std::size_t part_count() const { return lab_.parts.size(); }

  /// Ends the work: paints, and hands over the lab.
  Lab finish();

 private:
  struct Job {
    std::function<cv::Mat(double, unsigned)> print;
    double texel;
    unsigned seed;
    float gloss;
  };
  Lab lab_;
  double texel_;
  unsigned seed_;
  std::vector<Job> jobs_;
};

}  // namespace foresight::sim
