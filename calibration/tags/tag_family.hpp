// The families of AprilTags that libapriltag 3.3 knows, and kalibr's print of one of them.
#pragma once

#include <memory>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

struct apriltag_family;

namespace foresight {

/// Names, the usual ones first. "tag36h11b2" is tag36h11 with a black border of two bits instead of
/// one, as kalibr prints it; its size is that of the whole black square.
const std::vector<std::string>& tag_families();

using TagFamily = std::unique_ptr<apriltag_family, void (*)(apriltag_family*)>;

/// For libapriltag's detector. Throws InputError where it does not exist, naming the nearest.
TagFamily create_tag_family(const std::string& name);

/// Number of different tags. Throws as create_tag_family.
int tags_in_family(const std::string& name);

/// An image of one tag, one pixel a bit, its white border cut off: what a tag's size measures is the
/// width. Throws InputError where the family or the id does not exist.
cv::Mat tag_image(const std::string& family, int id);

}  // namespace foresight
