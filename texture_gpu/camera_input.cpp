#include "texture_gpu/camera_input.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "gl/lens_rays.hpp"

namespace foresight {
namespace {

constexpr double kUploadTimeout = 5;  // seconds
constexpr std::size_t kMostStaging = 3;

gl::Faces faces_with_margin(const Lens& lens, double margin_px) {
  return gl::faces_for(lens, static_cast<int>(std::ceil(margin_px)) + 2);
}

int level_count(const Lens& lens) {
  return std::bit_width(static_cast<unsigned>(std::max(lens.width(), lens.height())));
}

}  // namespace

CameraInput::Camera::Camera(const Lens& seen_through, const gl::Faces& of_faces)
    : lens(seen_through),
      faces(of_faces, false),
      rays(gl::make_lens_rays(lens)),
      block(sizeof(gl::CameraBlock), "camera") {
  const gl::CameraBlock content = gl::make_camera_block(lens, of_faces);
  block.write(std::span(&content, 1));
}

CameraInput::Camera::~Camera() {
  for (const Staging& one : staging) glUnmapNamedBuffer(one.buffer.name());
}

CameraInput::Staging::Staging(GLsizeiptr bytes) {
  constexpr GLbitfield kFlags = GL_MAP_WRITE_BIT | GL_MAP_PERSISTENT_BIT | GL_MAP_COHERENT_BIT;
  GLuint name = 0;
  glCreateBuffers(1, &name);
  buffer = gl::Handle<gl::delete_buffer>(name);
  glNamedBufferStorage(name, bytes, nullptr, kFlags);
  memory = glMapNamedBufferRange(name, 0, bytes, kFlags);
}

CameraInput::Staging& CameraInput::Camera::free_staging() {
  const bool is_busy = staging.empty() || !staging.front().read.signalled();
  if (is_busy && staging.size() < kMostStaging)
    staging.emplace(staging.begin(), static_cast<GLsizeiptr>(4) * lens.width() * lens.height());
  staging.front().read.wait(kUploadTimeout);
  std::ranges::rotate(staging, staging.begin() + 1);
  return staging.back();
}

CameraInput::CameraInput(const Lens& lens, double largest_margin_px)
    : CameraInput(std::make_shared<Camera>(lens, faces_with_margin(lens, largest_margin_px))) {}

CameraInput::CameraInput(std::shared_ptr<Camera> camera)
    : camera_(std::move(camera)),
      image_(GL_RGBA8, lens().width(), lens().height(), 0, level_count(lens()), "camera image"),
      blocks_(GL_RG32F, (faces().faces.width + 3) / 4, (faces().faces.height + 3) / 4, faces().faces.count, 1,
              "depth blocks"),
      marked_depth_(GL_R32F, faces().faces.width, faces().faces.height, faces().faces.count, 1, "marked depth") {
  glTextureParameteri(image_.name(), GL_TEXTURE_MAG_FILTER, GL_LINEAR);
  glTextureParameteri(image_.name(), GL_TEXTURE_MIN_FILTER, GL_LINEAR);
}

std::shared_ptr<CameraInput> CameraInput::another() const {
  return std::shared_ptr<CameraInput>(new CameraInput(camera_));
}

void CameraInput::upload(const cv::Mat& pixels) {
  CV_Assert(pixels.cols == lens().width() && pixels.rows == lens().height());
  Staging& staging = camera_->free_staging();
  cv::Mat target(pixels.rows, pixels.cols, CV_8UC4, staging.memory);
  cv::cvtColor(pixels, target, pixels.channels() == 1 ? cv::COLOR_GRAY2RGBA : cv::COLOR_BGR2RGBA);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, staging.buffer.name());
  glTextureSubImage2D(image_.name(), 0, 0, 0, pixels.cols, pixels.rows, GL_RGBA, GL_UNSIGNED_BYTE, nullptr);
  glBindBuffer(GL_PIXEL_UNPACK_BUFFER, 0);
  staging.read = gl::Fence::insert();
  has_levels_ = false;
}

std::uint64_t CameraInput::bytes() const {
  const auto pixels = [](int width, int height) {
    return static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height);
  };
  constexpr std::uint64_t kDepth = 4, kColour = 4;  // of a pixel
  const std::uint64_t of_a_face = pixels(marked_depth_.width(), marked_depth_.height()) * kDepth +
                                  pixels(blocks_.width(), blocks_.height()) * 2 * sizeof(float);
  return of_a_face * static_cast<std::uint64_t>(faces().faces.count) +
         pixels(lens().width(), lens().height()) * kColour * 4 / 3;
}

void CameraInput::build_levels() const {
  if (!std::exchange(has_levels_, true)) glGenerateTextureMipmap(image_.name());
}

}  // namespace foresight
