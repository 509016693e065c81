#include "calibration/formats/lens_coefficients.hpp"

#include <algorithm>
#include <cmath>

#include "common/counted.hpp"
#include "common/error.hpp"
#include "common/exact_number.hpp"

namespace foresight::formats {
namespace {

constexpr double kLargestSide = 32768;  // px, as Lens takes it

std::size_t used(const std::vector<double>& d) {
  std::size_t count = d.size();
  while (count > 0 && d[count - 1] == 0) --count;
  return count;
}

}  // namespace

std::vector<double> coefficients(const CameraModel& camera, std::initializer_list<std::size_t> counts) {
  std::vector<double> d(camera.lens.begin() + 4, camera.lens.end());
  const std::size_t least = used(d);
  const auto count = std::find_if(counts.begin(), counts.end(), [least](std::size_t n) { return n >= least; });
  if (count != counts.end()) d.resize(*count);
  return d;
}

CameraModel perspective(const std::vector<double>& d, const std::string& where) {
  const std::size_t count = used(d);
  if (count > 12)
    throw InputError(where, "has coefficients of a tilted sensor", "calibrate without them, such as --model rational");
  CameraModel camera;
  camera.distortion = count <= 4   ? Distortion::radtan4
                      : count <= 5 ? Distortion::radtan5
                      : count <= 8 ? Distortion::rational
                                   : Distortion::thin_prism;
  std::copy_n(d.begin(), count, camera.lens.begin() + 4);
  return camera;
}

CameraModel equidistant(const std::vector<double>& d, const std::string& where) {
  if (d.size() != 4)
    throw InputError(where, "has " + counted(d.size(), "coefficient"), "equidistant takes 4: k1 k2 k3 k4");
  CameraModel camera;
  camera.distortion = Distortion::equidistant;
  std::copy(d.begin(), d.end(), camera.lens.begin() + 4);
  return camera;
}

void set_pinhole(CameraModel& camera, const std::vector<double>& size, const std::vector<double>& fx_fy_cx_cy,
                 const std::string& where) {
  const auto side = [](double v) { return v >= 1 && v <= kLargestSide && v == std::floor(v); };
  if (size.size() != 2 || !side(size[0]) || !side(size[1]))
    throw InputError(where, "has no image size", "add width and height in pixels");
  const auto finite = [](double v) { return std::isfinite(v); };
  if (fx_fy_cx_cy.size() != 4 || !std::all_of(fx_fy_cx_cy.begin(), fx_fy_cx_cy.end(), finite) ||
      !(fx_fy_cx_cy[0] > 0) || !(fx_fy_cx_cy[1] > 0))
    throw InputError(where, "the focal lengths and the centre are no such thing",
                     "write fx, fy, cx, cy with fx, fy > 0");
  camera.width = static_cast<int>(size[0]);
  camera.height = static_cast<int>(size[1]);
  std::copy(fx_fy_cx_cy.begin(), fx_fy_cx_cy.end(), camera.lens.begin());
}

std::string list(const std::vector<double>& numbers) {
  std::string out = "[";
  for (const double v : numbers) out += (out.size() > 1 ? ", " : "") + exact_text(v + 0.0);  // no -0
  return out + "]";
}

}  // namespace foresight::formats
