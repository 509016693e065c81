// `foresight bench head`: the rendering techniques of the head display, each beside what it is to be better than.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace foresight {

inline const std::vector<std::string> kHeadBenchLabParts{"warp", "recorded", "cube", "server", "stereograms", "openxr"};
inline const std::vector<std::string> kHeadBenchParts{"warp",   "recorded", "cube",        "server", "portals",
                                                      "levels", "sorting",  "stereograms", "openxr"};

struct HeadBenchOptions {
  std::optional<std::filesystem::path> run;  ///< whose images give the textures; nothing: a synthetic lab of 12 images
  int width = 640, height = 480;             ///< px of a view
  int views = 40;
  double degrees = 2, metres = 0.02;  ///< of head motion between drawing and showing
  double eyes_apart = 0.065;          ///< m
  unsigned seed = 1;
  std::optional<std::filesystem::path> path;  ///< a recorded head; nothing: one that sways
  int head_frames = 100;                      ///< of it, of views in all directions
  double seconds = 12;                        ///< of each trial in real time; 0: none
  double rate_hz = 20;                        ///< of them; pictures of half the size come 2.25 times as often
  std::size_t building =
      200'000;  ///< triangles of the building that portals, it and the workshop that levels are measured in
  int building_views = 1000;
  int openxr_frames = 900;                       ///< shown in the OpenXR runtime of this machine; 0: none
  std::vector<std::string> only;                 ///< parts of kHeadBenchParts; none: all
  std::optional<std::filesystem::path> picture;  ///< file for that of levels of detail
  std::optional<std::filesystem::path> json;

  bool wants(std::string_view part) const;
};

/// Prints a part for each technique, and writes its numbers under its name: head_pose_to_swap,
/// warped_against_rendered, recorded_head_motion, viewport_independent_rendering, portals, time_critical_rendering,
/// state_sorting_buffer, stereograms, openxr_session. Null: it was left out; missing: it is not one of `only`.
/// Returns 0.
int bench_head(const HeadBenchOptions& options);

}  // namespace foresight
