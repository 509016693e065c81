// The lens of a head display: which panel pixel shows in which direction.
//
//   eye camera (calibrated) --ray--> display frame (x right, y down, z out of the eye) --lens--> panel pixel
//
// The display's lens is a camera's lens whose image is the panel: display/ draws with such a Lens as it is. The
// eye camera stands where the eye will; pictures may be turned against each other to reach the edges, and
// moved where the distance of the virtual image is known. The display frame is the one in which the panel is the
// plane z = const of the model: its tilt against the camera shows as keystone and decentred distortion.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "calibration/camera/camera_model.hpp"
#include "calibration/result/verdict.hpp"

namespace foresight {

/// A point of the panel as one picture shows it.
struct PanelPoint {
  int picture = 0;               ///< counted from 0
  Eigen::Vector2d camera_pixel;  ///< px of the eye camera
  Eigen::Vector2d panel_pixel;   ///< px of the panel, pixel centres at integers
};

struct DisplayLensOptions {
  int panel_width = 0;   ///< px
  int panel_height = 0;  ///< px
  std::vector<Distortion> models{Distortion::radtan4, Distortion::radtan5, Distortion::rational,
                                 Distortion::equidistant};  ///< the one with the least held-out error is taken
  std::optional<double> virtual_distance_m;  ///< of the panel's image; without: infinity, and no positions
  double outlier_sigmas = 5;                 ///< of the median absolute deviation
  int folds = 5;                             ///< of the held-out score
};

struct DisplayLensSummary {
  CameraModel panel;                   ///< the lens; its image is the panel
  std::vector<Pose> T_display_camera;  ///< of each picture; the eye's position, 0 without a virtual distance
  double rms_px = 0;                   ///< panel px
  double held_out_px = 0;              ///< RMS of points that were left out, panel px
  double held_out_worst_px = 0;
  int points = 0;
  int rejected = 0;
  double sigma_focal_px = 0;
  double sigma_centre_px = 0;
  double sigma_tilt_rad = 0;                         ///< of the first picture's rotation
  std::vector<std::pair<Distortion, double>> tried;  ///< held-out RMS of every model
  std::vector<std::string> warnings;
  Verdict verdict;
};

/// Residual: lens(T_display_camera * ray) - panel pixel, in panel px, Huber's loss at 1.5; all lens parameters of the
/// model and all rotations are free. Gauge: the first picture's position is 0. Start: an affine fit of the panel over
/// the rays nearest to the axis. Throws InputError naming the picture: fewer than 12 points, points on a line, a panel
/// that shows mirrored; RuntimeFailure where nothing converges.
DisplayLensSummary solve_display_lens(const std::vector<PanelPoint>& points, const CameraModel& eye_camera,
                                      const DisplayLensOptions& options);

/// The lens of one colour: focal lengths and distortion for that colour's points, poses and centre as in `base`.
CameraModel solve_colour(const std::vector<PanelPoint>& points, const CameraModel& eye_camera,
                         const DisplayLensSummary& base, const DisplayLensOptions& options);

}  // namespace foresight
