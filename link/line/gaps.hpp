// When a line stands still for long, as its spec says it beforehand.
#pragma once

#include <vector>

#include "link/line/line_spec.hpp"

namespace foresight {

/// A time in which nothing crosses the line, or what is sent is lost.
struct Gap {
  Duration begin{}, end{};
};

/// The gaps of at least `least` within the first `length`: by a trace of chances or rates and by outages, those that
/// follow each other as one. What a trace of packets lost or drawn loss takes counts as loss, not as a gap.
std::vector<Gap> gaps_of(const DirectionSpec& spec, Duration least, Duration length);

}  // namespace foresight
