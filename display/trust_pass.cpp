#include "display/trust_pass.hpp"

#include <algorithm>
#include <array>
#include <string>

#include "display/shaders.hpp"

namespace foresight {
namespace {

constexpr double kLongest = 30;  // s that an image is remembered for

}  // namespace

TrustPass::TrustPass(std::shared_ptr<const gl::SceneBuffers> scene, std::shared_ptr<const SurfaceRecords> surface,
                     const Lens& lens, const PredictedView& view)
    : lens_(lens),
      surface_(std::move(surface)),
      raster_(std::move(scene), false),
      scratch_(view.faces().faces, false),
      depths_(GL_DEPTH_COMPONENT32F, scratch_.faces.width, scratch_.faces.height,
              scratch_.faces.count * static_cast<int>(kFrames), 1, "depth of images"),
      program_(gl::Program::compute(
          gl::display_shaders(), "trust.comp",
          {"FRAMES " + std::to_string(kFrames), "COMPARISONS " + std::to_string(kComparisonsKept),
           "CODED_AWAY " + std::to_string(kCodedAway), "MOSTLY_CODED_AWAY " + std::to_string(kMostlyCodedAway),
           "BESIDE_EDGE " + std::to_string(kBesideEdge), "ANYWHERE_PX " + std::to_string(kAnywherePx),
           "TOLD_STEPS " + std::to_string(kToldSteps), "LOSS_CONTRASTS " + std::to_string(kLossContrasts),
           "STEPS_A_CONTRAST " + std::to_string(kStepsAContrast)})),
      camera_(sizeof(gl::CameraBlock), "trusted camera"),
      view_(sizeof(gl::CameraBlock), "trusted view"),
      node_px_(GL_R32F, 16, "node px"),
      ways_(GL_RGBA32F, 16, "ways since images"),
      losses_(GL_R8UI, kLossColumns, kLossRows, static_cast<int>(kFrames), 1, "lost by coding"),
      comparisons_(GL_R8, lens.width(), lens.height(), static_cast<int>(kComparisonsKept), 1, "as it was shown") {
  const gl::CameraBlock block = gl::make_camera_block(lens_, scratch_.faces);
  camera_.write(std::span(&block, 1));
  fit(view);
}

void TrustPass::fit(const PredictedView& view) {
  const int width = view.lens().width(), height = view.lens().height();
  if (doubt_ && doubt_.width() == width && doubt_.height() == height) return;
  const gl::CameraBlock block = gl::make_camera_block(view.lens(), view.faces().faces);
  view_.write(std::span(&block, 1));
  doubt_ = gl::Texture(GL_R8, width, height, 0, 1, "doubt");
  marked_ = gl::Texture(GL_RGBA8, width, height, 0, 1, "marked view");
}

// Of those that are too many, the one between the two that are closest together for their age: what remains reaches far
// back, and is dense where it is new.
void TrustPass::forget_one() {
  const auto age = [this](std::size_t i) { return to_seconds(seen_.front().time - seen_[i].time); };
  std::size_t least = seen_.size() - 1;
  if (age(least) < kLongest) {
    double smallest = 1;
    for (std::size_t i = 1; i + 1 < seen_.size(); ++i) {
      const double share = (age(i + 1) - age(i - 1)) / std::max(age(i + 1), 1e-9);
      if (share >= smallest) continue;
      smallest = share;
      least = i;
    }
  }
  seen_.erase(seen_.begin() + static_cast<std::ptrdiff_t>(least));
}

void TrustPass::saw(const PosedImage& image) {
  if (!seen_.empty() && image.time <= seen_.front().time) seen_.clear();  // another clock
  if (seen_.size() == kFrames) forget_one();
  int layer = 0;
  const auto taken = [&] { return std::ranges::any_of(seen_, [&](const Seen& s) { return s.layer == layer; }); };
  while (taken()) layer += scratch_.faces.count;
  raster_(image.T_world_camera, image.scene, scratch_);
  glCopyImageSubData(scratch_.depth.name(), GL_TEXTURE_2D_ARRAY, 0, 0, 0, 0, depths_.name(), GL_TEXTURE_2D_ARRAY, 0, 0,
                     0, layer, scratch_.faces.width, scratch_.faces.height, scratch_.faces.count);
  const cv::Mat lost = image.lost.empty() ? cv::Mat::zeros(kLossRows, kLossColumns, CV_8UC1) : image.lost;
  glTextureSubImage3D(losses_.name(), 0, 0, 0, layer / scratch_.faces.count, kLossColumns, kLossRows, 1, GL_RED_INTEGER,
                      GL_UNSIGNED_BYTE, lost.data);
  seen_.insert(seen_.begin(), Seen{image.time, image.T_world_camera, image.scene, layer});
}

void TrustPass::compared(const PosedImage& image, const cv::Mat& comparison) {
  if (!compared_.empty() && image.time <= compared_.front().time) compared_.clear();  // another clock
  int layer = static_cast<int>(compared_.size());
  if (compared_.size() == kComparisonsKept) {
    layer = compared_.back().layer;
    compared_.pop_back();
  }
  compared_.insert(compared_.begin(), Seen{image.time, image.T_world_camera, image.scene, layer});
  with_patches_ = std::min(with_patches_ + 1, compared_.size());
  glTextureSubImage3D(comparisons_.name(), 0, 0, 0, layer, comparison.cols, comparison.rows, 1, GL_RED,
                      GL_UNSIGNED_BYTE, comparison.data);
}

void TrustPass::list_ways(const Pose& T_world_camera, const SceneState& state) {
  const std::size_t nodes = state.T_world_node.size();
  rows_.assign(4 * nodes * (kFrames + kComparisonsKept), Eigen::Vector4f::Zero());
  const auto list = [&](std::size_t set, const Seen& seen) {
    const Pose T_camera_world = seen.T_world_camera.inverse();
    for (std::size_t n = 0; n < std::min(nodes, seen.scene.T_world_node.size()); ++n) {
      const Pose T_then_now =
          seen.scene.T_world_node[n] * state.T_world_node[n].inverse();  // of the node, in the world
      const Eigen::Matrix4f m = (T_camera_world * T_then_now * T_world_camera).matrix().cast<float>();
      Eigen::Vector4f* row = &rows_[4 * (set * nodes + n)];
      for (int i = 0; i < 3; ++i) row[i] = m.row(i).transpose();
      const double turned = Eigen::AngleAxisd(Eigen::Matrix3d(T_then_now.linear())).angle();
      row[3].x() = static_cast<float>(turned);
    }
  };
  for (std::size_t i = 0; i < seen_.size(); ++i) list(i, seen_[i]);
  for (std::size_t i = 0; i < compared_.size(); ++i) list(kFrames + i, compared_[i]);
}

void TrustPass::operator()(const PredictedView& view, const Pose& T_world_camera, const SceneState& state,
                           std::span<const double> node_px, const ExactKinds& exact) {
  fit(view);
  list_ways(T_world_camera, state);
  ways_.assign(std::span<const Eigen::Vector4f>(rows_));
  std::vector<float> px(node_px.begin(), node_px.end());
  px.resize(state.T_world_node.size(), 0);
  node_px_.assign(std::span<const float>(px));

  std::array<int, kFrames> layers{};
  for (std::size_t i = 0; i < seen_.size(); ++i) layers[i] = seen_[i].layer;
  glProgramUniform1iv(program_.name(), glGetUniformLocation(program_.name(), "layer_of"),
                      static_cast<GLsizei>(layers.size()), layers.data());
  program_.set("faces", scratch_.faces.count);
  program_.set("frame_count", static_cast<int>(seen_.size()));
  program_.set("node_count", static_cast<int>(state.T_world_node.size()));
  std::array<GLuint, 8> bits{};
  for (std::size_t kind = 0; kind < exact.size(); ++kind)
    if (exact[kind]) bits[kind / 32] |= GLuint{1} << (kind % 32);
  glProgramUniform1uiv(program_.name(), glGetUniformLocation(program_.name(), "exact"),
                       static_cast<GLsizei>(bits.size()), bits.data());
  std::array<int, kComparisonsKept> comparisons{};
  for (std::size_t i = 0; i < compared_.size(); ++i) comparisons[i] = compared_[i].layer;
  glProgramUniform1iv(program_.name(), glGetUniformLocation(program_.name(), "layer_of_comparison"),
                      static_cast<GLsizei>(comparisons.size()), comparisons.data());
  program_.set("comparison_count", static_cast<int>(compared_.size()));
  program_.set("comparisons_with_patches", static_cast<int>(with_patches_));
  glBindBufferBase(GL_UNIFORM_BUFFER, 0, camera_.name());
  glBindBufferBase(GL_UNIFORM_BUFFER, 1, view_.name());
  const GLuint units[] = {view.picture().name(),     view.faces().surface.name(),
                          view.faces().depth.name(), surface_->triangles(),
                          view.rays().name(),        node_px_.texture(),
                          ways_.texture(),           depths_.name(),
                          comparisons_.name(),       losses_.name()};
  for (GLuint unit = 0; unit < std::size(units); ++unit) glBindTextureUnit(unit, units[unit]);
  glBindImageTexture(0, doubt_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R8);
  glBindImageTexture(1, marked_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
  program_.dispatch(doubt_.width(), doubt_.height());
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT |
                  GL_PIXEL_BUFFER_BARRIER_BIT);
}

}  // namespace foresight
