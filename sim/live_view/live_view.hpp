// What one camera sees of the live lab, rasterised: quick enough for 30 images per second.
//
// draw(): lab -> pinhole faces -> lens, sensor -> YUYV in a buffer that the GPU fills while the next image is drawn
#pragma once

#include <array>
#include <deque>
#include <memory>
#include <optional>

#include "common/lens.hpp"
#include "gl/faces.hpp"
#include "gl/kept_fences.hpp"
#include "gl/program.hpp"
#include "sim/live_view/lab_buffers.hpp"
#include "sim/sensor.hpp"

namespace foresight::sim {

/// Against sim::Renderer it lacks motion blur and rolling shutter, filters pictures by mipmaps, looks at edges in
/// kSamples places of a pixel, halves the colours' resolution (YUYV), and only takes sensors' blur of about 0.6 px.
/// Belongs to one context.
class LiveView {
 public:
  static constexpr std::size_t kImages = 3;  ///< under way, at most
  static constexpr int kSamples = 4;         ///< of a pixel of a face

  /// `lens` must have an even width. Throws std::invalid_argument.
  LiveView(std::shared_ptr<const LabBuffers> lab, const Lens& lens, const Sensor& sensor);

  /// Starts an image. `gain`: factor on the light; `number` picks the noise; `T_world_print`: one of each of the lab's
  /// prints. Returns false, and does nothing, where kImages are under way.
  bool draw(const Pose& T_world_camera, const LabState& T_world_part, double gain, std::uint64_t number,
            std::span<const Pose> T_world_print = {});

  /// Copies the oldest image under way to `out` (width * height * 2 bytes of YUYV) where it is finished, or, with
  /// `wait`, when it is. False: none, or not yet.
  bool take(std::span<std::uint8_t> out, bool wait);

  /// take() would not wait.
  bool ready() const { return !waiting_.empty() && slots_[waiting_.front()].done.signalled(); }
  std::size_t under_way() const { return waiting_.size(); }
  const Lens& lens() const { return lens_; }

 private:
  struct Slot {
    gl::Handle<gl::delete_buffer> buffer;
    const std::uint8_t* bytes = nullptr;  // mapped for ever
    gl::Fence done;
  };
  void draw_face(const Pose& T_face_world, const LabState& T_world_part, std::span<const Pose> T_world_print) const;
  void draw_faces(const Pose& T_world_camera, const LabState& T_world_part, std::span<const Pose> T_world_print) const;
  void draw_parts(const gl::Program& program, bool glossy, const Pose& T_face_world,
                  const LabState& T_world_part) const;
  void set_places();

  std::shared_ptr<const LabBuffers> lab_;
  Lens lens_;
  Sensor sensor_;
  gl::Faces faces_;
  gl::VertexArray array_, nothing_;
  gl::Program matt_, glossy_, resolve_, sensor_program_;
  std::optional<PrintPass> prints_;                 // where there are any
  gl::Handle<gl::delete_texture> samples_, depth_;  // of one face
  gl::Texture colour_, places_, yuyv_;
  gl::Framebuffer face_target_, colour_target_, sensor_target_;
  gl::KeptFences fences_;
  std::array<Slot, kImages> slots_;
  std::deque<std::size_t> waiting_;  // slots under way, oldest first
  std::size_t next_ = 0;
};

}  // namespace foresight::sim
