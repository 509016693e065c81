#include "texture_gpu/frame_gate.hpp"

#include <algorithm>

#include "gl/objects.hpp"

namespace foresight {
namespace {

// Short against a frame, long against what it costs to wait for the renderer at a slice's end.
constexpr Duration kSlice = std::chrono::milliseconds(3);
constexpr Duration kLongestSleep = std::chrono::milliseconds(50);
constexpr Duration kLongestWay = std::chrono::milliseconds(50);
constexpr Duration kLook = std::chrono::microseconds(500);  // within which the next slice of a row is asked for

}  // namespace

void FrameGate::frame_begins(FramesOf display) {
  const std::scoped_lock lock(mutex_);
  budget_.frame_begins(clock_.now(), display);
}

void FrameGate::frame_ends(RobotTime next, FramesOf display) {
  {
    const std::scoped_lock lock(mutex_);
    budget_.frame_ends(clock_.now(), next, display);
  }
  frame_ended_.notify_all();
}

void FrameGate::make_way() {
  std::unique_lock lock(mutex_);
  const RobotTime most = clock_.now() + kLongestWay;
  for (bool is_over = false; !is_over && clock_.now() < most && budget_.has_turn(clock_.now());) {
    const bool between = !asked_;
    slice_ended_.wait_for(lock, kLook);
    is_over = between && !asked_;
  }
}

std::size_t FrameGate::begin(const char* kind, std::size_t units) {
  std::unique_lock lock(mutex_);
  kind_ = kind;
  asked_ = true;
  ++slices_;
  for (;;) {
    began_ = clock_.now();
    const double now = budget_.units_now(began_, kSlice, kind, static_cast<double>(units));
    units_ = std::max<std::size_t>(1, static_cast<std::size_t>(now));
    const auto until = budget_.wait(began_, kind, static_cast<double>(units_));
    in_work_ = !until;
    if (in_work_) return units_;
    frame_ended_.wait_for(lock, std::clamp(*until - began_, Duration{1}, kLongestSleep));
  }
}

void FrameGate::end() {
  {
    const std::scoped_lock lock(mutex_);
    budget_.ran(began_, clock_.now(), kind_, static_cast<double>(units_));
    in_work_ = asked_ = false;
  }
  slice_ended_.notify_all();
}

Duration FrameGate::rest_due() const {
  const std::scoped_lock lock(mutex_);
  return asked_ ? budget_.rest_due(clock_.now()) : Duration{0};
}

bool FrameGate::in_work() const {
  const std::scoped_lock lock(mutex_);
  return in_work_;
}

std::size_t next_slice(FrameGate* gate, const char* kind, std::size_t units) {
  if (!gate) return units;
  glFinish();
  gate->end();
  return gate->begin(kind, units);
}

GpuSlice::~GpuSlice() {
  if (!gate_) return;
  glFinish();
  gate_->end();
}

}  // namespace foresight
