// What the extraction of one frame did and cost.
#pragma once

#include <Eigen/Core>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "texture_gpu/chart_atlas.hpp"
#include "texture_gpu/lamp/lamp_search.hpp"
#include "texture_gpu/stage_clock.hpp"

namespace foresight {

struct ExtractionReport {
  bool published = false;    ///< false: dropped, the display never gave back its textures
  std::uint64_t number = 0;  ///< of the published generation
  RobotTime newest_image;    ///< capture instant of the frame
  std::chrono::steady_clock::time_point published_at;
  std::vector<StageCost> stages;
  double log_gain = 0;                    ///< of the left image (exposure.hpp)
  std::optional<double> misplacement_px;  ///< of images beside textures, along each axis (sharpness.hpp)
  LampAnswer lamp;                        ///< what is known of the main lamp
  /// On red and blue of the right camera's images, whose colours are not the left one's (colour_balance.hpp).
  std::optional<Eigen::Vector2d> right_factors;
  std::size_t images_kept = 0;       ///< that views look up, the newest included; 0 where only that is
  std::size_t pages = 0;             ///< pages written; the thesis' pipeline: polygons
  std::size_t tiles = 0;             ///< tiles of 64 texels for which an image was asked
  std::size_t texels_written = 0;    ///< of these tiles, those copied beside them, and those of changed resolutions
  std::uint64_t bytes_in_use = 0;    ///< of all textures; the atlas counts both generations
  std::uint64_t bytes_reserved = 0;  ///< held for it, at most TextureOptions::memory_bytes
  std::uint64_t texels_resident = 0;
  ChartAtlas::Policy policy;
};

}  // namespace foresight
