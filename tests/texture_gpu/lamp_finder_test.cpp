// The lamp, found by shadows that were computed ray by ray.
#include "texture_gpu/lamp/lamp_finder.hpp"

#include <gmock/gmock.h>

#include <random>

#include "tests/link/child.hpp"
#include "tests/support/lamp_light.hpp"
#include "tests/support/small_scene.hpp"

namespace foresight::lamp_finder_test {
namespace {

const Eigen::Vector3d kCamera(-1.0, -0.45, 0.8);

/// The block goes about above the table.
SceneState state_at(const SceneModel& scene, int i) {
  SceneState state = state_of(scene);
  Pose& block = state.T_world_node[kBlock];
  block.translation() = Eigen::Vector3d(-0.35 + 0.07 * (i % 11), -0.35 + 0.11 * (i % 7), 0.14 + 0.03 * (i % 3));
  block.rotate(Eigen::AngleAxisd(0.5 * i, Eigen::Vector3d::UnitZ()));
  return state;
}

struct Room {
  std::shared_ptr<const SceneModel> scene = small_scene();
  LampFinder finder{scene};
  std::mt19937 generator{7};
  std::deque<LampRecord> records = {};

  /// Of all that was shown; at most so many witnesses.
  LampQuestion question(std::size_t most = 12000) const {
    LampQuestion out{{finder.witnesses().begin(), finder.witnesses().end()}, records, finder.moving(), {}};
    out.witnesses.resize(std::min(most, out.witnesses.size()));
    for (LampRecord& record : out.records) record.log_brightness.resize(out.witnesses.size());
    return out;
  }

  /// `exposure`: a factor on the values of image i. `rays`: to so many points of each lamp.
  void show(int first, int last, const std::vector<Lamp>& lamps, double noise = 0.01, int rays = 16) {
    std::normal_distribution<double> normal(1, noise);
    for (int i = first; i < last; ++i) {
      const SceneState state = state_at(*scene, i);
      if (!finder.look(state)) continue;
      const reference::RayCaster caster(*scene, state);
      std::vector<Eigen::Vector3f> values;
      for (const Witness& w : finder.witnesses()) {
        Eigen::Vector3d n = w.normal.cast<double>();
        const Eigen::Vector3d p = w.point.cast<double>(), to_camera = kCamera - p;
        if (n.dot(to_camera) < 0) n = -n;
        const auto between = caster.cast(p + 1e-6 * n, to_camera, 1e-5);
        Eigen::Vector3d light = Eigen::Vector3d::Ones();
        for (const Lamp& lamp : lamps) light += lamp_light(lamp, caster, p, n, rays) - Eigen::Vector3d::Ones();
        const double exposure = 0.2 + 0.02 * (i % 4);
        const Eigen::Vector3d value = exposure * normal(generator) * light.array().pow(1 / kResponse);
        values.push_back(between && between->t < 1 ? Eigen::Vector3f::Constant(-1)
                                                   : Eigen::Vector3f(value.cast<float>()));
      }
      finder.add(state, kCamera, values);
      LampRecord& record = records.emplace_back(state.T_world_node);
      for (const Eigen::Vector3f& value : values)  // what was not seen is no number
        record.log_brightness.emplace_back(value.array().log().cast<Eigen::half>());
    }
  }
};

const Lamp kLamp{{0.3, 0.5, 1.3}, 0.1, {3.0, 2.5, 2.0}};

/// Between where a lamp is and where kLamp is, seen from the table.
double degrees_off(const Lamp& lamp) {
  const Eigen::Vector3d middle(0, 0, 0.1), to = lamp.position - middle, truly = kLamp.position - middle;
  return std::acos(to.normalized().dot(truly.normalized())) * 180 / M_PI;
}

TEST(LampFinder, FindsTheLampByTheShadowsOfWhatMoves) {
  Room room;
  room.show(0, 30, {kLamp});
  ASSERT_TRUE(room.finder.lamp()) << room.finder.answer().explained << " " << room.finder.answer().elsewhere;
  const Lamp& found = *room.finder.lamp();
  const Eigen::Vector3d middle(0, 0, 0.1), to = found.position - middle, truly = kLamp.position - middle;
  EXPECT_GT(to.normalized().dot(truly.normalized()), std::cos(4 * M_PI / 180)) << found.position.transpose();
  // On the table, what the lamp adds to all other light.
  for (int c = 0; c < 3; ++c)
    EXPECT_NEAR(found.strength[c] * to.z() / std::pow(to.norm(), 3) /
                    (kLamp.strength[c] * truly.z() / std::pow(truly.norm(), 3)),
                1, 0.25)
        << c;
  EXPECT_NEAR(found.radius / to.norm(), kLamp.radius / truly.norm(), 0.04);
}

TEST(LampFinder, FindsTheLampInTheFirstImagesByShadowsThatHardlyMove) {
  Room room;
  room.show(0, 4, {kLamp});
  ASSERT_TRUE(room.finder.lamp()) << room.finder.answer().still << " " << room.finder.answer().still_elsewhere;
  EXPECT_FALSE(room.finder.answer().told_by_what_moves);
  EXPECT_LT(degrees_off(*room.finder.lamp()), 8);
}

TEST(LampFinder, FindsTheLampBeforeWhatMayMoveHas) {
  std::vector<Node> nodes = small_scene()->nodes();
  nodes[kBlock].may_move = true;
  Room room{std::make_shared<const SceneModel>(nodes)};
  room.show(0, 1, {kLamp});
  EXPECT_FALSE(room.finder.lamp()) << "the answer comes some images later";
  for (int i = 0; i < 2; ++i) EXPECT_FALSE(room.finder.look(state_at(*room.scene, 0))) << "nothing new to be seen";
  ASSERT_TRUE(room.finder.lamp()) << room.finder.answer().still << " " << room.finder.answer().still_elsewhere;
  EXPECT_TRUE(room.finder.moving()[kBlock]);
  EXPECT_LT(degrees_off(*room.finder.lamp()), 8);
}

TEST(LampFinder, TakesAnAnswerThatIsNotAwaitedOnceItIsThere) {
  Room awaits, goes_on{.finder = LampFinder(small_scene(), false)};
  for (Room* room : {&awaits, &goes_on}) room->show(0, 2, {kLamp});
  const auto at_rest = [](Room& room) { return room.finder.look(state_at(*room.scene, 1)); };
  for (int i = 0; i < 2; ++i) at_rest(awaits);
  ASSERT_TRUE(awaits.finder.lamp());
  EXPECT_TRUE(comes_true([&] {
    at_rest(goes_on);
    return goes_on.finder.lamp().has_value();
  }));
  EXPECT_EQ(goes_on.finder.lamp(), awaits.finder.lamp());
}

TEST(LampFinder, AsksNothingAsLongAsNothingMayMoveOrHas) {
  Room room;
  for (int i = 0; i < 3; ++i) EXPECT_FALSE(room.finder.look(state_at(*room.scene, 0)));
  EXPECT_TRUE(room.finder.witnesses().empty());
}

TEST(LampFinder, SaysNothingOfSingleImagesThatShowPrintAlone) {
  Room room;
  room.show(0, 4, {}, 0.15);
  EXPECT_FALSE(room.finder.lamp()) << room.finder.answer().still << " " << room.finder.answer().still_elsewhere;
}

TEST(LampFinder, SaysNothingWhereNoShadowTellsOfALamp) {
  Room room;
  room.show(0, 30, {}, 0.04);
  EXPECT_FALSE(room.finder.lamp());
}

TEST(LampFinder, SaysNothingWhereSeveralLampsAreAsBright) {
  std::vector<Lamp> lamps;
  for (int i = 0; i < 4; ++i) lamps.push_back({{std::cos(1.6 * i), std::sin(1.6 * i), 1.2}, 0.05, {1, 1, 1}});
  Room room;
  room.show(0, 4, lamps, 0.01, 4);
  EXPECT_FALSE(room.finder.lamp()) << room.finder.answer().still << " " << room.finder.answer().still_elsewhere;
  room.show(4, 30, lamps, 0.01, 4);
  EXPECT_FALSE(room.finder.lamp()) << room.finder.answer().explained << " " << room.finder.answer().elsewhere;
}

TEST(LampFinder, FindsTheMainLampBesideAWeakerOne) {
  Room room;
  room.show(0, 10, {kLamp, {{-0.8, -0.2, 1.2}, 0.05, {0.5, 0.5, 0.5}}}, 0.01, 4);
  ASSERT_TRUE(room.finder.lamp()) << room.finder.answer().explained << " " << room.finder.answer().elsewhere;
  EXPECT_LT(degrees_off(*room.finder.lamp()), 8);
}

TEST(LampFinder, SaysNothingWhereTwoLampsAreAsBright) {
  Room room;
  room.show(0, 10, {{{0.6, 0.6, 1.2}, 0.05, {1.5, 1.5, 1.5}}, {{-0.8, 0.1, 1.2}, 0.05, {1.5, 1.5, 1.5}}}, 0.01, 4);
  EXPECT_FALSE(room.finder.lamp()) << room.finder.answer().explained << " " << room.finder.answer().elsewhere;
}

TEST(LampFinder, OneSearchThatFindsAnotherLampTakesNoneAway) {
  Room room;
  room.show(0, 8, {kLamp, {{-0.8, -0.2, 1.2}, 0.05, {1.5, 1.5, 1.5}}}, 0.01, 4);
  const ShadowRays rays(*room.scene);
  LampQuestion question = room.question();
  question.last.lamp = kLamp;
  LampAnswer answer = find_lamp(rays, question);
  EXPECT_TRUE(answer.several);
  EXPECT_EQ(answer.lamp, kLamp);
  question.last.several = true;
  answer = find_lamp(rays, question);
  EXPECT_TRUE(answer.several);
  EXPECT_FALSE(answer.lamp);
}

TEST(LampFinder, WhatMovesTellsThatThereIsNoSecondLamp) {
  Room room;
  room.show(0, 20, {kLamp}, 0.01, 4);
  const ShadowRays rays(*room.scene);
  // Dark where another lamp would throw shadows of what stands still: print, or corners. Where it is darker than the
  // lamp's own shadows, that other lamp would be the stronger one.
  std::vector<bool> still = room.finder.moving();
  still.flip();
  const ShadowRays::Posed posed = rays.pose(room.records[0].T_world_node, still);
  for (const float darker : {0.2f, 0.6f}) {
    LampQuestion question = room.question();
    for (std::size_t i = 0; i < question.witnesses.size(); ++i)
      if (posed.blocked(question.witnesses[i].point.cast<double>(), {-0.8, -0.2, 1.2}, ShadowRays::kContact))
        for (LampRecord& record : question.records) record.log_brightness[i].array() -= Eigen::half(darker);
    const LampAnswer answer = find_lamp(rays, question);
    EXPECT_FALSE(answer.several) << darker << ": " << answer.explained << " " << answer.still << " " << answer.dark;
    EXPECT_TRUE(answer.told_by_what_moves) << darker << ": " << answer.explained << " " << answer.elsewhere;
  }
}

TEST(ShadowRays, WaysOfAPacketAreBlockedAsEachIsAlone) {
  const auto scene = small_scene();
  const ShadowRays rays(*scene);
  const SceneState state = state_at(*scene, 0);
  const ShadowRays::Posed posed = rays.pose(state.T_world_node, std::vector<bool>(state.T_world_node.size(), true));
  std::mt19937 generator{3};
  std::uniform_real_distribution<float> aside(-0.5f, 0.5f);
  int blocked = 0;
  for (int i = 0; i < 100; ++i) {
    ShadowRays::Points from, to;
    for (int k = 0; k < ShadowRays::kPacket; ++k) {
      from.col(k) << aside(generator), aside(generator), 0.01f;
      to.col(k) << aside(generator), aside(generator), 1.2f;
    }
    to.col(5) = from.col(5);
    const int count = i % (ShadowRays::kPacket + 1);
    const unsigned together = posed.blocked(from, to, count);
    for (int k = 0; k < ShadowRays::kPacket; ++k) {
      const bool alone = posed.blocked(from.col(k).cast<double>(), to.col(k).cast<double>());
      EXPECT_EQ(together >> k & 1u, k < count && alone) << i << ", " << k;
      blocked += alone;
    }
  }
  EXPECT_THAT(blocked, testing::AllOf(testing::Gt(20), testing::Lt(600)));
}

TEST(LampFinder, AFewDarkPointsDoNotOutweighSingleImages) {
  Room room;
  room.show(0, 3, {kLamp}, 0.05);
  const ShadowRays rays(*room.scene);
  LampQuestion question = room.question();
  const LampRecord &before = room.records[0], &after = room.records[1];
  // The block has moved on; where its shadow was or is, is not seen now, but a stain that another lamp would explain.
  LampRecord stained = before;
  stained.T_world_node = after.T_world_node;
  const Eigen::Vector3f stain(-0.1f, -0.05f, 0);
  int dark = 0;
  for (std::size_t i = 0; i < question.witnesses.size(); ++i) {
    if (!before.knows(i)) continue;
    if (!after.knows(i) || std::abs(luma_of(after.value(i) - before.value(i))) > 0.1f)
      stained.log_brightness[i].setConstant(Eigen::half(NAN));
    else if ((question.witnesses[i].point - stain).norm() < 0.05f)
      stained.log_brightness[i].array() -= Eigen::half(0.6f), ++dark;
  }
  question.records = {before, before, before, before, before, stained};
  ASSERT_GT(dark, 8);
  const LampAnswer answer = find_lamp(rays, question);
  EXPECT_EQ(answer.dark, dark);
  EXPECT_GT(answer.still, 0.3) << "the best lamp is the one that single images show";
}

TEST(LampFinder, FindsALampAgainWhereOthersExplainNearlyAsMuch) {
  Room room;
  room.show(0, 5, {kLamp}, 0.06, 4);
  const ShadowRays rays(*room.scene);
  LampQuestion question = room.question();
  EXPECT_FALSE(find_lamp(rays, question).told_by_what_moves);
  question.last.lamp = kLamp;
  const LampAnswer answer = find_lamp(rays, question);
  EXPECT_FALSE(answer.several);
  EXPECT_TRUE(answer.told_by_what_moves) << answer.explained << " " << answer.elsewhere;
}

TEST(LampFinder, KeepsALampWhoseShadowsOthersExplainToo) {
  Room room;
  room.show(0, 3, {kLamp}, 0.01, 4);
  const ShadowRays rays(*room.scene);
  LampQuestion question = room.question();
  const LampRecord &before = room.records[0], &after = room.records[1];
  question.records = {before, before, before, before, before, after};  // one shadow
  EXPECT_FALSE(find_lamp(rays, question).told_by_what_moves);
  question.last.lamp = kLamp;
  question.last.told_by_what_moves = true;
  const LampAnswer answer = find_lamp(rays, question);
  EXPECT_LT(answer.explained, 1.25 * answer.elsewhere);
  EXPECT_TRUE(answer.lamp) << answer.explained << " " << answer.elsewhere << " dark " << answer.dark;
}

TEST(LampFinder, LooksNoFurtherThanTheKnownLampWhereThatStillExplainsAsMuch) {
  Room room;
  room.show(0, 10, {kLamp});
  const ShadowRays rays(*room.scene);
  LampQuestion question = room.question();
  question.last = {.lamp = kLamp, .told_by_what_moves = true, .explained = 0.8, .elsewhere = 0.123};
  question.last.lamp->position += Eigen::Vector3d(0.05, -0.04, 0.06);
  question.all_around = false;
  const LampAnswer near = find_lamp(rays, question);
  ASSERT_TRUE(near.lamp);
  EXPECT_EQ(near.elsewhere, 0.123) << "what other places explain is not asked";
  EXPECT_LT(degrees_off(*near.lamp), degrees_off(*question.last.lamp));

  question.all_around = true;
  EXPECT_NE(find_lamp(rays, question).elsewhere, 0.123);

  question.all_around = false;
  question.last.lamp->position = Eigen::Vector3d(-0.8, -0.2, 1.2);  // somebody has moved it since
  const LampAnswer moved = find_lamp(rays, question);
  ASSERT_TRUE(moved.lamp);
  EXPECT_LT(degrees_off(*moved.lamp), 4);
}

TEST(LampFinder, LooksNoFurtherThanTheLampOfSingleImagesWhereTheseStillTellIt) {
  Room room;
  room.show(0, 2, {kLamp});
  const ShadowRays rays(*room.scene);
  LampQuestion question = room.question();
  question.last = find_lamp(rays, question);
  ASSERT_TRUE(question.last.lamp);
  EXPECT_FALSE(question.last.told_by_what_moves);
  question.last.still_elsewhere = 0.0123;
  question.all_around = false;
  const LampAnswer near = find_lamp(rays, question);
  ASSERT_TRUE(near.lamp);
  EXPECT_EQ(near.still_elsewhere, 0.0123) << "what other places explain is not asked";
  EXPECT_LT(degrees_off(*near.lamp), 8);

  question.last.still *= 2;  // it explained more before
  EXPECT_NE(find_lamp(rays, question).still_elsewhere, 0.0123);
}

TEST(LampFinder, AFewPointsDoNotTellThatALampIsOff) {
  Room room;
  room.show(0, 10, {});
  const ShadowRays rays(*room.scene);
  for (const std::size_t points : {200, 12000}) {
    LampQuestion question = room.question(points);
    question.last.lamp = kLamp;
    question.last.told_by_what_moves = true;
    EXPECT_EQ(find_lamp(rays, question).lamp.has_value(), points == 200);
  }
}

TEST(LampFinder, ForgetsALampThatIsSwitchedOffWithinAFewImages) {
  Room room;
  room.show(0, 30, {kLamp});
  ASSERT_TRUE(room.finder.lamp());
  room.show(30, 36, {});
  EXPECT_FALSE(room.finder.lamp());
  room.show(36, 60, {});
  EXPECT_FALSE(room.finder.lamp());
}

TEST(LampFinder, FindsTheLampThatTookThePlaceOfAnother) {
  Room room;
  room.show(0, 30, {{{-0.9, -0.4, 1.2}, 0.1, {3.0, 2.5, 2.0}}});
  ASSERT_TRUE(room.finder.lamp());
  EXPECT_GT(degrees_off(*room.finder.lamp()), 40);
  room.show(30, 42, {kLamp});
  ASSERT_TRUE(room.finder.lamp());
  EXPECT_LT(degrees_off(*room.finder.lamp()), 8);
}

// Half as strong, it still throws the shadows that are foretold.
TEST(LampFinder, KeepsALampThatIsDimmed) {
  Room room;
  room.show(0, 30, {kLamp});
  Lamp dimmed = kLamp;
  dimmed.strength *= 0.6;
  for (int i = 30; i < 60; ++i) {
    room.show(i, i + 1, {dimmed});
    EXPECT_TRUE(room.finder.lamp()) << i;
  }
}

TEST(LampFinder, AsksNothingWhereNothingMoves) {
  Room room;
  const SceneState still = state_of(*room.scene);
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(room.finder.look(still));
  EXPECT_THAT(room.finder.witnesses(), testing::IsEmpty());
}

TEST(LampFinder, AsksOnlyAboutWhatStandsStill) {
  Room room;
  room.finder.look(state_at(*room.scene, 0));
  EXPECT_TRUE(room.finder.look(state_at(*room.scene, 1)));
  EXPECT_GT(room.finder.witnesses().size(), 1000u);
  for (const Witness& w : room.finder.witnesses()) EXPECT_NE(w.node, kBlock);
  EXPECT_THAT(room.finder.moving(), testing::ElementsAre(false, false, true, false));
}

}  // namespace
}  // namespace foresight::lamp_finder_test
