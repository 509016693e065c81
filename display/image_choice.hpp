// Which of the images at hand a view looks its points up in, beside the newest one.
#pragma once

#include <vector>

#include "texture_gpu/published_image.hpp"

namespace foresight {

struct ChosenImage {
  const PublishedImage* image = nullptr;
  double age = 0;   ///< s, beside the newest
  float claim = 1;  ///< of a pixel, that it may have at most
};

/// At most two of `images.others`, in the order in which they are blended over the newest one, for an eye at
/// `T_world_eye`: those whose cameras looked from the most similar directions, the best one last, as gloss, and errors
/// of the model, show best in it; a second of age counts as much as 0.03 radians. None is chosen that is worse than the
/// newest, or in another light: while the lamp is not known, shadows lie where they were, so that nothing may have
/// moved since. Where two are about as good, they share pixels, so that nothing jumps as the eye moves. For the right
/// eye of a pair the right camera's newest image is one of them.
std::vector<ChosenImage> choose_images(const NewestImages& images, const Pose& T_world_eye);

/// Whether a node stands where it stood, but for the noise of encoders.
bool is_at_rest(const Pose& T_world_now, const Pose& T_world_then);

}  // namespace foresight
