#include "calibration/camera/lens_projection.hpp"

#include <numeric>
#include <utility>

#include "common/error.hpp"
#include "common/text.hpp"

namespace foresight {
namespace {

struct Model {
  Distortion distortion;
  const char* name;
  int coefficients;
};
constexpr std::array<Model, 5> kModels{{{Distortion::radtan4, "radtan4", 4},
                                        {Distortion::radtan5, "radtan5", 5},
                                        {Distortion::rational, "rational", 8},
                                        {Distortion::thin_prism, "thin-prism", 12},
                                        {Distortion::equidistant, "equidistant", 4}}};

const Model& model_of(Distortion distortion) {
  return kModels[static_cast<std::size_t>(distortion)];
}

}  // namespace

std::string to_string(Distortion distortion) {
  return model_of(distortion).name;
}

Distortion parse_distortion(std::string_view name) {
  std::vector<std::string> names;
  for (const Model& model : kModels) {
    if (name == model.name) return model.distortion;
    names.emplace_back(model.name);
  }
  throw InputError("--model", "there is no lens model " + in_quotes(name), did_you_mean(name, names));
}

std::vector<int> free_parameters(Distortion distortion) {
  std::vector<int> indices(4 + static_cast<std::size_t>(model_of(distortion).coefficients));
  std::iota(indices.begin(), indices.end(), 0);
  return indices;
}

}  // namespace foresight
