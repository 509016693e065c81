#include "apps/bench/prediction_contact_peers.hpp"

#include <BulletCollision/Gimpact/btGImpactCollisionAlgorithm.h>
#include <BulletCollision/Gimpact/btGImpactShape.h>
#include <btBulletCollisionCommon.h>
#include <fcl/broadphase/broadphase_dynamic_AABB_tree.h>
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/narrowphase/collision.h>
#include <fcl/narrowphase/distance.h>

#include <algorithm>

namespace foresight {
namespace {

bool has(const std::vector<PartPair>& pairs, std::size_t a, std::size_t b) {
  return std::ranges::find(pairs, PartPair{a, b}) != pairs.end() ||
         std::ranges::find(pairs, PartPair{b, a}) != pairs.end();
}

class FclPeer : public ContactPeer {
 public:
  FclPeer(const std::vector<const Mesh*>& meshes, const std::vector<bool>& robot, const std::vector<PartPair>& pairs)
      : pairs_(pairs), allowed_(meshes.size(), std::vector<bool>(meshes.size(), false)), robot_(robot) {
    for (std::size_t a = 0; a < meshes.size(); ++a) {
      auto model = std::make_shared<fcl::BVHModel<fcl::OBBRSSd>>();
      std::vector<Eigen::Vector3d> vertices;
      for (const auto& v : meshes[a]->vertices) vertices.push_back(v.cast<double>());
      std::vector<fcl::Triangle> triangles;
      for (const auto& t : meshes[a]->triangles) triangles.emplace_back(t[0], t[1], t[2]);
      model->beginModel();
      model->addSubModel(vertices, triangles);
      model->endModel();
      objects_.push_back(std::make_unique<fcl::CollisionObjectd>(model));
      objects_.back()->setUserData(reinterpret_cast<void*>(a));
      (robot[a] ? arm_ : scene_).registerObject(objects_.back().get());
      for (std::size_t b = 0; b < meshes.size(); ++b) allowed_[a][b] = has(pairs, a, b);
    }
    arm_.setup();
    scene_.setup();
  }
  void place(const std::vector<Pose>& T_world_part) override {
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      if (!robot_[i] && placed_) continue;
      objects_[i]->setTransform(T_world_part[i]);
      objects_[i]->computeAABB();
    }
    arm_.update();
    if (!placed_) scene_.update();
    placed_ = true;
  }
  std::vector<PartPair> touching() override {
    found_.clear();
    const auto meet = [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* self) {
      static_cast<FclPeer*>(self)->meet(a, b);
      return false;
    };
    arm_.collide(&scene_, this, meet);
    arm_.collide(this, meet);
    return found_;
  }
  std::vector<double> distances(double within) override {
    std::vector<double> out;
    for (const auto& [a, b] : pairs_) {
      if (objects_[a]->getAABB().distance(objects_[b]->getAABB()) >= within) continue;
      const double d = distance(objects_[a].get(), objects_[b].get());
      if (d < within) out.push_back(std::max(d, 0.0));
    }
    return out;
  }
  std::optional<double> least(double within) override {
    least_ = within;
    const auto near = [](fcl::CollisionObjectd* a, fcl::CollisionObjectd* b, void* data, double& most) {
      auto* self = static_cast<FclPeer*>(data);
      if (self->allowed_[index(a)][index(b)]) self->least_ = std::min(self->least_, distance(a, b));
      most = self->least_;
      return most <= 0;
    };
    arm_.distance(&scene_, this, near);
    if (least_ > 0) arm_.distance(this, near);
    if (least_ < within) return std::max(least_, 0.0);
    return std::nullopt;
  }

 private:
  static std::size_t index(const fcl::CollisionObjectd* o) { return reinterpret_cast<std::size_t>(o->getUserData()); }
  static double distance(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b) {
    const fcl::DistanceRequestd request(true);
    fcl::DistanceResultd result;
    return fcl::distance(a, b, request, result);
  }
  void meet(fcl::CollisionObjectd* a, fcl::CollisionObjectd* b) {
    if (!allowed_[index(a)][index(b)]) return;
    const fcl::CollisionRequestd request;
    fcl::CollisionResultd result;
    if (fcl::collide(a, b, request, result) > 0) found_.push_back({index(a), index(b)});
  }

  std::vector<PartPair> pairs_;
  std::vector<std::vector<bool>> allowed_;
  std::vector<bool> robot_;
  std::vector<std::unique_ptr<fcl::CollisionObjectd>> objects_;
  fcl::DynamicAABBTreeCollisionManagerd arm_, scene_;
  std::vector<PartPair> found_;
  double least_ = 0;
  bool placed_ = false;
};

btVector3 vector_of(const Eigen::Vector3f& v) {
  return {btScalar(v.x()), btScalar(v.y()), btScalar(v.z())};
}

struct Least : btCollisionWorld::ContactResultCallback {
  explicit Least(double within) { m_closestDistanceThreshold = within; }
  btScalar addSingleResult(btManifoldPoint& point, const btCollisionObjectWrapper*, int, int,
                           const btCollisionObjectWrapper*, int, int) override {
    least = std::min(least, double(point.getDistance()));
    ++points;
    return 0;
  }
  double least = 1e30;
  int points = 0;
};

class BulletPeer : public ContactPeer {
 public:
  BulletPeer(const std::vector<const Mesh*>& meshes, const std::vector<PartPair>& pairs)
      : dispatcher_(&configuration_), world_(&dispatcher_, &broadphase_, &configuration_), pairs_(pairs) {
    // As registerAlgorithm() does, but for questions instead of steps of a world.
    for (int type = 0; type < MAX_BROADPHASE_COLLISION_TYPES; ++type) {
      dispatcher_.registerClosestPointsCreateFunc(GIMPACT_SHAPE_PROXYTYPE, type, &gimpact_);
      dispatcher_.registerClosestPointsCreateFunc(type, GIMPACT_SHAPE_PROXYTYPE, &gimpact_);
    }
    for (const Mesh* mesh : meshes) {
      triangles_.push_back(std::make_unique<btTriangleMesh>());
      compounds_.push_back(std::make_unique<btCompoundShape>(true, static_cast<int>(mesh->triangles.size())));
      compounds_.back()->setMargin(0);
      for (const auto& t : mesh->triangles) {
        const btVector3 a = vector_of(mesh->vertices[t[0]]), b = vector_of(mesh->vertices[t[1]]),
                        c = vector_of(mesh->vertices[t[2]]);
        triangles_.back()->addTriangle(a, b, c);
        children_.push_back(std::make_unique<btTriangleShape>(a, b, c));
        children_.back()->setMargin(0);
        compounds_.back()->addChildShape(btTransform::getIdentity(), children_.back().get());
      }
      shapes_.push_back(std::make_unique<btGImpactMeshShape>(triangles_.back().get()));
      shapes_.back()->setMargin(0);
      shapes_.back()->updateBound();
      objects_.push_back(std::make_unique<btCollisionObject>());
      objects_.back()->setCollisionShape(shapes_.back().get());
      apart_.push_back(std::make_unique<btCollisionObject>());
      apart_.back()->setCollisionShape(compounds_.back().get());
    }
  }
  void place(const std::vector<Pose>& T_world_part) override {
    for (std::size_t i = 0; i < objects_.size(); ++i) {
      btTransform T;
      for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c) T.getBasis()[r][c] = T_world_part[i].linear()(r, c);
      for (int r = 0; r < 3; ++r) T.getOrigin()[r] = T_world_part[i].translation()[r];
      objects_[i]->setWorldTransform(T);
      apart_[i]->setWorldTransform(T);
    }
  }
  std::vector<PartPair> touching() override {
    std::vector<PartPair> out;
    for (const PartPair& pair : pairs_) {
      if (!boxes_meet(pair, 0)) continue;
      Least result(0);
      world_.contactPairTest(objects_[pair[0]].get(), objects_[pair[1]].get(), result);
      if (result.points > 0) out.push_back(pair);
    }
    return out;
  }
  std::vector<double> distances(double within) override {
    std::vector<double> out;
    for (const PartPair& pair : pairs_) {
      if (!boxes_meet(pair, within)) continue;
      Least result(within);
      world_.contactPairTest(apart_[pair[0]].get(), apart_[pair[1]].get(), result);
      if (result.least < within) out.push_back(std::max(result.least, 0.0));
    }
    return out;
  }
  std::optional<double> least(double within) override {
    const std::vector<double> all = distances(within);
    if (all.empty()) return std::nullopt;
    return *std::ranges::min_element(all);
  }

 private:
  bool boxes_meet(const PartPair& pair, double within) const {
    btVector3 low[2], high[2];
    for (std::size_t i = 0; i < 2; ++i)
      shapes_[pair[i]]->getAabb(objects_[pair[i]]->getWorldTransform(), low[i], high[i]);
    for (int i = 0; i < 3; ++i)
      if (low[0][i] > high[1][i] + within || low[1][i] > high[0][i] + within) return false;
    return true;
  }

  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_;
  btGImpactCollisionAlgorithm::CreateFunc gimpact_;
  btDbvtBroadphase broadphase_;
  btCollisionWorld world_;
  std::vector<PartPair> pairs_;
  std::vector<std::unique_ptr<btTriangleMesh>> triangles_;
  std::vector<std::unique_ptr<btTriangleShape>> children_;
  std::vector<std::unique_ptr<btCompoundShape>> compounds_;
  std::vector<std::unique_ptr<btGImpactMeshShape>> shapes_;
  std::vector<std::unique_ptr<btCollisionObject>> objects_, apart_;
};

}  // namespace

std::unique_ptr<ContactPeer> make_fcl_peer(const std::vector<const Mesh*>& meshes, const std::vector<bool>& robot,
                                           const std::vector<PartPair>& pairs) {
  return std::make_unique<FclPeer>(meshes, robot, pairs);
}

std::unique_ptr<ContactPeer> make_bullet_peer(const std::vector<const Mesh*>& meshes,
                                              const std::vector<PartPair>& pairs) {
  return std::make_unique<BulletPeer>(meshes, pairs);
}

}  // namespace foresight
