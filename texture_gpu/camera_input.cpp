#include "texture_gpu/camera_input.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <opencv2/imgproc.hpp>

#include "gl/lens_rays.hpp"

namespace foresight {
namespace {

constexpr double kUploadTimeout = 5;  // seconds

int level_count(const Lens& lens) {
  return std::bit_width(static_cast<unsigned>(std::max(lens.width(), lens.height())));
}

}  // namespace

CameraInput::CameraInput(const Lens& lens, double largest_margin_px)
    : lens_(lens),
      faces_(gl::faces_for(lens, static_cast<int>(std::ceil(largest_margin_px)) + 2), false),
      image_(GL_RGBA8, lens.width(), lens.height(), 0, level_count(lens), "camera image"),
      blocks_(GL_RG32F, (faces_.faces.width + 3) / 4, (faces_.faces.height + 3) / 4, faces_.faces.count, 1,
              "depth blocks"),
      uncertain_(GL_R8, faces_.faces.width, faces_.faces.height, faces_.faces.count, 1, "uncertain edges"),
      rays_(gl::make_lens_rays(lens)),
      block_(sizeof(gl::CameraBlock), "camera") {
  const gl::CameraBlock block = gl::make_camera_block(lens, faces_.faces);
  block_.write(std::span(&block, 1));
  glTextureParameteri(image_.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(image_.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
  const auto bytes = static_cast<GLsizeiptr>(4) * lens.width() * lens.height();
  constexpr GLbitfield kFlags = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  for (Staging& staging : ring_) {
    GLuint name = 0;
    glCreateBuffers(1, &name);
    staging.buffer = gl::Handle<gl::delete_buffer>(name);
    glNamedBufferStorage(name, bytes, nullptr, kFlags);
    staging.memory = glMapNamedBufferRange(name, 0, bytes, kFlags);
  }
}

CameraInput::~CameraInput() {
  for (Staging& staging : ring_) glUnmapNamedBuffer(staging.buffer.name());
}

void CameraInput::upload(const cv::Mat& pixels) {
  CV_Assert(pixels.cols == lens_.width() && pixels.rows == lens_.height());
  Staging& staging = ring_[next_];
  next_ = (next_ + 1) % ring_.size();
  staging.read.wait(kUploadTimeout);
  cv::Mat target(pixels.rows, pixels.cols, CV_8UC4, staging.memory);
  cv::cvtColor(pixels, target, pixels.channels() == 1 ? cv::COLOR_GRAY2RGBA : cv::COLOR_BGR2RGBA);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, staging.buffer.name());
  glTextureSubImage2D(image_.name(), 0, 0, 0, pixels.cols, pixels.rows, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  staging.read = gl::Fence::insert();
}

void CameraInput::build_levels() const {
  glGenerateTextureMipmap(image_.name());
}

}  // namespace foresight
