// Devices by their names on a command line.
#include "input/open_tracker.hpp"

#include <gmock/gmock.h>

#include "common/error.hpp"

namespace foresight::open_tracker_test {
namespace {

using testing::HasSubstr;

std::string refusal(const std::string& device) {
  try {
    open_tracker(device);
  } catch (const InputError& error) {
    return error.what();
  }
  return "";
}

TEST(OpenTracker, ANameThatIsMistypedIsToldTheNearestOneAndWhereAllAre) {
  for (const auto& [typed, meant] : {std::pair{"gamepd", "'gamepad'"}, {"spacemose", "'spacemouse'"}}) {
    EXPECT_THAT(refusal(typed), HasSubstr(std::string("did you mean ") + meant));
    EXPECT_THAT(refusal(typed), HasSubstr("foresight input list"));
  }
  EXPECT_THAT(refusal("joystick"), HasSubstr("foresight input list"));
}

TEST(OpenTracker, AFileThatIsNotThereIsTakenForNoDevice) {
  EXPECT_THAT(refusal("/nowhere/trace.csv"), HasSubstr("no such file"));
  EXPECT_THAT(refusal("trace.csv"), Not(HasSubstr("did you mean")));
  EXPECT_THAT(refusal("trace.csv"), HasSubstr("foresight input list"));
}

}  // namespace
}  // namespace foresight::open_tracker_test
