#include "texture_gpu/image_before.hpp"

#include <array>

namespace foresight {
namespace {

Eigen::Vector3f even_tone(const PublishedImage& image) {
  return {image.tone.x() / image.gain, image.tone.y(), image.tone.z()};
}

}  // namespace

void bind_with_before(SeenInputs& both, const gl::Program& program, const PublishedImage& newest,
                      const PublishedImage& before) {
  const std::array<const CameraInput*, 2> cameras{newest.camera.get(), before.camera.get()};
  const std::array<const PosedImage*, 2> images{&newest.image, &before.image};
  both.update(cameras, images, std::array{even_tone(newest), even_tone(before)});
  both.bind(program, newest.depth_tolerance);
  const Pose T_before_newest = before.image.T_world_camera.inverse() * newest.image.T_world_camera;
  program.set("T_before_newest", Eigen::Matrix4f(T_before_newest.matrix().cast<float>()));
  glBindTextureUnit(kRaysUnit, newest.camera->rays().name());
}

}  // namespace foresight
