#include "input/recorded_tracker.hpp"

namespace foresight {

TrackerState RecordedTracker::read(OperatorTime now) noexcept {
  if (!begun_) begun_ = now;
  const std::vector<TrackerTrace::Row>& rows = trace_.rows;
  const Duration passed = now - *begun_;
  while (at_ + 1 < rows.size() && rows[at_ + 1].time <= passed) ++at_;
  ended_ = passed > rows.back().time;
  TrackerState out = rows[at_].state;
  out.time = *begun_ + rows[at_].time;
  if (ended_) {
    out = TrackerState{};
    out.trouble = "the recording has ended";
    out.cure = "start it anew";
    out.time = *begun_ + rows.back().time;
  }
  return out;
}

}  // namespace foresight
