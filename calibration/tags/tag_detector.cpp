#include "calibration/tags/tag_detector.hpp"

#include <apriltag/apriltag.h>

#include <algorithm>

#include "calibration/tags/tag_family.hpp"
#include "common/counted.hpp"
#include "common/error.hpp"

namespace foresight {
namespace {

/// AprilTag counts pixels from the corner of the image, we from the centre of its first pixel.
constexpr double kPixelOffset = 0.5;

/// A tag that the border cuts off is found all the same, with corners on the border.
constexpr double kLeastBorder = 4;  // px

constexpr std::size_t kLargeImage = 1'500'000;  // px

double shortest_side(const DetectedTag& tag) {
  double shortest = 1e9;
  for (std::size_t i = 0; i < 4; ++i) shortest = std::min(shortest, (tag.corners[i] - tag.corners[(i + 1) % 4]).norm());
  return shortest;
}

bool is_inside(const DetectedTag& tag, const cv::Size& size) {
  return std::all_of(tag.corners.begin(), tag.corners.end(), [&](const Eigen::Vector2d& corner) {
    return (corner.array() >= kLeastBorder).all() && corner.x() <= size.width - 1 - kLeastBorder &&
           corner.y() <= size.height - 1 - kLeastBorder;
  });
}

cv::Mat light_of_levels(const std::vector<double>& inverse_response) {
  if (inverse_response.empty()) return {};
  if (inverse_response.size() != 256 || !(inverse_response.back() > 0))
    throw InputError("the response", "has " + counted(inverse_response.size(), "level") + ", or a dark last one",
                     "give the 256 of `calibrate photometric`");
  cv::Mat out(1, 256, CV_8UC1);
  for (int v = 0; v < 256; ++v)
    out.at<std::uint8_t>(v) =
        cv::saturate_cast<std::uint8_t>(255 * inverse_response[static_cast<std::size_t>(v)] / inverse_response.back());
  return out;
}

}  // namespace

struct TagDetector::Library {
  explicit Library(const Options& options) : family(create_tag_family(options.family)) {
    apriltag_detector_add_family_bits(detector.get(), family.get(), 1);
    detector->nthreads = 1;
  }
  TagFamily family;  // outlives the detector
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector{apriltag_detector_create(),
                                                                                apriltag_detector_destroy};
};

TagDetector::TagDetector(const Options& options)
    : options_(options),
      light_(light_of_levels(options.inverse_response)),
      library_(std::make_unique<Library>(options)) {}
TagDetector::~TagDetector() = default;

std::vector<DetectedTag> TagDetector::detect(const cv::Mat& grey) {
  const double automatic = grey.total() > kLargeImage ? 2 : 1;
  library_->detector->quad_decimate = static_cast<float>(options_.decimate > 0 ? options_.decimate : automatic);
  cv::Mat whole = grey.isContinuous() ? grey : grey.clone();
  if (!light_.empty()) cv::LUT(grey, light_, whole = cv::Mat());
  image_u8_t image{whole.cols, whole.rows, static_cast<int32_t>(whole.step), whole.data};
  const std::unique_ptr<zarray_t, void (*)(zarray_t*)> found(apriltag_detector_detect(library_->detector.get(), &image),
                                                             apriltag_detections_destroy);
  std::vector<DetectedTag> tags;
  for (int i = 0; i < zarray_size(found.get()); ++i) {
    apriltag_detection_t* d = nullptr;
    zarray_get(found.get(), i, &d);
    DetectedTag tag{d->id, {}, d->decision_margin, Eigen::Matrix3d::Identity()};
    tag.H = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d->H->data);
    tag.H.topRows<2>() -= Eigen::Vector2d::Constant(kPixelOffset) * tag.H.row(2).eval();
    for (std::size_t c = 0; c < 4; ++c) tag.corners[c] = {d->p[c][0] - kPixelOffset, d->p[c][1] - kPixelOffset};
    if (tag.margin >= options_.least_margin && shortest_side(tag) >= options_.least_side_px &&
        is_inside(tag, grey.size()))
      tags.push_back(tag);
  }
  std::sort(tags.begin(), tags.end(), [](const auto& a, const auto& b) { return a.id < b.id; });
  std::vector<DetectedTag> once;
  for (std::size_t i = 0; i < tags.size(); ++i) {
    const bool twice = (i > 0 && tags[i - 1].id == tags[i].id) || (i + 1 < tags.size() && tags[i + 1].id == tags[i].id);
    if (!twice) once.push_back(tags[i]);
  }
  return once;
}

}  // namespace foresight
