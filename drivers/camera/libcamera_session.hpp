// What a LibcameraCamera needs of libcamera, so that tests can let it fail, and a build can do without it.
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/camera/camera.hpp"

namespace foresight::libcam {

/// An image that libcamera has finished.
struct Finished {
  std::size_t buffer = 0;
  bool complete = true;  ///< false: cancelled, or marked as damaged
  std::uint32_t sequence = 0;
  RobotTime stamp;                        ///< start of the first row's exposure
  std::optional<Duration> exposure;       ///< where the metadata tell it
  std::span<const std::uint8_t> bytes{};  ///< of all planes, which follow each other; until given back
};

/// A camera that streams, for one thread and one owner; its end stops and releases it.
class Session {
 public:
  virtual ~Session() = default;
  /// The oldest finished image not yet waited for; nothing within `timeout`, or once gone().
  virtual std::optional<Finished> wait(Duration timeout) noexcept = 0;
  virtual bool give_back(std::size_t buffer) noexcept = 0;  ///< false: refused, the camera is of no use any more
  virtual bool gone() const noexcept = 0;                   ///< libcamera says that it was unplugged
  virtual const CameraSettings& settings() const noexcept = 0;
  virtual std::size_t buffers() const noexcept = 0;  ///< that images come in
  virtual std::size_t stride() const noexcept = 0;   ///< bytes per row of the first plane; 0 for mjpeg
  virtual std::vector<CameraControl> controls() const = 0;
  /// For the images to come. Throws as Camera::set_control().
  virtual void set_control(const std::string& control, std::int64_t value) = 0;
};

class Library {
 public:
  virtual ~Library() = default;
  /// "ID (model)" of each camera, for messages. Throws RuntimeFailure where there is no libcamera.
  virtual std::vector<std::string> cameras() = 0;
  /// Starts the stream. `device`: a camera's id, or its model where only one has it. `name`: of the rig, for messages.
  /// Throws InputError (no such camera, naming those that are there; no such format, size or control) or
  /// RuntimeFailure.
  virtual std::shared_ptr<Session> open(const std::string& device, const CameraSettings& settings,
                                        const std::string& name) = 0;
};

/// The machine's; one that only throws where this program was built without libcamera. Lives for ever.
Library& library();
bool is_built_in() noexcept;

}  // namespace foresight::libcam
