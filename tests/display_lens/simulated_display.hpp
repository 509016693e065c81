// A head display of known lens, and an eye camera in front of it.
#pragma once

#include <Eigen/Geometry>
#include <random>

#include "calibration/display_lens/panel_pattern.hpp"
#include "common/lens.hpp"

namespace foresight {

struct SimulatedDisplay {
  PanelPattern pattern{1440, 1600, 15, 16, 88};
  CameraModel panel{1440, 1600, Distortion::radtan5, {840, 838, 702, 810, -0.22, 0.055, 0.0004, -0.0006, -0.0065}};
  CameraModel eye{1280, 1024, Distortion::radtan4, {620, 621, 645, 509, -0.05, 0.01, 1e-4, -2e-4}};
  std::vector<Pose> T_display_camera;

  SimulatedDisplay() {
    for (const auto& [yaw, pitch, roll] : {std::array{0.03, -0.02, 0.01}, {0.25, 0.02, -0.02}, {-0.22, 0.1, 0.0}}) {
      Pose T = Pose::Identity();
      T.linear() =
          (Eigen::AngleAxisd(yaw, Eigen::Vector3d::UnitY()) * Eigen::AngleAxisd(pitch, Eigen::Vector3d::UnitX()) *
           Eigen::AngleAxisd(roll, Eigen::Vector3d::UnitZ()))
              .toRotationMatrix();
      T_display_camera.push_back(T);
    }
  }

  /// Corners that the eye camera sees, with noise in its own pixels. `distance`: of the virtual image; 0: infinity.
  std::vector<PanelPoint> points(double noise, unsigned seed, double distance = 0) const {
    std::mt19937 random(seed);
    std::normal_distribution<double> normal(0, noise);
    const Lens lens = to_lens(panel), camera = to_lens(eye);
    std::vector<PanelPoint> out;
    for (std::size_t i = 0; i < T_display_camera.size(); ++i)
      for (int row = 0; row < pattern.rows; ++row)
        for (int col = 0; col < pattern.cols; ++col) {
          const Eigen::Vector2d at = pattern.corner(col, row);
          const auto direction = lens.unproject(at);
          if (!direction) continue;
          Eigen::Vector3d p = T_display_camera[i].linear().transpose() * *direction;
          if (distance > 0) p = T_display_camera[i].inverse() * Eigen::Vector3d(*direction * distance / direction->z());
          const auto pixel = camera.project(p);
          if (!pixel || pixel->x() < 5 || pixel->y() < 5 || pixel->x() > eye.width - 6 || pixel->y() > eye.height - 6)
            continue;
          out.push_back({static_cast<int>(i), *pixel + Eigen::Vector2d(normal(random), normal(random)), at});
        }
    return out;
  }
};

/// What the eye camera takes of the panel that shows `panel`: every camera pixel is traced to the panel.
cv::Mat picture_of(const SimulatedDisplay& display, const cv::Mat& panel, std::size_t picture);

struct PanelArea {
  double left = 100, top = 100, right = 1340, bottom = 1500;  ///< panel px
};

/// Largest distance in px between the true and the found panel pixel over directions in `area` of which the solver has
/// seen none, where the pictures show it; infinite where there are hardly any.
double worst_unseen(const SimulatedDisplay& display, const CameraModel& found, const Eigen::Matrix3d& R_found_true,
                    const PanelArea& area = {});

}  // namespace foresight
