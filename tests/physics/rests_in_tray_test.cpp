// When a brick counts as put into the tray.
#include "sim/physics/rests_in_tray.hpp"

#include <gtest/gtest.h>

#include "sim/arm.hpp"
#include "sim/lab_task.hpp"

namespace foresight::sim::rests_in_tray_test {
namespace {

using namespace std::chrono_literals;

TEST(RestsInTray, OnlyOnceItFliesNoMore) {
  constexpr RobotTime kStart{5'000'000'000};
  const auto lab =
      std::make_shared<const LiveLab>(LiveLab::Options{.texel = 0.02, .task = 0u, .loose = lab_thing_names()});
  PhysicalLab world(
      lab, [](std::string_view joint, RobotTime) { return shafts_at_rest(joint); }, kStart);
  const Pose tray = world.thing_at("tray", kStart + 1s);
  const auto rests = [&](RobotTime time) { return rests_in_tray(world, "brick_red", tray, time); };
  EXPECT_FALSE(rests(kStart + 1s)) << "beside it";
  world.displace("brick_red", tray * Eigen::Translation3d(0, 0, 0.25));
  RobotTime time = kStart + 1s;
  while (!lies_in_tray(world.thing_at("brick_red", time), tray) && time < kStart + 3s) time = time + 4ms;
  EXPECT_LT(time, kStart + 3s) << "it falls past the tray";
  EXPECT_FALSE(rests(time)) << "it still falls";
  EXPECT_TRUE(rests(time + 2s));
}

}  // namespace
}  // namespace foresight::sim::rests_in_tray_test
