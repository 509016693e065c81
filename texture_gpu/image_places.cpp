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
    : lenses_(right ? std::vector{left, *right} : std::vector{left}),
      largest_margin_px_(largest_margin_px),
      places_(lenses_.size()) {}

std::shared_ptr<PublishedImage> ImagePlaces::free_place(std::size_t camera, const FrameOnGpu& kept) {
  auto& places = places_[camera];
  for (const auto& place : places)
    if (std::ranges::find(kept.published, place) == kept.published.end() &&
        place->leases.load(std::memory_order_acquire) == 0)
      return place;
  auto fresh = std::make_shared<PublishedImage>();
  fresh->camera = places.empty() ? std::make_shared<CameraInput>(lenses_[camera], largest_margin_px_)
                                 : places.front()->camera->another();
  return places.emplace_back(std::move(fresh));
}

void ImagePlaces::place(const PosedFrame& frame, const FrameOnGpu& kept, FrameOnGpu& out) {
  out.compared = out.lent = false;
  out.images = {without_pixels(frame.left)};
  if (frame.right && lenses_.size() > 1) out.images.push_back(without_pixels(*frame.right));
  out.published.clear();
  out.cameras.clear();
  for (std::size_t i = 0; i < out.images.size(); ++i) {
    out.published.push_back(free_place(i, kept));
    out.cameras.push_back(out.published.back()->camera);
  }
  out.views.clear();
  for (std::size_t i = 0; i < out.images.size(); ++i) out.views.push_back(view_of(out.images[i], *out.cameras[i]));
}

}  // namespace foresight
