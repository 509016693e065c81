#include "display/head/view_share.hpp"

#include <sys/mman.h>

#include <algorithm>
#include <atomic>
#include <cstring>
#include <new>
#include <stdexcept>

#include "common/error.hpp"
#include "common/triple_buffer.hpp"

namespace foresight::head {
namespace {

constexpr std::size_t kLayers = 4;              // of each eye: what it sees, then what that hides
constexpr std::size_t kPixelBytes = 4 + 4 + 1;  // colour, depth, node
using Numbers = std::array<double, 16>;         // of a pose, column by column

Numbers numbers_of(const Pose& pose) {
  Numbers out;
  std::copy_n(pose.matrix().data(), out.size(), out.begin());
  return out;
}

Pose pose_of(const Numbers& numbers) {
  Pose out;
  std::copy_n(numbers.begin(), numbers.size(), out.matrix().data());
  return out;
}

template <typename Poses>
void write_nodes(const Poses& poses, std::byte* to) {
  for (std::size_t i = 0; i < poses.size(); ++i) {
    const Numbers numbers = numbers_of(poses[i]);
    std::memcpy(to + i * sizeof numbers, numbers.data(), sizeof numbers);
  }
}

std::vector<Pose> read_nodes(const std::byte* from, std::size_t count) {
  std::vector<Pose> out;
  for (std::size_t i = 0; i < count; ++i) {
    Numbers numbers;
    std::memcpy(numbers.data(), from + i * sizeof numbers, sizeof numbers);
    out.push_back(pose_of(numbers));
  }
  return out;
}

/// What pixels of layers are read and written as.
struct PixelPlane {
  const gl::Texture& texture;
  GLenum format, type;
  std::size_t bytes;  // a pixel
};

std::array<PixelPlane, 3> planes_of(const WarpLayers& layers) {
  return {PixelPlane{layers.picture, GL_RGBA, GL_UNSIGNED_BYTE, 4}, PixelPlane{layers.depth, GL_RED, GL_FLOAT, 4},
          PixelPlane{layers.node, GL_RED_INTEGER, GL_UNSIGNED_BYTE, 1}};
}

const std::optional<WarpLayers>& layer_of(const DrawnEyes& eyes, std::size_t layer) {
  return (layer < 2 ? eyes.eyes : eyes.behind)[layer % 2];
}

}  // namespace

struct ViewShare::Aim {
  struct Eye {
    Numbers T_world_eye;
    EyeFov fov;
    int width, height;
  };
  std::array<Eye, 2> eyes;
  std::int64_t time_ns;
  StateStatus status;
  bool second_eye;
};

struct ViewShare::Views {
  struct Layer {
    bool there;
    Lens::Parameters lens;
    Numbers T_world_camera;
  };
  std::array<Layer, kLayers> layers;
};

struct ViewShare::Head {
  TripleIndex aims, views;
  std::atomic<std::uint64_t> drawn{0};
  std::atomic<bool> ended{false};
  std::atomic<const char*> doing{"begins"};
};

ViewShare::ViewShare(const ViewShareSize& size) : size_(size) {
  const std::size_t nodes = sizeof(Numbers) * size.nodes;
  bytes_ =
      sizeof(Head) + 3 * (sizeof(Aim) + nodes) + 3 * (sizeof(Views) + nodes + kLayers * kPixelBytes * size.most_pixels);
  void* const memory = ::mmap(nullptr, bytes_, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED)
    throw RuntimeFailure("there is no memory for views of another process", "end other programs");
  memory_ = static_cast<std::byte*>(memory);
  head_ = new (memory_) Head;
}

ViewShare::~ViewShare() {
  ::munmap(memory_, bytes_);
}

std::byte* ViewShare::aim_slot(std::size_t index) const {
  return memory_ + sizeof(Head) + index * (sizeof(Aim) + sizeof(Numbers) * size_.nodes);
}

std::byte* ViewShare::view_slot(std::size_t index) const {
  return aim_slot(3) +
         index * (sizeof(Views) + sizeof(Numbers) * size_.nodes + kLayers * kPixelBytes * size_.most_pixels);
}

std::byte* ViewShare::pixels(std::byte* slot, std::size_t layer) const {
  return slot + sizeof(Views) + sizeof(Numbers) * size_.nodes + layer * kPixelBytes * size_.most_pixels;
}

void ViewShare::aim(const HeadAim& aim) {
  if (aim.state.T_world_node.size() != size_.nodes) throw std::invalid_argument("the state of another scene");
  Aim plain{{}, aim.state.time.ns, aim.state.status, aim.second_eye};
  for (std::size_t i = 0; i < 2; ++i) {
    const EyeAim& eye = aim.eyes[i];
    if (eye.panel) throw std::invalid_argument("the lens of a panel does not go to another process");
    plain.eyes[i] = {numbers_of(eye.T_world_eye), eye.fov, eye.width, eye.height};
  }
  std::byte* const slot = aim_slot(head_->aims.writing());
  std::memcpy(slot, &plain, sizeof plain);
  write_nodes(aim.state.T_world_node, slot + sizeof plain);
  head_->aims.publish();
}

std::optional<HeadAim> ViewShare::take_aim() {
  if (!head_->aims.take()) return std::nullopt;
  const std::byte* const slot = aim_slot(head_->aims.reading());
  Aim plain;
  std::memcpy(&plain, slot, sizeof plain);
  HeadAim out;
  for (std::size_t i = 0; i < 2; ++i) {
    const Aim::Eye& eye = plain.eyes[i];
    out.eyes[i] = {pose_of(eye.T_world_eye), eye.fov, eye.width, eye.height};
  }
  out.state = {RobotTime{plain.time_ns}, plain.status, read_nodes(slot + sizeof plain, size_.nodes)};
  out.second_eye = plain.second_eye;
  return out;
}

bool ViewShare::put(const DrawnEyes& eyes) {
  std::byte* const slot = view_slot(head_->views.writing());
  Views plain{};
  for (std::size_t i = 0; i < kLayers; ++i) {
    const auto& layers = layer_of(eyes, i);
    if (!layers) continue;
    const auto count = static_cast<std::size_t>(layers->lens.width()) * static_cast<std::size_t>(layers->lens.height());
    if (count > size_.most_pixels || layers->T_world_node.size() != size_.nodes) return false;
    plain.layers[i] = {true, layers->lens.parameters(), numbers_of(layers->T_world_camera)};
    write_nodes(layers->T_world_node, slot + sizeof plain);  // the same of all
    std::byte* at = pixels(slot, i);
    for (const PixelPlane& plane : planes_of(*layers)) {
      glPixelStorei(GL_PACK_ALIGNMENT, 1);
      glGetTextureImage(plane.texture.name(), 0, plane.format, plane.type, static_cast<GLsizei>(plane.bytes * count),
                        at);
      at += plane.bytes * count;
    }
  }
  std::memcpy(slot, &plain, sizeof plain);
  head_->views.publish();
  ++head_->drawn;
  return true;
}

bool ViewShare::take(DrawnEyes& out) {
  if (!head_->views.take()) return false;
  std::byte* const slot = view_slot(head_->views.reading());
  Views plain;
  std::memcpy(&plain, slot, sizeof plain);
  for (std::size_t i = 0; i < kLayers; ++i) {
    auto& layers = (i < 2 ? out.eyes : out.behind)[i % 2];
    const Views::Layer& told = plain.layers[i];
    if (!told.there) {
      layers.reset();
      continue;
    }
    const Lens lens(told.lens);
    if (!layers || !alike(layers->lens, lens)) layers.emplace(lens, i >= 2);
    layers->T_world_camera = pose_of(told.T_world_camera);
    layers->T_world_node = read_nodes(slot + sizeof plain, size_.nodes);
    const auto count = static_cast<std::size_t>(lens.width()) * static_cast<std::size_t>(lens.height());
    const std::byte* at = pixels(slot, i);
    for (const PixelPlane& plane : planes_of(*layers)) {
      glPixelStorei(GL_UNPACK_ALIGNMENT, 1);
      glTextureSubImage2D(plane.texture.name(), 0, 0, 0, lens.width(), lens.height(), plane.format, plane.type, at);
      at += plane.bytes * count;
    }
  }
  return true;
}

void ViewShare::tell(const char* doing) {
  head_->doing = doing;
}

const char* ViewShare::doing() const {
  return head_->doing;
}

std::uint64_t ViewShare::drawn() const {
  return head_->drawn;
}

void ViewShare::end() {
  head_->ended = true;
}

bool ViewShare::ended() const {
  return head_->ended;
}

SharedViews::SharedViews(ViewShare& share, const SceneModel& scene)
    : share_(share), parts_(std::make_shared<const WarpScene>(scene)), capture_(parts_) {}

const DrawnEyes* SharedViews::newest() {
  if (share_.take(eyes_)) {
    for (const auto* both : {&eyes_.eyes, &eyes_.behind})
      for (const auto& layers : *both)
        if (layers) capture_.find_blocks(*layers);
    any_ = true;
  }
  return any_ ? &eyes_ : nullptr;
}

}  // namespace foresight::head
