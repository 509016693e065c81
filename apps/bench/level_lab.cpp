#include "apps/bench/level_lab.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>

#include "apps/bench/head_lab.hpp"

namespace foresight {
namespace {

constexpr double kWave = 15;  // rad/m of the pattern
constexpr int kBlock = 16;    // px

/// Colour of a point of a node, by how squarely it faces the eye (0..1).
Eigen::Vector3f colour_at(const Eigen::Vector3f& p, std::size_t node, float facing) {
  const float hue = 0.7f * static_cast<float>(node % 97);
  const float wave = 0.5f + 0.25f * std::sin(static_cast<float>(kWave) * p.x() + hue) +
                     0.25f * std::cos(static_cast<float>(kWave) * (p.y() + 0.7f * p.z()));
  const Eigen::Vector3f own(0.6f + 0.35f * std::sin(hue), 0.6f + 0.35f * std::sin(hue + 2),
                            0.6f + 0.35f * std::sin(hue + 4));
  return own * (0.5f + 0.5f * wave) * (0.35f + 0.65f * facing);
}

}  // namespace

LevelLab::LevelLab(const SceneModel& scene, std::shared_ptr<const SceneLevels> levels, const Lens& lens,
                   gl::LeavesOut leaves_out)
    : levels_(std::move(levels)),
      lens_(lens),
      buffers_(std::make_shared<const gl::LevelBuffers>(scene, levels_)),
      pass_(buffers_),
      faces_(gl::faces_for(lens, 0), true, true),
      in_full_(levels_, {.rule = LevelRule::full}) {
  for (std::size_t n = 0; n < scene.nodes().size(); ++n)
    node_of_triangle_.insert(node_of_triangle_.end(), scene.nodes()[n].mesh.triangles.size(),
                             static_cast<std::uint16_t>(n));
  pass_.leave_out(leaves_out);
}

LevelFrame LevelLab::draw(const HeadInScene& head, LevelDirector& director) {
  LevelFrame out;
  FrameWork work;
  out.cpu_ms = gpu_cpu_ms([&] {
    const gl::SeenNodes seen = pass_.seen_from(head.T_world_camera, head.state, faces_.faces);
    const LevelPlan& plan =
        director.plan({head.T_world_camera, faces_.faces.fx, head.seconds}, head.state, seen.anywhere);
    pass_(head.T_world_camera, head.state, plan, seen, faces_);
    work = plan.work;
  });
  director.took(work, out.cpu_ms);
  out.picture = shaded(head);
  return out;
}

LevelFrame LevelLab::draw(const HeadInScene& head, const LevelPlan& plan) {
  LevelFrame out;
  out.cpu_ms = gpu_cpu_ms([&] {
    pass_(head.T_world_camera, head.state, plan, pass_.seen_from(head.T_world_camera, head.state, faces_.faces),
          faces_);
  });
  out.picture = shaded(head);
  return out;
}

LevelFrame LevelLab::draw_in_full(const HeadInScene& head) {
  return draw(head, in_full_);
}

std::vector<GLuint> LevelLab::surfaces() const {
  std::vector<GLuint> out(static_cast<std::size_t>(faces_.faces.width) * static_cast<std::size_t>(faces_.faces.height));
  glGetTextureImage(faces_.surface.name(), 0, GL_RED_INTEGER, GL_UNSIGNED_INT, static_cast<GLsizei>(4 * out.size()),
                    out.data());
  return out;
}

cv::Mat LevelLab::levels_seen(const LevelPlan& plan) const {
  constexpr int kFinest = 40, kStep = 30;  // grey levels
  const std::vector<GLuint> surface = surfaces();
  cv::Mat out(faces_.faces.height, faces_.faces.width, CV_8UC3, cv::Scalar(120, 60, 20));
  for (std::size_t i = 0; i < surface.size(); ++i) {
    if (surface[i] == 0) continue;
    const uchar grey = cv::saturate_cast<uchar>(kFinest + kStep * plan.blends[node_of_triangle_[surface[i] - 1]].level);
    out.at<cv::Vec3b>(static_cast<int>(i) / out.cols, static_cast<int>(i) % out.cols) = {grey, grey, grey};
  }
  return out;
}

cv::Mat LevelLab::shaded(const HeadInScene& head) const {
  const int width = faces_.faces.width, height = faces_.faces.height;
  const std::vector<GLuint> surface = surfaces();
  std::vector<Eigen::Vector4f> planes(surface.size());
  glGetTextureImage(faces_.planes.name(), 0, GL_RGBA, GL_FLOAT, static_cast<GLsizei>(16 * planes.size()),
                    planes.data());
  std::vector<Eigen::Isometry3f> T_node_camera;
  for (const Pose& T_world_node : head.state.T_world_node)
    T_node_camera.push_back((T_world_node.inverse() * head.T_world_camera).cast<float>());
  cv::Mat out(height, width, CV_8UC3, cv::Scalar::all(0));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const std::size_t at =
          static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x);
      if (surface[at] == 0) continue;
      const std::size_t node = node_of_triangle_[surface[at] - 1];
      const Eigen::Isometry3f& T = T_node_camera[node];
      const Eigen::Vector3f ray =
          T.linear() *
          Eigen::Vector3f(
              (static_cast<float>(x) - static_cast<float>(faces_.faces.cx)) / static_cast<float>(faces_.faces.fx),
              (static_cast<float>(y) - static_cast<float>(faces_.faces.cy)) / static_cast<float>(faces_.faces.fy), 1);
      const Eigen::Vector3f n = planes[at].head<3>(), o = T.translation();
      const float facing = n.dot(ray);
      const Eigen::Vector3f p = o + (planes[at].w() - n.dot(o)) / (std::abs(facing) > 1e-9f ? facing : 1e-9f) * ray;
      const Eigen::Vector3f colour = 255 * colour_at(p, node, std::abs(facing) / ray.norm());
      out.at<cv::Vec3b>(y, x) = {cv::saturate_cast<uchar>(colour.z()), cv::saturate_cast<uchar>(colour.y()),
                                 cv::saturate_cast<uchar>(colour.x())};
    }
  return out;
}

double largest_jump(const cv::Mat& a, const cv::Mat& b) {
  cv::Mat difference, blocks;
  cv::absdiff(a, b, difference);
  difference.convertTo(difference, CV_32F);
  cv::Mat squares = difference.mul(difference);
  cv::resize(squares, blocks, {a.cols / kBlock, a.rows / kBlock}, 0, 0, cv::INTER_AREA);
  double most = 0;
  cv::minMaxLoc(blocks.reshape(1), nullptr, &most);
  return std::sqrt(most);
}

}  // namespace foresight
