// Commands as a drive that has a largest speed of its own can follow them.
//
//   commands     ____|'''''''''            far targets, given as steps, or faster motion than the drive can do
//   limited      ____/''''''''             what its response (step_response.hpp) then answers to
//
// The drive's other dynamics stay linear: they come after the limit.
#pragma once

#include <optional>

#include "prediction/position_history.hpp"

namespace foresight {

/// Appends to `limited` what becomes of the command `now` (the first, or the one after `before`) at no more than
/// `speed`
/// (> 0; infinite: the command itself). Where it is not reached yet, `limited` goes on towards it until it is (30 s at
/// most), as if no other came. Neither allocates nor throws.
void append_limited(PositionHistory& limited, const TimedPosition& now, double speed) noexcept;

/// The speed that a joint seems not to exceed though its commands ask for more: its largest one over a tenth of a
/// second. Nothing where commands do not ask for more, or there is little to judge by.
std::optional<double> speed_reached(const PositionHistory& commands, const PositionHistory& states) noexcept;

}  // namespace foresight
