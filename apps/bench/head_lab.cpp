#include "apps/bench/head_lab.hpp"

#include <cmath>

#include "common/cpu_time.hpp"

namespace foresight {
namespace {

constexpr std::size_t kMostImages = 12;

ViewSetup setup_of(const RunFolder& run, Clock& clock) {
  ViewSetup out;
  out.scene = run.scene();
  out.left = run.lens_left();
  out.right = run.lens_right();
  out.surface = surface_for(run);
  out.gate = std::make_shared<FrameGate>(clock);
  return out;
}

}  // namespace

Lens bench_eye(const Lens& camera, int width, int height, int guard) {
  Lens::Parameters p;
  p.width = width + 2 * guard;
  p.height = height + 2 * guard;
  p.fx = p.fy = camera.parameters().fx * width / camera.width();
  p.cx = (p.width - 1) / 2.0;
  p.cy = (p.height - 1) / 2.0;
  return Lens(p);
}

Pose in_camera_axes(const Pose& head) {
  const Eigen::Vector3d mirror(1, -1, 1);  // on both sides: a motion stays one
  Pose out = Pose::Identity();
  out.translation() = mirror.cwiseProduct(head.translation());
  out.linear() = mirror.asDiagonal() * head.linear() * mirror.asDiagonal();
  return out;
}

double picture_decibels(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference;
  cv::absdiff(a, b, difference);
  difference.convertTo(difference, CV_64F);
  const cv::Scalar squares = cv::sum(difference.mul(difference));
  const double mean = (squares[0] + squares[1] + squares[2]) / (3.0 * static_cast<double>(a.total()));
  return mean > 0 ? 10 * std::log10(255 * 255 / mean) : 100;
}

double gpu_cpu_ms(const std::function<void()>& work) {
  glFinish();
  const double before = cpu_seconds(CLOCK_PROCESS_CPUTIME_ID);
  work();
  glFinish();
  return 1e3 * (cpu_seconds(CLOCK_PROCESS_CPUTIME_ID) - before);
}

HeadLab::HeadLab(const RunFolder& run, gl::Context& context, Clock& clock)
    : setup_(setup_of(run, clock)), session_(context, setup_) {
  const std::size_t images = std::min(kMostImages, run.frames().size());
  for (std::size_t i = 0; i < images; ++i) {
    frames_.push_back(load_posed_frame(run, i));
    session_.process(frames_.back());
  }
  T_world_camera_ = frames_.back().left.T_world_camera;
  state_ = frames_.back().left.scene;
}

}  // namespace foresight
