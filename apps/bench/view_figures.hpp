// Figures of the thesis that show the scene from a later pose: 4.8, 4.15, 4.20, 5.9 and 5.19.
#pragma once

#include "apps/bench/figure_page.hpp"
#include "apps/bench/figure_subjects.hpp"

namespace foresight {

FigurePage occlusion_figure(const FigureLab& lab, const FigurePair& pair);  ///< 4.8

/// 4.15 and 4.20, with the same detail.
struct BorderFigures {
  FigurePage without, with;
};
BorderFigures border_figures(const FigureLab& lab, const FigurePair& pair);

/// 5.9 and 5.19, with the same registration error.
struct ErrorFigures {
  FigurePage expansion, filling;
};
ErrorFigures error_figures(const FigureLab& lab, const FigurePair& pair);

}  // namespace foresight
