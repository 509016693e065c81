#include "display/stereogram/stereogram.hpp"

#include <cmath>
#include <opencv2/imgproc.hpp>
#include <stdexcept>

namespace foresight::gl {
const ShaderSources& stereogram_shaders();
}  // namespace foresight::gl

namespace foresight {
namespace {

constexpr int kReach = 2;  // columns to the right of a link that its filter reads

gl::Texture upload(const cv::Mat& picture, const char* label) {
  gl::Texture out(GL_RGBA8, picture.cols, picture.rows, 0, 1, label);
  cv::Mat rgba;
  cv::cvtColor(picture, rgba, picture.channels() == 4 ? cv::COLOR_BGRA2RGBA : cv::COLOR_BGR2RGBA);
  glTextureSubImage2D(out.name(), 0, 0, 0, rgba.cols, rgba.rows, GL_RGBA, GL_UNSIGNED_BYTE, rgba.data);
  return out;
}

}  // namespace

Stereogram::Stereogram(int width, int height, const cv::Mat& pattern) : width_(width), height_(height) {
  if (width < 1 || height < 1) throw std::invalid_argument("a stereogram of no size");
  const auto& shaders = gl::stereogram_shaders();
  links_program_ = gl::Program::compute(shaders, "links.comp");
  one_ = gl::Program::compute(shaders, "strips.comp");
  two_ = gl::Program::compute(shaders, "strips.comp", {"TWO_PICTURES"});
  floater_program_ = gl::Program::compute(shaders, "floater.comp");
  links_ = gl::Texture(GL_R32F, width, height, 0, 1, "links of a stereogram");
  for (gl::Texture& picture : pictures_) picture = gl::Texture(GL_RGBA8, width, height, 0, 1, "stereogram");
  if (pattern.empty()) return;
  pattern_ = upload(pattern, "pattern of a stereogram");
  glTextureParameteri(pattern_.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  glTextureParameteri(pattern_.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  for (const GLenum way : {GL_TEXTURE_WRAP_S, GL_TEXTURE_WRAP_T}) glTextureParameteri(pattern_.name(), way, GL_REPEAT);
}

void Stereogram::operator()(const gl::Texture& depth, const DepthRange& range, const StereogramOptions& options) {
  if (depth.width() != width_ || depth.height() != height_)
    throw std::invalid_argument("a stereogram has another size than its depth");
  if (!(range.near > 0 && range.near < range.far)) throw std::invalid_argument("a stereogram of no range of depth");
  if (!(options.depth.least() >= kLeastSeparation) || !(options.depth.most() < width_))
    throw std::invalid_argument("separations of a stereogram that its picture cannot have");
  options_ = options;
  find_links(depth, range);
  draw_strips();
}

void Stereogram::find_links(const gl::Texture& depth, const DepthRange& range) {
  const double farthest = 1 / range.far;
  links_program_.set("size", Eigen::Vector2i(width_, height_));
  links_program_.set("range", Eigen::Vector2d(farthest, 1 / (1 / range.near - farthest)).cast<float>().eval());
  links_program_.set("eyes",
                     Eigen::Vector2d(options_.depth.eye_distance, options_.depth.depth_of_field).cast<float>().eval());
  links_program_.set("bounds", Eigen::Vector2d(options_.depth.least(), options_.depth.most()).cast<float>().eval());
  links_program_.set("inverted", options_.depth.inverted ? 1 : 0);
  links_program_.set("hides", options_.hides ? 1 : 0);
  links_program_.set("smooth_links", options_.smooth ? 1 : 0);
  glBindTextureUnit(0, depth.name());
  glBindImageTexture(0, links_.name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_R32F);
  links_program_.dispatch(width_, height_);
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT);
}

void Stereogram::draw_strips() {
  const bool two = options_.pictures == StripPictures::two;
  const gl::Program& program = two ? two_ : one_;
  program.set("size", Eigen::Vector2i(width_, height_));
  program.set("period", static_cast<int>(std::lround(options_.depth.most())));
  program.set("dots", pattern_ ? 0 : options_.dot);
  program.set("seed", options_.seed);
  program.set("frame", options_.frame);
  glBindTextureUnit(0, links_.name());
  if (pattern_) glBindTextureUnit(1, pattern_.name());
  const int step = static_cast<int>(options_.depth.least()) - kReach;
  std::size_t into = 0;
  for (int first = 0; first < width_; first += step, into ^= 1) {
    const int last = std::min(first + step, width_);
    // In turn, the strip before is drawn once more, as only the other picture has it.
    const int from = two ? std::max(first - step, 0) : first;
    program.set("strip", Eigen::Vector2i(from, last));
    if (two) {
      glBindImageTexture(0, pictures_[into ^ 1].name(), 0, GL_FALSE, 0, GL_READ_ONLY, GL_RGBA8);
      glBindImageTexture(1, pictures_[into].name(), 0, GL_FALSE, 0, GL_WRITE_ONLY, GL_RGBA8);
      shown_ = into;
    } else {
      glBindImageTexture(0, pictures_[0].name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA8);
      shown_ = 0;
    }
    program.dispatch(last - from, height_);
    glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT);
  }
  glMemoryBarrier(GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT | GL_FRAMEBUFFER_BARRIER_BIT);
}

void Stereogram::float_over(const Floater& floater) {
  const gl::Texture sprite = upload(floater.picture, "floater");
  floater_program_.set("size", Eigen::Vector2i(width_, height_));
  const double separation = options_.depth.separation(floater.nearness);
  // The right eye's copy; the left eye's is the one before.
  floater_program_.set("middle", Eigen::Vector2d(floater.x + 0.5 * separation, floater.y).cast<float>().eval());
  floater_program_.set("separation", static_cast<float>(separation));
  glBindTextureUnit(0, sprite.name());
  glBindImageTexture(0, picture().name(), 0, GL_FALSE, 0, GL_READ_WRITE, GL_RGBA8);
  floater_program_.dispatch(width_, height_);
  glMemoryBarrier(GL_SHADER_IMAGE_ACCESS_BARRIER_BIT | GL_TEXTURE_FETCH_BARRIER_BIT | GL_TEXTURE_UPDATE_BARRIER_BIT |
                  GL_FRAMEBUFFER_BARRIER_BIT);
}

cv::Mat Stereogram::read() const {
  cv::Mat rgba(height_, width_, CV_8UC4), out;
  glGetTextureImage(picture().name(), 0, GL_RGBA, GL_UNSIGNED_BYTE, static_cast<GLsizei>(4 * rgba.total()), rgba.data);
  cv::cvtColor(rgba, out, cv::COLOR_RGBA2BGR);
  return out;
}

}  // namespace foresight
