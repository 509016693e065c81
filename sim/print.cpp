#include "sim/print.hpp"

#include <apriltag/apriltag.h>
#include <apriltag/tag36h11.h>

#include <cstdlib>
#include <memory>
#include <opencv2/imgproc.hpp>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight::sim {
namespace {

constexpr int kPixelsPerBit = 32;
constexpr double kNotSquare = 0.01;  // of the side

/// libapriltag does not export its own.
void destroy(image_u8_t* image) {
  std::free(image->buf);
  std::free(image);
}

Print tag_print(int id, const std::array<Eigen::Vector3d, 4>& c) {
  const cv::Mat bits = tag_bits(id);
  const Eigen::Vector3d middle = (c[0] + c[1] + c[2] + c[3]) / 4;
  const Eigen::Vector3d right = (c[1] + c[2] - c[0] - c[3]) / 2, down = (c[0] + c[1] - c[2] - c[3]) / 2;
  const double side = (right.norm() + down.norm()) / 2;
  Print out;
  out.name = "tag " + std::to_string(id);
  out.T_world_print.translation() = middle;
  const Eigen::Vector3d x = right.normalized(), z = right.cross(down).normalized();
  out.T_world_print.linear() << x, z.cross(x), z;
  double worst = side > 0 ? 0 : 1;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector3d at(k == 0 || k == 3 ? -side / 2 : side / 2, k < 2 ? side / 2 : -side / 2, 0);
    worst = std::max(worst, (out.T_world_print * at - c[static_cast<std::size_t>(k)]).norm());
  }
  if (!(worst <= kNotSquare * side))
    throw InputError(out.name, "its corners are not a square's: one is off by " + readable(worst * 1e3, 1) + " mm",
                     "give them as lower left, lower right, upper right, upper left in print");
  out.width_m = out.height_m = side * kTagPaper;
  cv::resize(bits, out.picture, {}, kPixelsPerBit, kPixelsPerBit, cv::INTER_NEAREST);
  return out;
}

}  // namespace

cv::Mat tag_bits(int id) {
  const std::unique_ptr<apriltag_family_t, void (*)(apriltag_family_t*)> family(tag36h11_create(), tag36h11_destroy);
  if (id < 0 || id >= static_cast<int>(family->ncodes))
    throw InputError("tag " + std::to_string(id), "tag36h11 has no such tag",
                     "choose one of 0 .. " + std::to_string(family->ncodes - 1));
  const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> image(apriltag_to_image(family.get(), id), destroy);
  return cv::Mat(image->height, image->width, CV_8U, image->buf, static_cast<std::size_t>(image->stride)).clone();
}

std::vector<Print> tag_prints(const TagCorners& corners) {
  std::vector<Print> out;
  for (const auto& [id, at] : corners) out.push_back(tag_print(id, at));
  return out;
}

void check(const Print& print) {
  const std::string name = "print '" + print.name + "'";
  if (print.picture.empty() || print.picture.type() != CV_8UC1)
    throw InputError(name, "has no grey picture", "give one of 8 bits and one channel");
  if (!(print.width_m > 0 && print.height_m > 0))
    throw InputError(name, readable(print.width_m, 4) + " x " + readable(print.height_m, 4) + " m is no size of paper",
                     "give its width and height in metres");
}

}  // namespace foresight::sim
