// Which camera of a pair a file belongs to, and what both files of a pair have in common.
#pragma once

#include <optional>
#include <string>
#include <string_view>

namespace foresight {

enum class PairSide { left, right };

struct SidedName {
  std::optional<PairSide> side;  ///< nothing: the name says neither
  std::string view;  ///< the rest of the name without extension: "left01.jpg" -> "01", "cam1/a_7.png" -> "a_7"
};

/// Looks for left/right, cam0/cam1, or a separate l/r ("12_l.png"), in any case, last one first;
/// folders in `path` count. Where nothing but the side is left, `view` is the name as it was.
SidedName split_side(std::string_view path);

}  // namespace foresight
