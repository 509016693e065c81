// Between a display that has to be in time and the extraction beside it: who has the processors now.
#pragma once

#include <atomic>
#include <condition_variable>
#include <mutex>

#include "common/clock.hpp"
#include "texture_gpu/slice_budget.hpp"

namespace foresight {

/// The displays' threads say when they draw; the thread that works asks before each slice, and waits until it may.
/// Where a software renderer draws, all need the same cores; on a GPU, the same queue. The clock runs by itself.
class FrameGate {
 public:
  /// `clock` must outlive this.
  explicit FrameGate(Clock& clock, const SliceBudgetOptions& options = {}) : clock_(clock), budget_(options) {}
  FrameGate(const FrameGate&) = delete;

  /// The display's thread.
  void frame_begins(FramesOf display = FramesOf::window);
  void frame_ends(RobotTime next, FramesOf display = FramesOf::window);
  /// Between its frames: a slice that has come to its turn runs first (SliceBudget::has_turn), alone, so that no frame
  /// takes longer for it. There are fewer frames where they leave the work less than its share. Waits 50 ms at most.
  void make_way();
  /// When a frame has ended: for how long work is to have the processors before the next one (SliceBudget::rest_due).
  /// 0 where there is none.
  Duration rest_due() const;

  /// The working thread: waits until a slice may run, and says how many of `units` it is to do, at least 1. Slices of
  /// one kind cost alike per unit. end() once the GPU has finished it.
  std::size_t begin(const char* kind, std::size_t units = 1);
  void end();
  /// A slice has begun and not ended.
  bool in_work() const;
  std::size_t slices() const { return slices_; }  ///< that have been asked for so far

 private:
  Clock& clock_;
  mutable std::mutex mutex_;
  std::condition_variable frame_ended_, slice_ended_;
  SliceBudget budget_;
  std::atomic<std::size_t> slices_ = 0;
  RobotTime began_;
  const char* kind_ = "";
  std::size_t units_ = 0;
  bool asked_ = false, in_work_ = false;  // a slice was asked for, and has begun
};

/// The slice in work ends here, GPU included, and one of `kind` begins when it may: how many of `units` it is to do.
/// Null: nothing waits, and it does all of them.
std::size_t next_slice(FrameGate* gate, const char* kind, std::size_t units = 1);

/// Work in slices, one after the other by next_slice(). The last one ends with this, however its scope is left. Null:
/// nothing waits.
class SlicedWork {
 public:
  SlicedWork(FrameGate* gate, const char* first) : gate_(gate) {
    if (gate_) gate_->begin(first);
  }
  ~SlicedWork() {
    if (gate_) gate_->end();
  }
  SlicedWork(const SlicedWork&) = delete;

 private:
  FrameGate* gate_;
};

/// One slice, the GPU included, however its scope is left. Null: nothing waits, and it does all units.
class GpuSlice {
 public:
  GpuSlice(FrameGate* gate, const char* kind, std::size_t units = 1)
      : gate_(gate), units_(gate ? gate->begin(kind, units) : units) {}
  ~GpuSlice();
  GpuSlice(const GpuSlice&) = delete;

  std::size_t units() const { return units_; }  ///< that it is to do

 private:
  FrameGate* gate_;
  std::size_t units_;
};

}  // namespace foresight
