#include "calibration/tags/tag_family.hpp"

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

#include <array>

#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

struct Family {
  const char* name;
  apriltag_family_t* (*create)();
  void (*destroy)(apriltag_family_t*);
  int more_border = 0;  // bits of black that were added around what libapriltag knows
};
constexpr std::array<Family, 10> kFamilies{{
    {"tag36h11", tag36h11_create, tag36h11_destroy},
    {"tag36h11b2", tag36h11_create, tag36h11_destroy, 1},
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
  throw InputError("tag family", "there is none called " + in_quotes(name), did_you_mean(name, tag_families()));
}

}  // namespace

// libapriltag looks for light outside and dark inside of the first ring of bits of a square that is width_at_border
// bits wide, and for the bits where they are counted from there.
TagFamily create_tag_family(const std::string& name) {
  const Family& family = family_of(name);
  TagFamily made(family.create(), family.destroy);
  made->width_at_border += 2 * family.more_border;
  made->total_width += 2 * family.more_border;
  for (uint32_t bit = 0; bit < made->nbits; ++bit) {
    made->bit_x[bit] += static_cast<uint32_t>(family.more_border);
    made->bit_y[bit] += static_cast<uint32_t>(family.more_border);
  }
  return made;
}

int tags_in_family(const std::string& name) {
  return static_cast<int>(create_tag_family(name)->ncodes);
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
  const TagFamily made = create_tag_family(family);
  if (id < 0 || id >= static_cast<int>(made->ncodes))
    throw InputError("tag family", family + " has " + counted(made->ncodes, "tag"), "make the board smaller");
  const std::unique_ptr<image_u8_t, void (*)(image_u8_t*)> image(apriltag_to_image(made.get(), id), image_u8_destroy);
  const cv::Mat whole(image->height, image->width, CV_8U, image->buf, static_cast<std::size_t>(image->stride));
  const int margin = (made->total_width - made->width_at_border) / 2;
  if (made->reversed_border) return whole.clone();
  return whole(cv::Rect(margin, margin, made->width_at_border, made->width_at_border)).clone();
}

}  // namespace foresight
