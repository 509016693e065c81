// What control over the line says to people.
#pragma once

#include "link/control/messages.hpp"

namespace foresight {

/// Static text: a clause, and what to do; "" where nothing is to be said or done.
struct ControlWords {
  const char* name;
  const char* cure;
};

ControlWords words_for(RestCause cause);
ControlWords words_for(SetPointFault fault);
ControlWords words_for(RequestOutcome outcome);
const char* to_string(LineRequest request);

}  // namespace foresight
