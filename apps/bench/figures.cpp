#include "apps/bench/figures.hpp"

#include "common/error.hpp"

namespace foresight {

int draw_figures(const FigureOptions& options) {
  throw RuntimeFailure("not written yet: " + options.out.string(), "wait");
}

}  // namespace foresight
