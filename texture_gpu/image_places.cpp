#include "texture_gpu/image_places.hpp"

#include <algorithm>

namespace foresight {
namespace {

PosedImage without_pixels(const PosedImage& image) {
  return {{}, image.time, image.T_world_camera, image.scene, image.margin_px};
}

AtlasView view_of(const PosedImage& image, const CameraInput& camera) {
  AtlasView view{&camera.lens(), &camera.faces().faces, {}};
  const Pose T_camera_world = image.T_world_camera.inverse();
  for (const Pose& T_world_node : image.scene.T_world_node) view.T_camera_node.push_back(T_camera_world * T_world_node);
  return view;
}

}  // namespace

void FrameOnGpu::update_inputs(std::span<const Eigen::Vector3f> tones) {
  std::vector<const CameraInput*> all_cameras;
  std::vector<const PosedImage*> all_images;
  for (std::size_t i = 0; i < images.size(); ++i) {
    all_cameras.push_back(cameras[i].get());
    all_images.push_back(&images[i]);
  }
  inputs.update(all_cameras, all_images, tones);
}

ImagePlaces::ImagePlaces(const Lens& left, const std::optional<Lens>& right, double largest_margin_px)
    : left_(left), right_(right), largest_margin_px_(largest_margin_px) {}

std::shared_ptr<PublishedImage> ImagePlaces::free_left(const FrameOnGpu& kept) {
  for (const auto& place : lefts_)
    if (place != kept.published && place->leases.load(std::memory_order_acquire) == 0) return place;
  auto fresh = std::make_shared<PublishedImage>();
  fresh->camera =
      lefts_.empty() ? std::make_shared<CameraInput>(left_, largest_margin_px_) : lefts_.front()->camera->another();
  return lefts_.emplace_back(std::move(fresh));
}

std::shared_ptr<CameraInput> ImagePlaces::free_right(const FrameOnGpu& kept) {
  for (const auto& place : rights_)
    if (std::ranges::find(kept.cameras, place) == kept.cameras.end()) return place;
  return rights_.emplace_back(rights_.empty() ? std::make_shared<CameraInput>(*right_, largest_margin_px_)
                                              : rights_.front()->another());
}

void ImagePlaces::place(const PosedFrame& frame, const FrameOnGpu& kept, FrameOnGpu& out) {
  out.compared = false;
  out.published = free_left(kept);
  out.cameras = {out.published->camera};
  out.images = {without_pixels(frame.left)};
  if (frame.right && right_) {
    out.cameras.push_back(free_right(kept));
    out.images.push_back(without_pixels(*frame.right));
  }
  out.views.clear();
  for (std::size_t i = 0; i < out.images.size(); ++i) out.views.push_back(view_of(out.images[i], *out.cameras[i]));
}

}  // namespace foresight
