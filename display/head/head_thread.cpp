#include "display/head/head_thread.hpp"

namespace foresight::head {
namespace {

constexpr Duration kIdle = std::chrono::milliseconds(20), kLook = std::chrono::milliseconds(5);

}  // namespace

HeadThread::HeadThread(std::unique_ptr<gl::Context> context, const HeadDisplayOptions& options, Clock& clock,
                       std::shared_ptr<HeldControllers> hands, HeadPainter& painter, std::function<void()> released)
    : context_(std::move(context)),
      clock_(clock),
      display_(options, clock, hands),
      painter_(painter),
      released_(std::move(released)),
      hands_(std::move(hands)),
      thread_([this] { run(); }) {}

HeadThread::~HeadThread() {
  stop_ = true;
  if (thread_.joinable()) thread_.join();
}

void HeadThread::run() {
  try {
    context_->make_current();
    gl::set_up_context();
    while (!stop_)
      if (!display_.step(painter_)) clock_.sleep_until(clock_.now() + kIdle);
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    failure_ = error.what();
  }
  hands_->gone("the head display has ended", "drive by other devices, or start again");
  try {
    display_.finish();
    released_();
    gl::check_errors("the head display");
    context_->release();
  } catch (const std::exception& error) {
    const std::lock_guard lock(mutex_);
    if (failure_.empty()) failure_ = error.what();
  }
  ended_ = true;
}

HeadStatus HeadThread::status() const {
  HeadStatus out = display_.status();
  const std::lock_guard lock(mutex_);
  if (failure_.empty()) return out;
  out.shown = out.focused = false;
  out.ended = true;
  out.trouble = failure_;
  out.cure = "start again";
  return out;
}

bool HeadThread::stop(Duration most) {
  stop_ = true;
  for (const RobotTime end = clock_.now() + most; !ended_ && clock_.now() < end;)
    clock_.sleep_until(clock_.now() + kLook);
  if (ended_ && thread_.joinable()) thread_.join();
  return ended_;
}

}  // namespace foresight::head
