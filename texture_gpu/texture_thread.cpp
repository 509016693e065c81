#include "texture_gpu/texture_thread.hpp"

#include <chrono>

#include "common/error.hpp"
#include "gl/kept_programs.hpp"

namespace foresight {

TextureThread::TextureThread(std::unique_ptr<gl::Context> context, const Setup& setup) : context_(std::move(context)) {
  thread_ = std::jthread([this, setup](const std::stop_token& stop) { run(stop, setup); });
  std::unique_lock lock(mutex_);
  changed_.wait(lock, [&] { return ready_ || error_; });
  if (error_) {
    lock.unlock();
    thread_.join();
    std::rethrow_exception(error_);
  }
}

TextureThread::~TextureThread() = default;  // jthread: asks the thread to stop and joins it

void TextureThread::run(const std::stop_token& stop, const Setup& setup) {
  try {
    context_->make_current();
    gl::set_up_context();
    gl::KeptPrograms programs;
    const gl::KeptPrograms::Use use(programs);
    for (bool rehearses = setup.rehearses; !stop.stop_requested(); rehearses = false) run_core(stop, setup, rehearses);
  } catch (...) {
    const std::scoped_lock lock(mutex_);
    error_ = std::current_exception();
  }
  latest_images_.publish(nullptr);
  latest_.publish(nullptr);
  changed_.notify_all();
  context_->release();
}

/// From the first image to begin_anew(), or the end.
void TextureThread::run_core(const std::stop_token& stop, const Setup& setup, bool rehearses) {
  TextureCore core(setup.scene, setup.surface, setup.left, setup.right, setup.options, gl::query_driver().is_software);
  {
    const std::scoped_lock lock(mutex_);
    ready_ = true;
    anew_ = false;
  }
  changed_.notify_all();
  if (rehearses)
    core.rehearse();
  else
    core.use(setup.gate.get());
  work(stop, core, setup.images);
  latest_images_.publish(nullptr);
  latest_.publish(nullptr);  // its textures go with the core
}

void TextureThread::work(const std::stop_token& stop, TextureCore& core, bool images) {
  while (!stop.stop_requested()) {
    std::unique_lock lock(mutex_);
    // The time-out only bounds the wait; a stop request wakes the thread at once.
    if (!changed_.wait_for(lock, stop, std::chrono::seconds(1), [&] { return waiting_ || anew_; })) continue;
    if (anew_) return;
    const PosedFrame frame = std::move(*waiting_);
    waiting_.reset();
    const std::uint64_t number = submitted_;
    lock.unlock();
    ExtractionReport report;
    if (images) {
      if (core.look(frame, latest_images_)) {
        lock.lock();
        looked_at_ = number;
        changed_.notify_all();
        while (hold_ && !stop.stop_requested())
          changed_.wait_for(lock, stop, std::chrono::seconds(1), [&] { return !hold_; });
        lock.unlock();
        if (stop.stop_requested()) return;
      }
      report = core.extract(latest_, &latest_images_);
    } else {
      report = core.process(frame, latest_);
    }
    lock.lock();
    report_ = std::move(report);
    looked_at_ = finished_ = number;
    lock.unlock();
    changed_.notify_all();
  }
}

void TextureThread::rethrow_locked() {
  if (error_) std::rethrow_exception(error_);
}

/// The frame's number.
std::uint64_t TextureThread::hand_over(PosedFrame frame, bool hold) {
  std::uint64_t number = 0;
  {
    const std::scoped_lock lock(mutex_);
    rethrow_locked();
    if (waiting_) ++replaced_;
    waiting_ = std::move(frame);
    hold_ = hold;
    number = ++submitted_;
  }
  changed_.notify_all();
  return number;
}

void TextureThread::submit(PosedFrame frame) {
  hand_over(std::move(frame), false);
}

std::optional<ExtractionReport> TextureThread::take_report() {
  const std::scoped_lock lock(mutex_);
  rethrow_locked();
  return std::exchange(report_, std::nullopt);
}

/// Until `condition`; rethrows an error of the thread.
template <typename Condition>
void TextureThread::wait_until(std::unique_lock<std::mutex>& lock, double timeout_s, Condition&& condition) {
  const bool done =
      changed_.wait_for(lock, std::chrono::duration<double>(timeout_s), [&] { return error_ || condition(); });
  rethrow_locked();
  if (!done)
    throw RuntimeFailure("the texture thread did not finish an image within " + std::to_string(timeout_s) + " s",
                         "look for a GPU fault with `dmesg`");
}

ExtractionReport TextureThread::process(PosedFrame frame, double timeout_s) {
  submit(std::move(frame));
  std::unique_lock lock(mutex_);
  wait_until(lock, timeout_s, [&] { return finished_ == submitted_; });
  return std::move(*std::exchange(report_, std::nullopt));
}

void TextureThread::show(PosedFrame frame, double timeout_s) {
  follow(timeout_s);
  const std::uint64_t number = hand_over(std::move(frame), true);
  std::unique_lock lock(mutex_);
  wait_until(lock, timeout_s, [&] { return looked_at_ == number; });
}

std::optional<ExtractionReport> TextureThread::follow(double timeout_s) {
  std::unique_lock lock(mutex_);
  hold_ = false;
  changed_.notify_all();
  wait_until(lock, timeout_s, [&] { return finished_ == submitted_; });
  return std::exchange(report_, std::nullopt);
}

void TextureThread::begin_anew(double timeout_s) {
  follow(timeout_s);
  std::unique_lock lock(mutex_);
  ready_ = false;
  anew_ = true;
  changed_.notify_all();
  wait_until(lock, timeout_s, [&] { return ready_; });
}

std::uint64_t TextureThread::replaced() const {
  const std::scoped_lock lock(mutex_);
  return replaced_;
}

}  // namespace foresight
