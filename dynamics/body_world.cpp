#include "dynamics/body_world.hpp"

#include <btBulletDynamicsCommon.h>
#include <fmt/core.h>

#include <algorithm>
#include <cmath>

#include "common/error.hpp"
#include "dynamics/mesh_pieces.hpp"

namespace foresight {
namespace {

constexpr double kMargin = 5e-4;  // m, around hulls: touch begins here
constexpr double kFarAway = 100;  // m
constexpr double kFloorDepth = 10;
// Slower than this for two seconds, a body rests until something touches it. Round things that stand on the few points
// which the solver keeps of their rims tremble by up to two thirds of it.
constexpr double kStillSpeed = 0.009, kStillTurning = 0.16;
constexpr double kFastest = 20;  // m/s; no thing of a table is faster but by a mistake of the solver

// Boxes of the broad phase are that much larger. Bodies whose boxes overlap rest together or not at all, so with
// Bullet's 5 cm nothing on a table rested while one thing trembled. A variable of all worlds, set before there are any.
const double kBoxMargin = gDbvtMargin = 1e-3;  // m

btVector3 bt(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}
Eigen::Vector3d eigen(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}
btTransform bt(const Pose& T) {
  const Eigen::Quaterniond q(T.linear());
  return btTransform(btQuaternion(q.x(), q.y(), q.z(), q.w()), bt(T.translation()));
}
Pose pose_of(const btTransform& T) {
  const btQuaternion q = T.getRotation();
  Pose out = Pose::Identity();
  out.linear() = Eigen::Quaterniond(q.w(), q.x(), q.y(), q.z()).normalized().toRotationMatrix();
  out.translation() = eigen(T.getOrigin());
  return out;
}

void require(const char* field, double value, double least, double most) {
  if (!(value >= least && value <= most))
    throw InputError(std::string("bodies: ") + field,
                     fmt::format("{:.9g} is outside {:.9g} .. {:.9g}", value, least, most), "choose a value inside");
}

}  // namespace

struct BodyWorld::Impl {
  enum class Kind { still, driven, loose };
  struct Body {
    Kind kind = Kind::still;
    Pose T_body_centre = Pose::Identity();  // of mass
    Pose start = Pose::Identity();
    double mass = 0;
    btVector3 inertia{0, 0, 0};
    bool held = false, present = true;
    std::vector<std::unique_ptr<btCollisionShape>> pieces;
    std::vector<std::unique_ptr<btTriangleMesh>> meshes;
    btCompoundShape shape;
    btDefaultMotionState state;
    std::unique_ptr<btRigidBody> body;
  };

  explicit Impl(const BodyWorldOptions& o)
      : options(o), dispatcher(&configuration), world(&dispatcher, &broadphase, &solver, &configuration) {
    world.setGravity({0, 0, -options.gravity});
    btContactSolverInfo& info = world.getSolverInfo();
    info.m_numIterations = options.iterations;
    // Friction in two fixed directions, warm-started: what is held does not creep.
    info.m_solverMode = SOLVER_USE_WARMSTARTING | SOLVER_USE_2_FRICTION_DIRECTIONS |
                        SOLVER_ENABLE_FRICTION_DIRECTION_CACHING | SOLVER_DISABLE_VELOCITY_DEPENDENT_FRICTION_DIRECTION;
    info.m_restitutionVelocityThreshold = 0.1;
    world.getDispatchInfo().m_deterministicOverlappingPairs = true;
    world.setLatencyMotionStateInterpolation(false);
  }
  ~Impl() {
    for (const auto& body : bodies)
      if (body->present) world.removeRigidBody(body->body.get());
  }

  void add_pieces(Body& body, const Mesh& mesh);
  std::size_t add(Kind kind, const Mesh& mesh, const Pose& T_world_body, double mass, const Surface& surface);
  std::size_t finish(std::unique_ptr<Body> body, const Surface& surface);
  void enter(Body& body);
  void make_kind(Body& body);
  void collect_touches();
  void mend(Body& body) const;

  BodyWorldOptions options;
  btDefaultCollisionConfiguration configuration;
  btCollisionDispatcher dispatcher;
  btDbvtBroadphase broadphase;
  btSequentialImpulseConstraintSolver solver;
  btDiscreteDynamicsWorld world;
  std::vector<std::unique_ptr<Body>> bodies;
  std::vector<Touch> touches;
};

namespace {

std::unique_ptr<btCollisionShape> hull_of(const Mesh& mesh, const Pose& T_centre_body) {
  auto hull = std::make_unique<btConvexHullShape>();
  for (const Eigen::Vector3f& v : mesh.vertices) hull->addPoint(bt(T_centre_body * v.cast<double>()), false);
  hull->setMargin(kMargin);
  hull->recalcLocalAabb();
  hull->optimizeConvexHull();
  hull->initializePolyhedralFeatures();  // whole faces touch, not one point of them
  return hull;
}

}  // namespace

void BodyWorld::Impl::add_pieces(Body& body, const Mesh& mesh) {
  const Pose T_centre_body = body.T_body_centre.inverse();
  const auto add_piece = [&](std::unique_ptr<btCollisionShape> shape, const btTransform& place) {
    body.shape.addChildShape(place, shape.get());
    body.pieces.push_back(std::move(shape));
  };
  for (const MeshPiece& piece : pieces_of(mesh)) {
    if (piece.ball_radius > 0) {
      Eigen::AlignedBox3d box;
      for (const Eigen::Vector3f& v : piece.mesh.vertices) box.extend(v.cast<double>());
      btTransform place = btTransform::getIdentity();
      place.setOrigin(bt(T_centre_body * box.center()));
      add_piece(std::make_unique<btSphereShape>(piece.ball_radius), place);
    } else if (piece.convex || body.kind != Kind::still) {
      add_piece(hull_of(piece.mesh, T_centre_body), btTransform::getIdentity());
    } else {
      auto triangles = std::make_unique<btTriangleMesh>();
      for (const auto& t : piece.mesh.triangles) {
        const auto corner = [&](std::size_t k) { return bt(T_centre_body * piece.mesh.vertices[t[k]].cast<double>()); };
        triangles->addTriangle(corner(0), corner(1), corner(2));
      }
      auto shape = std::make_unique<btBvhTriangleMeshShape>(triangles.get(), true);
      shape->setMargin(kMargin);
      add_piece(std::move(shape), btTransform::getIdentity());
      body.meshes.push_back(std::move(triangles));
    }
  }
}

std::size_t BodyWorld::Impl::add(Kind kind, const Mesh& mesh, const Pose& T_world_body, double mass,
                                 const Surface& surface) {
  require("friction", surface.friction, 0, 10);
  require("rolling", surface.rolling, 0, 1);
  require("restitution", surface.restitution, 0, 1);
  require("stiffness", surface.stiffness, 0, 1e9);
  require("damping", surface.damping, 0, 1e9);
  if (kind == Kind::loose) require("mass", mass, 1e-6, 1e6);
  if (!T_world_body.matrix().allFinite()) throw InputError("bodies: a pose", "is not finite", "give numbers");
  auto body = std::make_unique<Body>();
  body->kind = kind;
  body->mass = kind == Kind::loose ? mass : 0;
  body->start = T_world_body;
  if (kind == Kind::loose) body->T_body_centre.translation() = solid_of(mesh).centre;
  add_pieces(*body, mesh);
  return finish(std::move(body), surface);
}

std::size_t BodyWorld::Impl::finish(std::unique_ptr<Body> body, const Surface& surface) {
  // Of the box around it. A body without a shape gets that of a small ball.
  if (body->mass > 0) body->inertia = btVector3(1, 1, 1) * (4e-4 * body->mass);
  if (body->mass > 0 && body->shape.getNumChildShapes() > 0)
    body->shape.calculateLocalInertia(body->mass, body->inertia);
  const btTransform start = bt(body->start * body->T_body_centre);
  body->state = btDefaultMotionState(start);
  btRigidBody::btRigidBodyConstructionInfo info(body->mass, nullptr, &body->shape, body->inertia);
  info.m_startWorldTransform = start;
  info.m_friction = surface.friction;
  info.m_rollingFriction = surface.rolling;
  info.m_spinningFriction = surface.rolling;
  info.m_restitution = surface.restitution;
  info.m_linearSleepingThreshold = kStillSpeed;
  info.m_angularSleepingThreshold = kStillTurning;
  body->body = std::make_unique<btRigidBody>(info);
  body->body->setMotionState(&body->state);
  body->body->setUserIndex(static_cast<int>(bodies.size()));
  if (surface.stiffness > 0) body->body->setContactStiffnessAndDamping(surface.stiffness, surface.damping);
  make_kind(*body);
  enter(*body);
  bodies.push_back(std::move(body));
  return bodies.size() - 1;
}

void BodyWorld::Impl::make_kind(Body& body) {
  const bool driven = body.kind == Kind::driven || body.held;
  if (body.kind == Kind::loose) body.body->setMassProps(driven ? 0 : body.mass, body.inertia);
  constexpr int kBoth = btCollisionObject::CF_KINEMATIC_OBJECT | btCollisionObject::CF_STATIC_OBJECT;
  const int flags = body.body->getCollisionFlags() & ~kBoth;
  body.body->setCollisionFlags(flags | (driven                     ? btCollisionObject::CF_KINEMATIC_OBJECT
                                        : body.kind == Kind::still ? btCollisionObject::CF_STATIC_OBJECT
                                                                   : 0));
  if (driven)
    body.body->forceActivationState(DISABLE_DEACTIVATION);
  else if (body.kind == Kind::loose)
    body.body->forceActivationState(ACTIVE_TAG);
}

void BodyWorld::Impl::enter(Body& body) {
  constexpr int kStill = 1, kDriven = 2, kLoose = 4;
  const bool driven = body.kind == Kind::driven || body.held;
  const int group = body.kind == Kind::still ? kStill : driven ? kDriven : kLoose;
  world.addRigidBody(body.body.get(), group, group == kLoose ? kStill | kDriven | kLoose : kLoose);
}

// Manifolds come in an order that depends on their history alone, but is nobody's business: sorted by bodies.
void BodyWorld::Impl::collect_touches() {
  touches.clear();
  for (int i = 0; i < dispatcher.getNumManifolds(); ++i) {
    const btPersistentManifold& manifold = *dispatcher.getManifoldByIndexInternal(i);
    for (int k = 0; k < manifold.getNumContacts(); ++k) {
      const btManifoldPoint& point = manifold.getContactPoint(k);
      if (point.getDistance() > kMargin) continue;
      touches.push_back({static_cast<std::size_t>(manifold.getBody0()->getUserIndex()),
                         static_cast<std::size_t>(manifold.getBody1()->getUserIndex()),
                         eigen(point.getPositionWorldOnB()), eigen(point.m_normalWorldOnB),
                         std::max(0.0, point.getAppliedImpulse() / options.step)});
    }
  }
  std::ranges::stable_sort(touches, {}, [](const Touch& t) { return std::pair(t.body, t.other); });
}

void BodyWorld::Impl::mend(Body& body) const {
  btRigidBody& b = *body.body;
  const Eigen::Vector3d v = eigen(b.getLinearVelocity()), w = eigen(b.getAngularVelocity());
  const Pose T = pose_of(b.getWorldTransform());
  if (!T.matrix().allFinite() || !v.allFinite() || !w.allFinite() || T.translation().norm() > kFarAway) {
    b.setWorldTransform(bt(body.start * body.T_body_centre));
    b.setInterpolationWorldTransform(b.getWorldTransform());
    b.setLinearVelocity({0, 0, 0});
    b.setAngularVelocity({0, 0, 0});
    b.clearForces();
  } else if (v.norm() > kFastest) {
    b.setLinearVelocity(bt(v * (kFastest / v.norm())));
  }
}

BodyWorld::BodyWorld(const BodyWorldOptions& options) {
  require("step", options.step, 0.001, 0.02);
  require("iterations", options.iterations, 1, 10'000);
  require("gravity", options.gravity, 0, 100);
  impl_ = std::make_unique<Impl>(options);
}

BodyWorld::~BodyWorld() = default;

std::size_t BodyWorld::add_still(const Mesh& mesh, const Pose& T_world_body, const Surface& surface) {
  return impl_->add(Impl::Kind::still, mesh, T_world_body, 0, surface);
}
std::size_t BodyWorld::add_driven(const Mesh& mesh, const Pose& T_world_body, const Surface& surface) {
  return impl_->add(Impl::Kind::driven, mesh, T_world_body, 0, surface);
}
std::size_t BodyWorld::add_loose(const Mesh& mesh, const Pose& T_world_body, double mass, const Surface& surface) {
  return impl_->add(Impl::Kind::loose, mesh, T_world_body, mass, surface);
}

std::size_t BodyWorld::add_floor(double z, const Surface& surface) {
  auto body = std::make_unique<Impl::Body>();
  const double half = kFarAway;
  auto slab = std::make_unique<btBoxShape>(btVector3(half, half, kFloorDepth / 2));
  body->start.translation() = Eigen::Vector3d(0, 0, z - kFloorDepth / 2);
  body->shape.addChildShape(btTransform::getIdentity(), slab.get());
  body->pieces.push_back(std::move(slab));
  return impl_->finish(std::move(body), surface);
}

void BodyWorld::place(std::size_t driven, const Pose& T_world_body) {
  Impl::Body& body = *impl_->bodies.at(driven);
  body.state.setWorldTransform(bt(T_world_body * body.T_body_centre));
}

void BodyWorld::put(std::size_t at, const Motion& motion) {
  Impl::Body& body = *impl_->bodies.at(at);
  btRigidBody& b = *body.body;
  const btTransform T = bt(motion.T_world_body * body.T_body_centre);
  body.state = btDefaultMotionState(T);
  b.setWorldTransform(T);
  b.setInterpolationWorldTransform(T);
  const Eigen::Vector3d lever = motion.T_world_body.linear() * body.T_body_centre.translation();
  b.setLinearVelocity(bt(motion.velocity + motion.turning.cross(lever)));
  b.setAngularVelocity(bt(motion.turning));
  b.setInterpolationLinearVelocity(b.getLinearVelocity());
  b.setInterpolationAngularVelocity(b.getAngularVelocity());
  b.clearForces();
  if (body.present) impl_->world.updateSingleAabb(&b);
  if (body.kind != Impl::Kind::still) b.activate(true);
}

void BodyWorld::rest(std::size_t loose, const Pose& T_world_body) {
  put(loose, {T_world_body, Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()});
  Impl::Body& body = *impl_->bodies.at(loose);
  if (body.kind == Impl::Kind::loose && !body.held) body.body->forceActivationState(ISLAND_SLEEPING);
}

void BodyWorld::set_present(std::size_t at, bool present) {
  Impl::Body& body = *impl_->bodies.at(at);
  if (body.present == present) return;
  body.present = present;
  if (present)
    impl_->enter(body);
  else
    impl_->world.removeRigidBody(body.body.get());
}

void BodyWorld::hold(std::size_t loose, bool held) {
  Impl::Body& body = *impl_->bodies.at(loose);
  if (body.kind != Impl::Kind::loose || body.held == held) return;
  body.held = held;
  const bool present = body.present;
  set_present(loose, false);
  body.state = btDefaultMotionState(body.body->getWorldTransform());
  impl_->make_kind(body);
  set_present(loose, present);
}

void BodyWorld::step() {
  impl_->world.stepSimulation(impl_->options.step, 0);
  for (const auto& body : impl_->bodies)
    if (body->kind == Impl::Kind::loose && !body->held) impl_->mend(*body);
  impl_->collect_touches();
}

std::size_t BodyWorld::size() const {
  return impl_->bodies.size();
}

Motion BodyWorld::motion(std::size_t at) const {
  const Impl::Body& body = *impl_->bodies.at(at);
  Motion out;
  out.T_world_body = pose_of(body.body->getWorldTransform()) * body.T_body_centre.inverse();
  out.turning = eigen(body.body->getAngularVelocity());
  const Eigen::Vector3d lever = out.T_world_body.linear() * body.T_body_centre.translation();
  out.velocity = eigen(body.body->getLinearVelocity()) - out.turning.cross(lever);
  return out;
}

const std::vector<Touch>& BodyWorld::touches() const {
  return impl_->touches;
}

double BodyWorld::seconds_per_step() const {
  return impl_->options.step;
}

}  // namespace foresight
