#include "texture_gpu/lamp/shadow_rays.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include "common/error.hpp"

namespace foresight {
namespace {

struct Way {
  Eigen::Vector3f origin, direction;
  float near, far;  // metres along it
};

/// Nothing where less than the ends is there.
std::optional<Way> way_between(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double gap) {
  const Eigen::Vector3d way = to - from;
  const double length = way.norm();
  if (!(length > 2 * gap)) return std::nullopt;
  return Way{from.cast<float>(), (way / length).cast<float>(), static_cast<float>(gap),
             static_cast<float>(length - gap)};
}

}  // namespace

struct ShadowRays::Device {
  RTCDevice device = nullptr;
  std::vector<RTCScene> nodes;  // null where there is no mesh

  ~Device() {
    for (RTCScene scene : nodes)
      if (scene) rtcReleaseScene(scene);
    if (device) rtcReleaseDevice(device);
  }
  void check(const char* what) const {
    if (rtcGetDeviceError(device) != RTC_ERROR_NONE)
      throw RuntimeFailure(std::string("shadow rays: ") + what + " failed", "free some memory");
  }
};

ShadowRays::ShadowRays(const SceneModel& scene) : device_(std::make_unique<Device>()) {
  device_->device = rtcNewDevice("threads=1,set_affinity=0");
  if (!device_->device)
    throw RuntimeFailure("shadow rays: Embree does not start", "is libembree3 installed as a whole?");
  for (const Node& node : scene.nodes()) {
    RTCScene& made = device_->nodes.emplace_back(nullptr);
    const Mesh& mesh = node.mesh;
    if (mesh.triangles.empty()) continue;
    RTCGeometry geometry = rtcNewGeometry(device_->device, RTC_GEOMETRY_TYPE_TRIANGLE);
    void* vertices = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_VERTEX, 0, RTC_FORMAT_FLOAT3,
                                             sizeof(mesh.vertices[0]), mesh.vertices.size());
    void* triangles = rtcSetNewGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT3,
                                              sizeof(mesh.triangles[0]), mesh.triangles.size());
    device_->check("a mesh");
    std::ranges::copy(mesh.vertices, static_cast<Eigen::Vector3f*>(vertices));
    std::ranges::copy(mesh.triangles, static_cast<std::array<std::uint32_t, 3>*>(triangles));
    rtcCommitGeometry(geometry);
    made = rtcNewScene(device_->device);
    rtcAttachGeometry(made, geometry);
    rtcReleaseGeometry(geometry);
    rtcCommitScene(made);
    device_->check("a mesh");
  }
}

ShadowRays::~ShadowRays() = default;

ShadowRays::Posed ShadowRays::pose(const std::vector<Pose>& T_world_node, const std::vector<bool>& nodes) const {
  Posed posed(rtcNewScene(device_->device));
  const auto scene = static_cast<RTCScene>(posed.scene_);
  for (std::size_t i = 0; i < device_->nodes.size(); ++i) {
    if (!device_->nodes[i] || !nodes[i]) continue;
    RTCGeometry instance = rtcNewGeometry(device_->device, RTC_GEOMETRY_TYPE_INSTANCE);
    rtcSetGeometryInstancedScene(instance, device_->nodes[i]);
    const Eigen::Matrix4f T = T_world_node[i].matrix().cast<float>();
    rtcSetGeometryTransform(instance, 0, RTC_FORMAT_FLOAT4X4_COLUMN_MAJOR, T.data());
    rtcCommitGeometry(instance);
    rtcAttachGeometry(scene, instance);
    rtcReleaseGeometry(instance);
  }
  rtcCommitScene(scene);
  device_->check("a pose");
  return posed;
}

ShadowRays::Posed::~Posed() {
  if (scene_) rtcReleaseScene(static_cast<RTCScene>(scene_));
}

ShadowRays::Posed::Posed(Posed&& other) noexcept : scene_(std::exchange(other.scene_, nullptr)) {}

ShadowRays::Posed& ShadowRays::Posed::operator=(Posed&& other) noexcept {
  std::swap(scene_, other.scene_);
  return *this;
}

bool ShadowRays::Posed::blocked(const Eigen::Vector3d& from, const Eigen::Vector3d& to, double gap) const {
  const std::optional<Way> way = way_between(from, to, gap);
  if (!way) return false;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray{};
  ray.org_x = way->origin.x(), ray.org_y = way->origin.y(), ray.org_z = way->origin.z();
  ray.dir_x = way->direction.x(), ray.dir_y = way->direction.y(), ray.dir_z = way->direction.z();
  ray.tnear = way->near;
  ray.tfar = way->far;
  ray.mask = ~0u;
  rtcOccluded1(static_cast<RTCScene>(scene_), &context, &ray);
  return ray.tfar < 0;
}

int ShadowRays::Posed::count_blocked(const Eigen::Vector3d& from, std::span<const Eigen::Vector3d, kPacket> to,
                                     double gap) const {
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  context.flags = RTC_INTERSECT_CONTEXT_FLAG_COHERENT;
  RTCRay8 rays{};
  alignas(32) std::array<int, kPacket> valid{};
  for (std::size_t i = 0; i < kPacket; ++i) {
    const std::optional<Way> way = way_between(from, to[i], gap);
    if (!way) continue;
    valid[i] = -1;
    rays.org_x[i] = way->origin.x(), rays.org_y[i] = way->origin.y(), rays.org_z[i] = way->origin.z();
    rays.dir_x[i] = way->direction.x(), rays.dir_y[i] = way->direction.y(), rays.dir_z[i] = way->direction.z();
    rays.tnear[i] = way->near;
    rays.tfar[i] = way->far;
    rays.mask[i] = ~0u;
  }
  rtcOccluded8(valid.data(), static_cast<RTCScene>(scene_), &context, &rays);
  return static_cast<int>(std::ranges::count_if(rays.tfar, [](float far) { return far < 0; }));
}

}  // namespace foresight
