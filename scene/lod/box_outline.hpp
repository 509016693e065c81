// How large a box is seen.
//
//        |       |            The planes of its sides divide space into 27 regions. From each of them the same sides
//    ----+-------+----        are seen, so that a table has the corners of the outline: 4 from beside a side, 6 from
//        |  box  |   eye      elsewhere, none from within. They alone are projected, and their polygon's area is exact.
//    ----+-------+----
//        |       |            (Schmalstieg and Tobler, "Fast Projected Area Computation for Three-Dimensional Bounding
//                              Boxes", 1999.)
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <span>

namespace foresight {

/// Corners of the outline of `box` seen from `eye` (of one frame), in order around it: bit 0 of a corner is set where
/// its x is the box's largest, bit 1 y, bit 2 z. None where the eye is inside; a box without volume has an outline too.
std::span<const std::uint8_t> box_outline(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& eye);

struct SeenSize {
  double area = 0;   ///< of the picture, in units of a plane one unit before the eye; infinite where the eye is inside
  double share = 0;  ///< of that, what a surface of 1 m2 at the box takes on average that faces the eye; 1/m2
};

/// Seen from `eye` on a plane that faces the box's middle. Parts beside or behind the eye count up to the edge of what
/// such a plane can show (80 degrees).
SeenSize seen_size(const Eigen::AlignedBox3d& box, const Eigen::Vector3d& eye);

}  // namespace foresight
