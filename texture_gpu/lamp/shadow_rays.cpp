#include "texture_gpu/lamp/shadow_rays.hpp"

#include <embree3/rtcore.h>

#include <algorithm>
#include <array>
#include <string>
#include <utility>

#include "common/error.hpp"

namespace foresight {
namespace {

// Of each packet's three coordinates one follows the other.
static_assert(offsetof(RTCRay8, org_z) == offsetof(RTCRay8, org_x) + 2 * sizeof(RTCRay8::org_x));
static_assert(offsetof(RTCRay8, dir_z) == offsetof(RTCRay8, dir_x) + 2 * sizeof(RTCRay8::dir_x));

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
  const Eigen::Vector3d way = to - from;
  const double length = way.norm();
  if (!(length > 2 * gap)) return false;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  RTCRay ray{};
  Eigen::Vector3f::Map(&ray.org_x) = from.cast<float>();
  Eigen::Vector3f::Map(&ray.dir_x) = (way / length).cast<float>();
  ray.tnear = static_cast<float>(gap);
  ray.tfar = static_cast<float>(length - gap);
  ray.mask = ~0u;
  rtcOccluded1(static_cast<RTCScene>(scene_), &context, &ray);
  return ray.tfar < 0;
}

unsigned ShadowRays::Posed::blocked(const Points& from, const Points& to, int count, double gap) const {
  using Row = Eigen::Array<float, 1, kPacket>;
  const auto ends = static_cast<float>(gap);
  const Points way = to - from;
  const Row length = way.colwise().norm();
  RTCRay8 rays;
  Points::Map(rays.org_x) = from;
  Points::Map(rays.dir_x) = way.array().rowwise() / length;
  Row::Map(rays.tnear).setConstant(ends);
  Row::Map(rays.tfar) = length - ends;
  std::ranges::fill(rays.time, 0.0f);
  std::ranges::fill(rays.mask, ~0u);
  std::ranges::fill(rays.flags, 0u);
  alignas(32) std::array<int, kPacket> valid;
  for (int i = 0; i < kPacket; ++i) valid[static_cast<std::size_t>(i)] = i < count && length[i] > 2 * ends ? -1 : 0;
  RTCIntersectContext context;
  rtcInitIntersectContext(&context);
  rtcOccluded8(valid.data(), static_cast<RTCScene>(scene_), &context, &rays);
  unsigned out = 0;
  for (int i = 0; i < kPacket; ++i) out |= (valid[static_cast<std::size_t>(i)] && rays.tfar[i] < 0 ? 1u : 0u) << i;
  return out;
}

std::vector<bool> ShadowRays::Posed::blocked(std::span<const Eigen::Vector3f> from, const Eigen::Vector3d& to,
                                             double gap) const {
  std::vector<bool> out;
  out.reserve(from.size());
  const Points ends = to.cast<float>().replicate<1, kPacket>();
  Points starts = ends;
  while (out.size() < from.size()) {
    const auto packet = from.subspan(out.size()).first(std::min<std::size_t>(kPacket, from.size() - out.size()));
    int count = 0;
    for (const Eigen::Vector3f& point : packet) starts.col(count++) = point;
    const unsigned hits = blocked(starts, ends, count, gap);
    for (int i = 0; i < count; ++i) out.push_back(hits >> i & 1u);
  }
  return out;
}

}  // namespace foresight
