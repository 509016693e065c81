#include "apps/bench/prediction_kdl.hpp"

#ifdef FORESIGHT_WITH_KDL
#include <kdl/chainfksolverpos_recursive.hpp>
#include <kdl/chainiksolverpos_lma.hpp>
#include <kdl/chainiksolverpos_nr_jl.hpp>
#include <kdl/chainiksolvervel_pinv.hpp>

#include <memory>

namespace foresight {
namespace {

constexpr double kEndless = 6.283185307179586;  // rad: NR_JL wants limits

KDL::Vector to_kdl(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

KDL::Frame to_kdl(const Pose& T) {
  const Eigen::Matrix3d R = T.linear();
  return {KDL::Rotation(R(0, 0), R(0, 1), R(0, 2), R(1, 0), R(1, 1), R(1, 2), R(2, 0), R(2, 1), R(2, 2)),
          to_kdl(Eigen::Vector3d(T.translation()))};
}

// The solvers point at each other: they stay where they are.
struct Solvers {
  explicit Solvers(const ArmChain& arm)
      : chain(make_chain(arm)),
        lower(static_cast<unsigned>(arm.size())),
        upper(lower),
        middle(lower),
        out(lower),
        forward(chain),
        velocity(chain),
        nr_jl(chain, limits(arm.lower(), -kEndless, lower), limits(arm.upper(), kEndless, upper), forward, velocity,
              500, 1e-5),
        lma(chain, Eigen::Matrix<double, 6, 1>::Ones(), 1e-8) {
    middle.data = arm.middle();
  }
  static const KDL::JntArray& limits(const JointVector& from, double endless, KDL::JntArray& to) {
    for (Eigen::Index i = 0; i < from.size(); ++i) to.data[i] = std::isfinite(from[i]) ? from[i] : endless;
    return to;
  }
  static KDL::Chain make_chain(const ArmChain& arm) {
    KDL::Chain chain;
    for (std::size_t i = 0; i < arm.size(); ++i) {
      const ArmJoint& j = arm.joints()[i];
      const auto kind = j.slides ? KDL::Joint::TransAxis : KDL::Joint::RotAxis;
      const KDL::Frame tip = i + 1 == arm.size() ? to_kdl(arm.tip_at_zero()) : KDL::Frame::Identity();
      chain.addSegment(KDL::Segment(j.name, KDL::Joint(j.name, to_kdl(j.point), to_kdl(j.axis), kind), tip));
    }
    return chain;
  }

  KDL::Chain chain;
  KDL::JntArray lower, upper, middle, out;
  KDL::ChainFkSolverPos_recursive forward;
  KDL::ChainIkSolverVel_pinv velocity;
  KDL::ChainIkSolverPos_NR_JL nr_jl;
  KDL::ChainIkSolverPos_LMA lma;
};

}  // namespace

std::optional<KdlPeer> make_kdl_peer(const ArmChain& chain) {
  if (!chain.followers().empty()) return std::nullopt;  // KDL's chains know none
  const auto solvers = std::make_shared<Solvers>(chain);
  const KDL::JntArray zero(static_cast<unsigned>(chain.size()));
  return KdlPeer{[solvers](const Pose& T) {
                   solvers->nr_jl.CartToJnt(solvers->middle, to_kdl(T), solvers->out);
                   return JointVector(solvers->out.data);
                 },
                 [solvers, zero](const Pose& T) {
                   solvers->lma.CartToJnt(zero, to_kdl(T), solvers->out);
                   return JointVector(solvers->out.data);
                 }};
}

}  // namespace foresight
#else

namespace foresight {

std::optional<KdlPeer> make_kdl_peer(const ArmChain&) {
  return std::nullopt;
}

}  // namespace foresight
#endif
