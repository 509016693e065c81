#include <libcamera/libcamera.h>
#include <libcamera/logging.h>

#include <algorithm>
#include <cmath>
#include <condition_variable>
#include <deque>
#include <filesystem>
#include <mutex>

#include "common/error.hpp"
#include "common/text.hpp"
#include "drivers/camera/libcamera_mapping.hpp"
#include "drivers/camera/libcamera_session.hpp"
#include "drivers/camera/libcamera_unplug.hpp"
#include "drivers/camera/libcamera_values.hpp"

namespace foresight::libcam {
namespace {

namespace lc = libcamera;

/// libcamera allows one manager per process: cameras share it, and it goes with the last of them, so that the next one
/// looks anew at what is plugged in even where no hot-plug events come.
std::shared_ptr<lc::CameraManager> manager() {
  static std::mutex mutex;
  static std::weak_ptr<lc::CameraManager> shared;
  const std::lock_guard lock(mutex);
  if (auto alive = shared.lock()) return alive;
  for (const char* chatty : {"Camera", "IPAManager"}) lc::logSetLevel(chatty, "ERROR");
  auto made = std::shared_ptr<lc::CameraManager>(new lc::CameraManager, [](lc::CameraManager* old) {
    old->stop();
    delete old;
  });
  if (const int error = made->start(); error != 0)
    throw RuntimeFailure("libcamera does not start (error " + std::to_string(-error) + ")",
                         "see what it says on stderr, and whether this user is in the group video");
  shared = made;
  return made;
}

std::string model_of(const lc::Camera& camera) {
  return camera.properties().get(lc::properties::Model).value_or("");
}

std::vector<std::string> names(const lc::CameraManager& manager) {
  std::vector<std::string> out;
  for (const auto& camera : manager.cameras()) out.push_back(camera->id() + " (" + model_of(*camera) + ")");
  return out;
}

/// libcamera calls back on its own thread; wait() and the rest belong to the owner's.
class OpenCamera final : public Session {
 public:
  OpenCamera(std::shared_ptr<lc::CameraManager> manager, std::shared_ptr<lc::Camera> camera,
             const CameraSettings& settings, std::string where)
      : manager_(std::move(manager)),
        camera_(std::move(camera)),
        where_(std::move(where)),
        settings_(settings),
        interfaces_(usb_interfaces(camera_->id())) {
    if (const int error = camera_->acquire(); error != 0)
      fail("cannot be acquired", error, "see whether another program has it");
    try {
      configure();
      make_requests();
      begin();
    } catch (...) {
      end();
      throw;
    }
  }
  ~OpenCamera() override { end(); }

  std::optional<Finished> wait(Duration timeout) noexcept override {
    std::unique_lock lock(mutex_);
    arrived_.wait_for(lock, timeout, [this] { return gone_ || !finished_.empty(); });
    if (gone_ || finished_.empty()) return std::nullopt;
    const Finished out = finished_.front();
    finished_.pop_front();
    return out;
  }

  bool give_back(std::size_t buffer) noexcept override {
    lc::Request& request = *requests_[buffer];
    request.reuse(lc::Request::ReuseBuffers);
    if (changed_) request.controls().merge(*std::exchange(changed_, std::nullopt));
    return camera_->queueRequest(&request) == 0;
  }

  bool gone() const noexcept override {
    const std::lock_guard lock(mutex_);
    return gone_;
  }
  /// Unplugged, but libcamera does not know.
  bool vanished() const noexcept {
    std::error_code error;
    return started_ && !gone() && std::ranges::any_of(interfaces_, [&](const std::filesystem::path& interface) {
             return !std::filesystem::exists(interface, error);
           });
  }
  const CameraSettings& settings() const noexcept override { return settings_; }
  std::size_t buffers() const noexcept override { return requests_.size(); }
  std::size_t stride() const noexcept override { return stride_; }

  std::vector<CameraControl> controls() const override {
    return list_controls(camera_->controls(), settings_.controls);
  }

  void set_control(const std::string& control, std::int64_t value) override {
    if (!changed_) changed_.emplace(camera_->controls());
    add_control(*changed_, camera_->controls(), control, value, where_);
    settings_.controls[control] = value;
  }

 private:
  [[noreturn]] void fail(const std::string& what, int error, const char* cure) const {
    throw RuntimeFailure(where_ + ": " + what + " (error " + std::to_string(-error) + ")", cure);
  }

  void configure() {
    config_ = camera_->generateConfiguration({lc::StreamRole::VideoRecording});
    if (!config_ || config_->empty()) fail("has no stream for video", 0, "use another camera");
    lc::StreamConfiguration& stream = config_->at(0);
    const lc::PixelFormat format = offered_format(stream.formats(), settings_.format, where_);
    stream.pixelFormat = format;
    stream.size = lc::Size(static_cast<unsigned>(settings_.width), static_cast<unsigned>(settings_.height));
    stream.bufferCount = std::max(stream.bufferCount, 4u);
    const lc::Size wanted = stream.size;
    config_->validate();
    if (stream.pixelFormat != format || stream.size != wanted)
      throw InputError(where_, "it does not do " + wanted.toString() + " " + to_string(settings_.format),
                       "the nearest that it does is " + stream.size.toString());
    if (const int error = camera_->configure(config_.get()); error != 0)
      fail("cannot be configured", error, "see what libcamera says on stderr");
    stride_ = settings_.format == PixelFormat::mjpeg ? 0 : stream.stride;
  }

  void make_requests() {
    lc::Stream* const stream = config_->at(0).stream();
    allocator_ = std::make_unique<lc::FrameBufferAllocator>(camera_);
    if (const int error = allocator_->allocate(stream); error < 0)
      fail("gives no buffers", error, "see how much memory is left");
    for (const auto& buffer : allocator_->buffers(stream)) {
      mappings_.push_back(std::make_unique<Mapping>(*buffer, where_));
      requests_.push_back(camera_->createRequest(requests_.size()));
      if (!requests_.back() || requests_.back()->addBuffer(stream, buffer.get()) != 0)
        fail("takes no request", 0, "see what libcamera says on stderr");
    }
  }

  void begin() {
    lc::ControlList first(camera_->controls());
    const auto& known = camera_->controls();
    if (settings_.exposure.count() > 0) {
      if (known.find(&lc::controls::ExposureTime) == known.end())
        throw InputError(where_, "its exposure cannot be set", "leave the exposure out");
      if (known.find(&lc::controls::AeEnable) != known.end()) first.set(lc::controls::AeEnable, false);
      add_control(first, known, plain_name(lc::controls::ExposureTime),
                  settings_.exposure / std::chrono::microseconds(1), where_);
    }
    // USB cameras have no such control, and run at their own rate.
    if (known.find(&lc::controls::FrameDurationLimits) != known.end()) {
      const auto period = static_cast<std::int64_t>(std::llround(1e6 / settings_.rate));
      first.set(lc::controls::FrameDurationLimits, {period, period});
    }
    for (const auto& [control, value] : settings_.controls) add_control(first, known, control, value, where_);
    camera_->requestCompleted.connect(this, &OpenCamera::completed);
    camera_->disconnected.connect(this, &OpenCamera::disconnected);
    if (const int error = camera_->start(&first); error != 0)
      fail("does not start", error,
           "for USB cameras, check that the bus has room for both: use mjpeg, or two controllers");
    started_ = true;
    for (const auto& request : requests_)
      if (const int error = camera_->queueRequest(request.get()); error != 0)
        fail("takes no request", error, "see what libcamera says on stderr");
  }

  void end() noexcept {
    if (started_) camera_->stop();  // cancels what is under way; completed() hears of it
    camera_->requestCompleted.disconnect(this);
    camera_->disconnected.disconnect(this);
    requests_.clear();
    mappings_.clear();
    allocator_.reset();
    config_.reset();
    camera_->release();
    camera_.reset();  // before its manager
  }

  void completed(lc::Request* request) {
    if (request->status() == lc::Request::RequestCancelled) return;
    const lc::FrameBuffer& buffer = *request->buffers().begin()->second;
    const lc::FrameMetadata& metadata = buffer.metadata();
    Finished out;
    out.buffer = request->cookie();
    out.complete = metadata.status == lc::FrameMetadata::FrameSuccess;
    out.sequence = metadata.sequence;
    const auto stamp = request->metadata().get(lc::controls::SensorTimestamp);
    out.stamp.ns = stamp.value_or(static_cast<std::int64_t>(metadata.timestamp));
    if (const auto exposure = request->metadata().get(lc::controls::ExposureTime))
      out.exposure = std::chrono::microseconds(*exposure);
    std::size_t used = 0;
    for (const auto& plane : metadata.planes()) used += plane.bytesused;
    out.bytes = mappings_[out.buffer]->bytes(used);
    {
      const std::lock_guard lock(mutex_);
      finished_.push_back(out);
    }
    arrived_.notify_one();
  }

  void disconnected() {
    {
      const std::lock_guard lock(mutex_);
      gone_ = true;
    }
    arrived_.notify_one();
  }

  std::shared_ptr<lc::CameraManager> manager_;
  std::shared_ptr<lc::Camera> camera_;
  std::string where_;
  CameraSettings settings_;
  const std::vector<std::filesystem::path> interfaces_;
  std::unique_ptr<lc::CameraConfiguration> config_;
  std::unique_ptr<lc::FrameBufferAllocator> allocator_;
  std::vector<std::unique_ptr<Mapping>> mappings_;
  std::vector<std::unique_ptr<lc::Request>> requests_;
  std::optional<lc::ControlList> changed_;  // for the next request
  std::size_t stride_ = 0;
  bool started_ = false;

  mutable std::mutex mutex_;  // all below
  std::condition_variable arrived_;
  std::deque<Finished> finished_;  // at most one per request
  bool gone_ = false;
};

/// libcamera 0.0.3 aborts the whole process where it stops a camera that is gone, unless it was told so.
void end_or_keep(OpenCamera* camera) {
  std::unique_ptr<OpenCamera> owned(camera);
  if (owned->vanished()) vanished_sessions().add(std::move(owned));
}

class Machine final : public Library {
 public:
  std::vector<std::string> cameras() override { return names(*manager()); }

  std::shared_ptr<Session> open(const std::string& device, const CameraSettings& settings,
                                const std::string& name) override {
    vanished_sessions().end_those_told();
    const auto all = manager();
    const std::string where = "camera '" + name + "', libcamera:" + device;
    std::vector<std::shared_ptr<lc::Camera>> found;
    for (const auto& camera : all->cameras())
      if (camera->id() == device || model_of(*camera) == device) found.push_back(camera);
    if (found.size() == 1) return {new OpenCamera(all, found.front(), settings, where), end_or_keep};
    const std::string there = joined(names(*all));
    if (found.empty())
      throw InputError(where, "libcamera knows no such camera",
                       there.empty() ? "connect it: there is none" : "connect it, or choose one of: " + there);
    throw InputError(where, "more than one camera is of this model", "give the id of one of: " + there);
  }
};

}  // namespace

Library& library() {
  static Machine machine;
  return machine;
}

bool is_built_in() noexcept {
  return true;
}

}  // namespace foresight::libcam
