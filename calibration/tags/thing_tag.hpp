// A tag (tag36h11) that a thing carries.
#pragma once

#include <Eigen/Geometry>

namespace foresight {

struct ThingTag {
  int id = 0;
  double side = 0;  ///< m, > 0: of the black square
  /// x right, y up in print, z out of it; the origin is its middle.
  Eigen::Isometry3d T_thing_tag = Eigen::Isometry3d::Identity();
};

}  // namespace foresight
