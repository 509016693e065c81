// Figures of the thesis that show one polygon: its alpha mask (5.11) and its texture (5.23).
#pragma once

#include "apps/bench/figure_page.hpp"
#include "apps/bench/figure_subjects.hpp"

namespace foresight {

FigurePage mask_figure(const FigureLab& lab, const FigurePair& pair);     ///< 5.11
FigurePage filling_figure(const FigureLab& lab, const FigurePair& pair);  ///< 5.23

}  // namespace foresight
