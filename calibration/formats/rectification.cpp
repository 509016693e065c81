#include "calibration/formats/rectification.hpp"

#include <opencv2/calib3d.hpp>
#include <opencv2/core/eigen.hpp>

namespace foresight {
namespace {

struct CvCamera {
  cv::Matx33d K;
  cv::Mat D;
};

CvCamera cv_camera(const CameraModel& camera) {
  const LensParameters& l = camera.lens;
  const int count = camera.distortion == Distortion::equidistant ? 4 : 12;
  CvCamera out{{l[0], 0, l[2], 0, l[1], l[3], 0, 0, 1}, cv::Mat(1, count, CV_64F)};
  for (int i = 0; i < count; ++i) out.D.at<double>(i) = l[static_cast<std::size_t>(4 + i)];
  return out;
}

}  // namespace

bool can_be_rectified(const CalibratedCameras& pair) {
  const CameraModel &a = pair.left(), &b = pair.right();
  return a.width == b.width && a.height == b.height &&
         (a.distortion == Distortion::equidistant) == (b.distortion == Distortion::equidistant);
}

Rectification rectify(const CalibratedCameras& pair) {
  const CvCamera left = cv_camera(pair.left()), right = cv_camera(pair.right());
  const Pose T_right_left = pair.T_left_right.inverse();
  cv::Mat R, T, R1, R2, P1, P2, Q;
  cv::eigen2cv(Eigen::Matrix3d(T_right_left.linear()), R);
  cv::eigen2cv(Eigen::Vector3d(T_right_left.translation()), T);
  const cv::Size size(pair.left().width, pair.left().height);
  if (pair.left().distortion == Distortion::equidistant)
    cv::fisheye::stereoRectify(left.K, left.D, right.K, right.D, size, R, T, R1, R2, P1, P2, Q,
                               cv::CALIB_ZERO_DISPARITY, size, 0);
  else
    cv::stereoRectify(left.K, left.D, right.K, right.D, size, R, T, R1, R2, P1, P2, Q, cv::CALIB_ZERO_DISPARITY, 0,
                      size);
  Rectification out;
  cv::cv2eigen(R1, out.R_left), cv::cv2eigen(R2, out.R_right);
  cv::cv2eigen(P1, out.P_left), cv::cv2eigen(P2, out.P_right);
  cv::cv2eigen(Q, out.Q);
  return out;
}

}  // namespace foresight
