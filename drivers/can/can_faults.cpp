#include "drivers/can/can_faults.hpp"

#include <string>

#include "common/error.hpp"

namespace foresight {

bool CanFaults::any() const {
  return loss > 0 || duplicate > 0 || reorder > 0 || error_frame > 0 || bus_off > 0 || delay_max.count() > 0;
}

void CanFaults::validate() const {
  const auto probability = [](const char* field, double value, double largest) {
    if (!(value >= 0 && value <= largest))
      throw InputError(std::string("faults.") + field, std::to_string(value) + " is out of range",
                       "give 0 to " + std::to_string(largest).substr(0, 4));
  };
  probability("loss", loss, 1);
  probability("duplicate", duplicate, 1);
  probability("reorder", reorder, 1);
  probability("error_frame", error_frame, 0.9);  // at 1 no frame would ever get through
  probability("bus_off", bus_off, 1);
  const auto not_negative = [](const char* field, Duration value) {
    if (value.count() < 0)
      throw InputError(std::string("faults.") + field, std::to_string(to_seconds(value)) + " s is negative",
                       "give 0 or more");
  };
  not_negative("delay_min", delay_min);
  not_negative("recovery", recovery);
  if (delay_max < delay_min)
    throw InputError("faults.delay_max", std::to_string(to_seconds(delay_max)) + " s is less than delay_min",
                     "give at least " + std::to_string(to_seconds(delay_min)) + " s");
  if (reorder_by.count() <= 0)
    throw InputError("faults.reorder_by", std::to_string(to_seconds(reorder_by)) + " s", "give more than 0");
}

}  // namespace foresight
