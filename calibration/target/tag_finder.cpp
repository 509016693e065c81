#include <apriltag/apriltag.h>
#include <apriltag/tag16h5.h>
#include <apriltag/tag25h9.h>
#include <apriltag/tag36h10.h>
#include <apriltag/tag36h11.h>
#include <apriltag/tagCircle21h7.h>
#include <apriltag/tagCircle49h12.h>
#include <apriltag/tagCustom48h12.h>
#include <apriltag/tagStandard41h12.h>
#include <apriltag/tagStandard52h13.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <map>
#include <opencv2/calib3d.hpp>

#include "calibration/target/board_finders.hpp"
#include "calibration/target/refine_corners.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

struct Family {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
};
constexpr std::array<Family, 9> kFamilies{{
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tag25h9", tag25h9_create, tag25h9_destroy},
    {"tag16h5", tag16h5_create, tag16h5_destroy},
    {"tag36h10", tag36h10_create, tag36h10_destroy},
    {"tagStandard41h12", tagStandard41h12_create, tagStandard41h12_destroy},
    {"tagStandard52h13", tagStandard52h13_create, tagStandard52h13_destroy},
    {"tagCircle21h7", tagCircle21h7_create, tagCircle21h7_destroy},
    {"tagCircle49h12", tagCircle49h12_create, tagCircle49h12_destroy},
    {"tagCustom48h12", tagCustom48h12_create, tagCustom48h12_destroy},
}};

const Family& family_of(const std::string& name) {
  for (const Family& family : kFamilies)
    if (name == family.name) return family;
  throw InputError("--board", "there is no tag family " + in_quotes(name),
                   "did you mean " + nearest_word(name, tag_families()) + "?");
}

using FamilyPtr = std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)>;

FamilyPtr create_family(const Board& board) {
  const Family& family = family_of(board.family);
  FamilyPtr made(family.create(), family.destroy);
  if (static_cast<int>(made->ncodes) < board.cols * board.rows)
    throw InputError("--board",
                     board.family + " has " + std::to_string(made->ncodes) + " tags, the board " +
                         std::to_string(board.cols * board.rows),
                     "name a larger family, such as tag36h11");
  return made;
}

/// AprilTag counts pixels from the corner of the image, OpenCV from the centre of its first pixel.
constexpr double kPixelOffset = 0.5;

struct Tag {
  int id = 0;
  std::array<Eigen::Vector2d, 4> corners;  // lower left, lower right, upper right, upper left
  Eigen::Vector2d centre;
  Eigen::Matrix3d H;  // from -1..1, x right and y down in print, to the image
};

/// Rows counted from the lower edge of the print, as kalibr does: every pair of tags votes.
bool counts_upwards(const std::vector<Tag>& tags, int cols) {
  int votes = 0;
  for (const Tag& a : tags) {
    const Eigen::Matrix3d inverse = a.H.inverse();
    for (const Tag& b : tags) {
      const int rows_down = b.id / cols - a.id / cols;
      if (rows_down == 0) continue;
      const Eigen::Vector2d at = (inverse * b.centre.homogeneous()).hnormalized();
      votes += (at.y() > 0) == (rows_down > 0) ? 1 : -1;
    }
  }
  return votes < 0;
}

double shortest_side(const Tag& tag) {
  double shortest = 1e9;
  for (std::size_t i = 0; i < 4; ++i) shortest = std::min(shortest, (tag.corners[i] - tag.corners[(i + 1) % 4]).norm());
  return shortest;
}

/// Drops tags that lie where no tag of the board can: misread ones, and those of another board.
void drop_strays(std::vector<Tag>& tags, const Board& board) {
  if (tags.size() < 5) return;
  std::vector<cv::Point2f> grid, image;
  double side = 0;
  for (const Tag& tag : tags) {
    grid.emplace_back(static_cast<float>(tag.id % board.cols), static_cast<float>(tag.id / board.cols));
    image.emplace_back(static_cast<float>(tag.centre.x()), static_cast<float>(tag.centre.y()));
    side += shortest_side(tag) / static_cast<double>(tags.size());
  }
  cv::Mat keep;
  const cv::Mat H = cv::findHomography(grid, image, cv::RANSAC, 0.5 * side, keep);
  if (H.empty()) return;
  std::vector<Tag> kept;
  for (std::size_t i = 0; i < tags.size(); ++i)
    if (keep.at<uchar>(static_cast<int>(i)) != 0) kept.push_back(tags[i]);
  tags = std::move(kept);
}

}  // namespace

struct TagFinder::Detector {
  explicit Detector(const Board& board) : family(create_family(board)) {
    apriltag_detector_add_family_bits(detector.get(), family.get(), 1);
    detector->nthreads = 1;
  }

  std::vector<Tag> detect(const cv::Mat& grey) {
    detector->quad_decimate = grey.total() > 1'500'000 ? 2 : 1;
    const cv::Mat whole = grey.isContinuous() ? grey : grey.clone();
    image_u8_t image{whole.cols, whole.rows, static_cast<int32_t>(whole.step), whole.data};
    const std::unique_ptr<zarray_t, void (*)(zarray_t*)> found(apriltag_detector_detect(detector.get(), &image),
                                                               apriltag_detections_destroy);
    std::vector<Tag> tags;
    for (int i = 0; i < zarray_size(found.get()); ++i) {
      apriltag_detection_t* d = nullptr;
      zarray_get(found.get(), i, &d);
      Tag tag{d->id, {}, {d->c[0] - kPixelOffset, d->c[1] - kPixelOffset}, {}};
      for (std::size_t c = 0; c < 4; ++c) tag.corners[c] = {d->p[c][0] - kPixelOffset, d->p[c][1] - kPixelOffset};
      const Eigen::Matrix3d H = Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(d->H->data);
      const Eigen::Vector3d offset(-kPixelOffset, -kPixelOffset, 1);
      tag.H = H;
      tag.H.topRows<2>() += offset.head<2>() * H.row(2);
      tags.push_back(tag);
    }
    return tags;
  }

  FamilyPtr family;
  std::unique_ptr<apriltag_detector_t, void (*)(apriltag_detector_t*)> detector{apriltag_detector_create(),
                                                                                apriltag_detector_destroy};
};

TagFinder::TagFinder(const Board& board) : board_(board), detector_(std::make_unique<Detector>(board)) {}
TagFinder::~TagFinder() = default;

std::size_t TagFinder::last_tags() const {
  return last_tags_;
}

FoundPoints TagFinder::find(const cv::Mat& grey) {
  std::vector<Tag> tags = detector_->detect(grey);
  std::map<int, int> times;
  for (const Tag& tag : tags) ++times[tag.id];
  std::erase_if(tags, [&](const Tag& tag) { return tag.id >= board_.cols * board_.rows || times[tag.id] > 1; });
  drop_strays(tags, board_);
  last_tags_ = tags.size();
  if (counts_upwards(tags, board_.cols))
    for (Tag& tag : tags) tag.id = (board_.rows - 1 - tag.id / board_.cols) * board_.cols + tag.id % board_.cols;
  std::sort(tags.begin(), tags.end(), [](const Tag& a, const Tag& b) { return a.id < b.id; });
  FoundPoints found;
  for (const Tag& tag : tags) {
    const int window = refinement_half_window(static_cast<float>(shortest_side(tag)), 0.1);
    for (std::size_t c = 0; c < 4; ++c) {
      const Eigen::Vector2d& p = tag.corners[c];
      const cv::Point2f at(static_cast<float>(p.x()), static_cast<float>(p.y()));
      found.corners.push_back({4 * tag.id + static_cast<int>(c), p, corner_noise(grey, at, window)});
    }
  }
  return found;
}

const std::vector<std::string>& tag_families() {
  static const std::vector<std::string> kNames = [] {
    std::vector<std::string> names;
    for (const Family& family : kFamilies) names.emplace_back(family.name);
    return names;
  }();
  return kNames;
}

cv::Mat tag_image(const std::string& family, int id) {
  const Family& kind = family_of(family);
  const FamilyPtr made(kind.create(), kind.destroy);
  if (id < 0 || id >= static_cast<int>(made->ncodes))
    throw InputError("--board", family + " has " + std::to_string(made->ncodes) + " tags", "make the board smaller");
  const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> image(apriltag_to_image(made.get(), id), image_u8_destroy);
  const cv::Mat whole(image->height, image->width, CV_8U, image->buf, static_cast<std::size_t>(image->stride));
  const int margin = (made->total_width - made->width_at_border) / 2;
  if (made->reversed_border) return whole.clone();
  return whole(cv::Rect(margin, margin, made->width_at_border, made->width_at_border)).clone();
}

}  // namespace foresight
