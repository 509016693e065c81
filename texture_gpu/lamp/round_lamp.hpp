// How much of a round lamp something hides.
#pragma once

#include "texture_gpu/lamp/shadow_rays.hpp"

namespace foresight {

/// Points of the unit disc that stand for all of it, a multiple of ShadowRays::kPacket; none: a lamp without extent.
using Disc = Eigen::Matrix2Xf;
/// Vogel's spiral.
Disc spiral(int points);

/// Share of a lamp at `lamp` that `what` hides from `p`, world, metres; the disc faces the point.
double hidden_share(const ShadowRays::Posed& what, const Eigen::Vector3d& p, const Eigen::Vector3d& lamp, double radius,
                    const Disc& disc, double gap = ShadowRays::kGap);

}  // namespace foresight
