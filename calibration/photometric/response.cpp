#include "calibration/photometric/response.hpp"

namespace foresight {

double Response::inverse(double level) const {
  return level > 0 ? std::exp(log_response(log_slope.data(), std::fmin(level, 255))) : 0;
}

double Response::level(double exposure) const {
  if (!(exposure > 0)) return 0;
  double low = 0, high = 255;
  for (int i = 0; i < 60; ++i) {
    const double middle = (low + high) / 2;
    (inverse(middle) < exposure ? low : high) = middle;
  }
  return (low + high) / 2;
}

std::vector<double> Response::table() const {
  std::vector<double> out;
  for (int v = 0; v < 256; ++v) out.push_back(inverse(v));
  return out;
}

Response Response::power_law(double exponent) {
  Response response;
  response.log_slope.fill(std::log(exponent));
  return response;
}

}  // namespace foresight
