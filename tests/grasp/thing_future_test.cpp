#include "prediction/grasp/thing_future.hpp"

#include <random>

#include "common/error.hpp"
#include "tests/dynamics/solids.hpp"

namespace foresight::thing_future_test {
namespace {

constexpr double kPicture = 1.0 / 60;
constexpr float kSide = 0.045f;

/// A table, a hand of two jaws and a block, as the model has them; another block and a ball beside.
class Bench {
 public:
  explicit Bench(double block_y = 0) {
    const auto node = [&](const char* name, const Mesh& mesh, const Pose& pose, bool driven = false) {
      nodes_.push_back({name, mesh, -1, pose, driven});
    };
    node("table", box_mesh({1, 1, 0.1f}, {0, 0, -0.05f}), Pose::Identity());
    node("left", box_mesh({0.02f, 0.01f, 0.06f}, {0, 0.005f, 0}), Pose::Identity(), true);
    node("right", box_mesh({0.02f, 0.01f, 0.06f}, {0, -0.005f, 0}), Pose::Identity(), true);
    node("block", box_mesh({kSide, kSide, kSide}), lifted(0, block_y, kSide / 2));
    node("other", box_mesh({kSide, kSide, kSide}), lifted(0.3, 0, kSide / 2));
    node("ball", ball_mesh(0.03f), lifted(-0.3, 0, 0.03));
    ThingFutureOptions options;
    options.jaws = {"grip"};
    options.things = {{"block", 0.1, {.friction = 0.7}},
                      {"other", 0.1, {.friction = 0.7}},
                      {"ball", 0.05, {.friction = 0.7, .rolling = 2e-4}}};
    future = std::make_unique<ThingFuture>(SceneModel(nodes_), poses(), options, now, joints());
  }

  static PartPoses poses() {
    return [](const JointPositions& q) {
      std::vector<Pose> out(6, Pose::Identity());
      const double grip = q("grip").value_or(0.04);
      out[1] = lifted(q("along").value_or(0), grip, q("height").value_or(0.03));
      out[2] = lifted(q("along").value_or(0), -grip, q("height").value_or(0.03));
      return out;
    };
  }
  JointPositions joints() const {
    return [g = grip, h = height, a = along](std::string_view name) -> std::optional<double> {
      return name == "grip" ? g : name == "height" ? h : a;
    };
  }
  Pose hand() const { return lifted(along, 0, height); }

  /// Moves what it refers to to `to`, picture by picture; `each` is called after each.
  void move(double& what, double to, double seconds_, const std::function<void()>& each = {}) {
    const double from = what;
    const int pictures = static_cast<int>(std::lround(seconds_ / kPicture));
    for (int i = 1; i <= pictures; ++i) {
      what = from + (to - from) * i / pictures;
      const Pose before = block().T_world_thing;
      now = now + seconds(kPicture);
      future->advance(now, joints());
      largest_step = std::max(largest_step, (block().T_world_thing.translation() - before.translation()).norm());
      if (each) each();
    }
  }
  void wait(double seconds_, const std::function<void()>& each = {}) { move(height, height, seconds_, each); }
  PredictedThing block() const { return future->thing(0); }
  Eigen::Vector3d place(std::size_t thing = 0) const { return future->thing(thing).T_world_thing.translation(); }
  void grasp_and_lift() {
    wait(0.2);
    move(grip, 0.015, 1);
    move(height, 0.18, 1);
  }

  double grip = 0.04, height = 0.03, along = 0, largest_step = 0;
  RobotTime now{1'000'000'000};
  std::unique_ptr<ThingFuture> future;

 private:
  std::vector<Node> nodes_;
};

/// Sightings of the block by a camera, at the line's far end.
class Camera {
 public:
  explicit Camera(Bench& bench, double delay = 0.5) : bench_(bench), delay_(delay) {}
  std::function<Pose()> truth;
  double sigma = 0.0015;
  SightingResult last = SightingResult::taken;
  int moved = 0;

  void operator()() {
    if (bench_.now >= next_) {
      next_ = bench_.now + seconds(0.1);
      ThingSighting sighting{0, bench_.now, truth(), sigma, 0.0175};
      std::normal_distribution<double> noise(0, sigma);
      for (int k = 0; k < 3; ++k) sighting.T_world_thing.translation()[k] += noise(random_);
      under_way_.push_back(sighting);
    }
    for (; !under_way_.empty() && under_way_.front().captured + seconds(delay_) <= bench_.now; under_way_.pop_front()) {
      last = bench_.future->correct(under_way_.front());
      moved += last == SightingResult::moved ? 1 : 0;
    }
  }

 private:
  Bench& bench_;
  double delay_;
  RobotTime next_;
  std::deque<ThingSighting> under_way_;
  std::mt19937 random_{7};
};

TEST(ThingFuture, WhatTheJawsCloseAroundGoesWithTheHandAtOnce) {
  Bench bench(0.004);
  EXPECT_EQ(bench.block().status, ThingStatus::predicted) << "no camera has seen it yet";
  bench.wait(0.2);
  bench.move(bench.grip, 0.015, 1);
  EXPECT_EQ(bench.block().status, ThingStatus::carried);
  EXPECT_NEAR(bench.place().y(), 0, 1e-3) << "the jaws pushed it to their middle";
  const Eigen::Vector3d in_hand = bench.place() - bench.hand().translation();
  bench.move(bench.height, 0.2, 1, [&] {
    EXPECT_LT((bench.place() - bench.hand().translation() - in_hand).norm(), 2e-3) << "a step of 4 ms behind, at most";
  });
  bench.move(bench.along, 0.2, 1);
  bench.wait(0.1);
  EXPECT_LT((bench.place() - bench.hand().translation() - in_hand).norm(), 1e-9);
  const std::vector<Pose> poses = bench.future->poses();
  EXPECT_NEAR(poses[1].translation().y(), kSide / 2, 2e-3) << "jaws are shown at the block, not in it";
}

TEST(ThingFuture, WhatIsLetGoFallsAndComesToRest) {
  Bench bench;
  bench.grasp_and_lift();
  ASSERT_EQ(bench.block().status, ThingStatus::carried);
  bool fell = false;
  bench.move(bench.grip, 0.04, 0.6, [&] { fell = fell || bench.block().status == ThingStatus::falling; });
  bench.wait(1.5, [&] { fell = fell || bench.block().status == ThingStatus::falling; });
  EXPECT_TRUE(fell);
  EXPECT_EQ(bench.block().status, ThingStatus::predicted);
  EXPECT_NEAR(bench.place().z(), kSide / 2, 2e-3);
  EXPECT_GT(bench.block().sigma, 0.01) << "not yet seen there";
  Camera camera(bench);
  camera.truth = [T = bench.block().T_world_thing] { return T * lifted(0.01, 0.005, 0); };
  bench.wait(2, [&] { camera(); });
  EXPECT_EQ(bench.block().status, ThingStatus::seen);
  EXPECT_LT((bench.place() - camera.truth().translation()).norm(), 1.5e-3);
  EXPECT_LT(bench.block().sigma, 0.001);
}

TEST(ThingFuture, PushedThingsMoveAndBallsRoll) {
  Bench bench;
  bench.move(bench.along, -0.15, 0.5);
  bench.grip = 0.008;
  bench.wait(0.2);
  bench.move(bench.along, -0.32, 0.6);
  const double pushed = bench.place(2).x();
  EXPECT_LT(pushed, -0.34);
  EXPECT_EQ(bench.future->thing(2).status, ThingStatus::falling);
  bench.wait(0.3);
  EXPECT_LT(bench.place(2).x(), pushed - 0.01) << "it rolls on";
  EXPECT_LT((bench.place(1) - Eigen::Vector3d(0.3, 0, kSide / 2)).norm(), 1e-6);
}

TEST(ThingFuture, SightingsSetRightWhereAThingStandsWithoutAJump) {
  Bench bench;
  Camera camera(bench, 0.8);
  camera.truth = [] { return lifted(0.007, -0.006, kSide / 2); };
  double worst = 0;
  bench.wait(4, [&] {
    camera();
    worst = std::max(worst, (bench.place() - camera.truth().translation()).norm());
  });
  EXPECT_LT(worst, 0.0105) << "never farther off than at first, though corrections are late";
  EXPECT_LT((bench.place() - camera.truth().translation()).norm(), 1e-3);
  EXPECT_LT(bench.largest_step, 0.0013 + 0.0005);
  EXPECT_EQ(bench.block().status, ThingStatus::seen);
}

TEST(ThingFuture, InTheHandItsPlaceThereIsWhatIsSetRight) {
  Bench bench;
  Camera camera(bench);
  camera.truth = [&] {
    return bench.height > 0.031 || bench.grip < 0.022 ? Pose(bench.hand() * lifted(0.004, 0, -0.0075))
                                                      : lifted(0.004, 0, kSide / 2);
  };
  bench.grasp_and_lift();
  const double before = (bench.place() - camera.truth().translation()).norm();
  EXPECT_GT(before, 0.003);
  bench.move(bench.along, 0.3, 2, [&] { camera(); });
  bench.wait(0.3, [&] { camera(); });
  EXPECT_EQ(bench.block().status, ThingStatus::carried);
  EXPECT_LT((bench.place() - camera.truth().translation()).norm(), 1.5e-3);
  EXPECT_EQ(camera.moved, 0);
}

TEST(ThingFuture, AGraspThatFailedIsNoticedAndTheThingPutWhereItIsSeen) {
  Bench bench;
  Camera camera(bench);
  camera.truth = [] { return lifted(0, 0, kSide / 2); };
  bench.wait(1, [&] { camera(); });
  bench.move(bench.grip, 0.015, 1, [&] { camera(); });
  ASSERT_EQ(bench.block().status, ThingStatus::carried);
  // In reality it stays; it is seen 10 mm from the hand from here on.
  std::optional<RobotTime> visible, noticed, back;
  bench.move(bench.height, 0.18, 2, [&] {
    camera();
    const double off = (bench.place() - camera.truth().translation()).norm();
    if (off > 0.01 && !visible) visible = bench.now;
    if (camera.moved > 0 && !noticed) noticed = bench.now;
    if (noticed && off < 0.005 && !back) back = bench.now;
  });
  bench.wait(1, [&] { camera(); });
  ASSERT_TRUE(visible && noticed && back);
  EXPECT_LE(to_seconds(*noticed - *visible), 0.5 + 0.3);
  EXPECT_LE(to_seconds(*back - *noticed), 0.3);
  EXPECT_EQ(bench.future->failed_grasps(), 1u);
  EXPECT_EQ(bench.block().status, ThingStatus::seen);
  EXPECT_LT((bench.place() - camera.truth().translation()).norm(), 2e-3);
  bench.move(bench.grip, 0.04, 0.5, [&] { camera(); });
  bench.wait(0.5, [&] { camera(); });
  EXPECT_EQ(camera.moved, 1) << "once is enough";
}

TEST(ThingFuture, WhatWasTakenForLostAndGoesWithTheHandIsTakenBack) {
  Bench bench;
  Camera camera(bench);
  Pose T_hand_block = Pose::Identity();
  camera.truth = [&] { return bench.height > 0.031 ? Pose(bench.hand() * T_hand_block) : lifted(0, 0, kSide / 2); };
  T_hand_block.translation().z() = kSide / 2 - 0.03;
  bench.wait(0.5, [&] { camera(); });
  bench.move(bench.grip, 0.015, 1, [&] { camera(); });
  bench.move(bench.height, 0.18, 1, [&] { camera(); });
  ASSERT_EQ(bench.block().status, ThingStatus::carried);
  // Two pictures that were misread, alike, while the hand goes on.
  const RobotTime begin = bench.now;
  bool back = false;
  int asked = 0;
  camera.truth = [&] {
    const double t = to_seconds(bench.now - begin);
    return t > 0.3 && t < 0.52 ? lifted(0.1, 0.1, kSide / 2) : Pose(bench.hand() * T_hand_block);
  };
  bench.move(bench.along, -0.22, 2.2, [&] {
    camera();
    back = back || camera.last == SightingResult::taken_back;
    const auto in_hand = bench.future->if_still_in_hand(0, bench.now, bench.joints());
    EXPECT_EQ(in_hand.has_value(), !bench.block().held);
    if (in_hand) {
      EXPECT_LT((in_hand->translation() - (bench.hand() * T_hand_block).translation()).norm(), 3e-3);
    }
    asked += in_hand ? 1 : 0;
  });
  EXPECT_GE(camera.moved, 1);
  EXPECT_GE(asked, 1);
  EXPECT_TRUE(back);
  bench.wait(0.5, [&] { camera(); });
  EXPECT_EQ(bench.block().status, ThingStatus::carried);
  EXPECT_LT((bench.place() - camera.truth().translation()).norm(), 3e-3);
  bench.move(bench.grip, 0.04, 0.6);
  bench.wait(1.5);
  EXPECT_NEAR(bench.place().z(), kSide / 2, 3e-3) << "opened jaws let it go, as ever";
  EXPECT_FALSE(bench.future->if_still_in_hand(0, bench.now - seconds(2), bench.joints()))
      << "in it by what is known of then, or out of opened jaws";
}

TEST(ThingFuture, WhatWasPushedAsideBeforeTheJawsClosedIsInTheHandAsMuchAside) {
  Bench bench;
  Camera camera(bench, 1.2);
  const Pose aside = lifted(0.012, 0, kSide / 2);
  bool pushed = false;
  camera.truth = [&] {
    if (!pushed) return lifted(0, 0, kSide / 2);
    return bench.height > 0.031 ? Pose(bench.hand() * lifted(0, 0, -0.03) * aside) : aside;
  };
  bench.wait(2, [&] { camera(); });
  pushed = true;
  bench.move(bench.grip, 0.015, 1, [&] { camera(); });
  ASSERT_EQ(bench.block().status, ThingStatus::carried);
  EXPECT_EQ(camera.moved, 0) << "images of it come later";
  bench.move(bench.height, 0.18, 2, [&] {
    camera();
    EXPECT_TRUE(bench.block().held);
  });
  EXPECT_EQ(camera.moved, 1);
  EXPECT_EQ(bench.future->failed_grasps(), 0u);
  EXPECT_EQ(bench.block().status, ThingStatus::carried);
  EXPECT_LT((bench.place() - camera.truth().translation()).norm(), 3e-3);
}

TEST(ThingFuture, WhatWasPushedOutOfTheJawsIsNotInTheHand) {
  Bench bench;
  Camera camera(bench, 1.2);
  bool pushed = false;
  camera.truth = [&] { return lifted(pushed ? 0.05 : 0, 0, kSide / 2); };
  bench.wait(2, [&] { camera(); });
  pushed = true;
  bench.move(bench.grip, 0.015, 1, [&] { camera(); });
  ASSERT_EQ(bench.block().status, ThingStatus::carried);
  bench.move(bench.height, 0.18, 1, [&] { camera(); });
  EXPECT_FALSE(bench.block().held);
  EXPECT_EQ(bench.future->failed_grasps(), 1u);
  EXPECT_LT((bench.place() - camera.truth().translation()).norm(), 3e-3);
}

TEST(ThingFuture, WhatTheHandPushesIsNotTakenIntoIt) {
  Bench bench;
  Camera camera(bench);
  bench.move(bench.along, -0.15, 0.5);
  bench.grip = 0.008;
  bench.wait(0.2);
  camera.truth = [&] { return lifted(std::max(0.0, bench.along + 0.04), 0, kSide / 2); };
  bench.move(bench.along, 0.3, 3, [&] {
    camera();
    EXPECT_NE(camera.last, SightingResult::taken_back);
    EXPECT_NE(bench.block().status, ThingStatus::carried);
  });
}

TEST(ThingFuture, WhatStandsOnAThingFallsWhenTheHandPushesThatAway) {
  Bench bench;
  bench.wait(0.2);
  for (int i = 0; i < 2; ++i) {
    bench.wait(0.1);
    bench.future->correct({1, bench.now, lifted(0, 0, 1.5 * kSide), 0.0015, 0.02});
  }
  bench.move(bench.along, -0.15, 0.5);
  bench.grip = 0.008;
  bench.wait(0.5);
  EXPECT_NEAR(bench.place(1).z(), 1.5 * kSide, 1e-3);
  bench.height = 0.02;
  bench.move(bench.along, 0.15, 0.3);
  bench.wait(1);
  EXPECT_GT(bench.place(0).x(), 0.1);
  EXPECT_NEAR(bench.place(1).z(), kSide / 2, 3e-3);
}

TEST(ThingFuture, OneWrongSightingMovesNothing) {
  Bench bench;
  Camera camera(bench);
  camera.truth = [] { return lifted(0, 0, kSide / 2); };
  bench.wait(2, [&] { camera(); });
  const Eigen::Vector3d before = bench.place();
  EXPECT_EQ(bench.future->correct({0, bench.now, lifted(0.4, 0, 0.1), 0.0015, 0.02}), SightingResult::doubted);
  EXPECT_EQ(bench.block().status, ThingStatus::unsure);
  EXPECT_EQ(bench.place(), before);
  bench.wait(1, [&] { camera(); });
  EXPECT_EQ(bench.block().status, ThingStatus::seen);
  EXPECT_LT((bench.place() - before).norm(), 2e-3);
  EXPECT_EQ(bench.future->failed_grasps(), 0u);
}

TEST(ThingFuture, WhatIsTakenAwayIsShownThereAtTheSecondLook) {
  Bench bench;
  Camera camera(bench);
  camera.truth = [] { return lifted(0, 0, kSide / 2); };
  bench.wait(1, [&] { camera(); });
  const auto look = [&](double x) {
    bench.wait(0.1);
    return bench.future->correct({0, bench.now, lifted(x, 0, 0.1), 0.0015, 0.02});
  };
  EXPECT_EQ(look(0), SightingResult::doubted) << "lifted by 77 mm";
  EXPECT_EQ(look(0.1), SightingResult::moved) << "at 1 m/s";
  bench.wait(0.4);
  EXPECT_NEAR(bench.place().x(), 0.1, 1e-3);
}

TEST(ThingFuture, WhatFellOffTheTableIsShownBelowItAtTheSecondLook) {
  Bench bench;
  bench.wait(0.5);
  const auto look = [&](double z) {
    bench.wait(0.1);
    return bench.future->correct({0, bench.now, lifted(0, 0, z), 0.0015, 0.02});
  };
  EXPECT_EQ(look(-0.28), SightingResult::doubted);
  EXPECT_EQ(look(-0.56), SightingResult::moved) << "at 2.8 m/s, which falling things reach in 0.4 m";
}

TEST(ThingFuture, WhatMovesIsComparedWithWhereItsMotionCanHaveBroughtIt) {
  Bench bench;
  bench.grasp_and_lift();
  const Pose let_go = bench.block().T_world_thing;
  std::vector<SightingResult> results;
  bool fell = false;
  int picture = 0;
  bench.move(bench.grip, 0.04, 0.6, [&] {
    fell = fell || bench.block().status == ThingStatus::falling;
    if (!fell || picture++ % 2 != 0 || results.size() == 3) return;
    const Pose seen = results.empty() ? let_go : lifted(0.3, 0, kSide / 2);
    results.push_back(bench.future->correct({0, bench.now, seen, 0.0015, 0.02}));
  });
  EXPECT_EQ(results, (std::vector{SightingResult::in_motion, SightingResult::doubted, SightingResult::moved}))
      << "it may not have begun to fall; but it is not elsewhere";
  bench.wait(0.4);
  EXPECT_NEAR(bench.place().x(), 0.3, 2e-3);
}

TEST(ThingFuture, TwoPlacesThatNoThingGoesBetweenAreMistakes) {
  Bench bench;
  bench.wait(0.5);
  const Eigen::Vector3d before = bench.place();
  const auto look = [&](double x) {
    bench.wait(0.1);
    return bench.future->correct({0, bench.now, lifted(x, 0, 0.1), 0.0015, 0.02});
  };
  EXPECT_EQ(look(0.3), SightingResult::doubted);
  EXPECT_EQ(look(-0.3), SightingResult::doubted) << "at 6 m/s";
  EXPECT_EQ(bench.place(), before);
}

TEST(ThingFuture, WhatDoesNotExistIsInNoHand) {
  Bench bench;
  bench.grasp_and_lift();
  ASSERT_EQ(bench.block().status, ThingStatus::carried);
  for (int i = 0; i < 3; ++i) {
    bench.future->absent(0, bench.now);
    bench.wait(0.1);
  }
  EXPECT_EQ(bench.block().status, ThingStatus::unsure);
  EXPECT_TRUE(std::isinf(bench.block().sigma));
  EXPECT_EQ(bench.future->failed_grasps(), 1u);
  const Eigen::Vector3d there = bench.place();
  bench.move(bench.along, 0.2, 0.5);
  EXPECT_LT((bench.place() - there).norm(), 1e-6);
  EXPECT_EQ(bench.future->correct({0, bench.now, lifted(0.1, 0.1, kSide / 2), 0.0015, 0.02}), SightingResult::moved);
  bench.wait(0.5);
  EXPECT_EQ(bench.block().status, ThingStatus::seen);
  EXPECT_LT((bench.place() - Eigen::Vector3d(0.1, 0.1, kSide / 2)).norm(), 1e-3);
}

TEST(ThingFuture, RefusesWhatIsNoSighting) {
  Bench bench;
  bench.wait(0.5);
  const Pose there = lifted(0, 0, kSide / 2);
  Pose bent = there;
  bent.linear() *= 2;
  EXPECT_EQ(bench.future->correct({7, bench.now, there, 0.001, 0.01}), SightingResult::not_a_thing);
  EXPECT_EQ(bench.future->correct({0, bench.now, lifted(std::nan(""), 0, 0), 0.001, 0.01}), SightingResult::not_a_pose);
  EXPECT_EQ(bench.future->correct({0, bench.now, bent, 0.001, 0.01}), SightingResult::not_a_pose);
  EXPECT_EQ(bench.future->correct({0, bench.now, there, 0, 0.01}), SightingResult::not_a_pose);
  EXPECT_EQ(bench.future->correct({0, bench.now, there, 0.001, std::nan("")}), SightingResult::not_a_pose);
  EXPECT_EQ(bench.future->correct({0, bench.now + std::chrono::seconds(1), there, 0.001, 0.01}),
            SightingResult::not_known);
  EXPECT_EQ(bench.future->correct({0, RobotTime{}, there, 0.001, 0.01}), SightingResult::not_known);
  bench.future->absent(7, bench.now);
  EXPECT_LT((bench.place() - there.translation()).norm(), 1e-6);
  const Eigen::Vector3d before = bench.place();
  bench.grip = bench.height = std::nan("");
  bench.wait(0.2);
  EXPECT_EQ(bench.place(), before) << "joints that are not numbers move nothing";
}

TEST(ThingFuture, TakesScenesWithoutThingsAndRefusesThingsWithoutAScene) {
  const SceneModel model({{"table", box_mesh({1, 1, 0.1f}), -1, Pose::Identity()}});
  const PartPoses poses = [](const JointPositions&) { return std::vector<Pose>(1, Pose::Identity()); };
  const JointPositions none = [](std::string_view) { return std::nullopt; };
  ThingFuture future(model, poses, {}, RobotTime{}, none);
  future.advance(RobotTime{} + std::chrono::seconds(5), none);
  EXPECT_EQ(future.size(), 0u);
  EXPECT_EQ(future.poses().size(), 1u);
  ThingFutureOptions options;
  options.things = {{"unicorn", 1, {}}};
  EXPECT_THROW(ThingFuture(model, poses, options, RobotTime{}, none), InputError);
  options.things = {{"table", 1, {}}, {"table", 1, {}}};
  EXPECT_THROW(ThingFuture(model, poses, options, RobotTime{}, none), InputError);
  options.things = {{"table", std::nan(""), {}}};
  EXPECT_THROW(ThingFuture(model, poses, options, RobotTime{}, none), InputError);
}

TEST(ThingFuture, RepeatsBitForBit) {
  const auto film = [] {
    Bench bench(0.003);
    Camera camera(bench);
    camera.truth = [] { return lifted(0.003, 0.001, kSide / 2); };
    bench.wait(1, [&] { camera(); });
    bench.grasp_and_lift();
    bench.move(bench.grip, 0.04, 0.5);
    bench.wait(1);
    return bench.place();
  };
  EXPECT_EQ(film(), film());
}

}  // namespace
}  // namespace foresight::thing_future_test
