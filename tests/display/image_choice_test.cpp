#include "display/image_choice.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <map>

namespace foresight::image_choice_test {
namespace {

struct Taken {
  double x, age;       // m to the right; s
  double thing_x = 0;  // m, of a node
  bool lit = false;    // shadows are taken out of it
};

std::shared_ptr<PublishedImage> image(const Taken& taken) {
  auto out = std::make_shared<PublishedImage>();
  out->image.time = RobotTime{} + seconds(100 - taken.age);
  out->image.T_world_camera = Eigen::Translation3d(taken.x, 0, 0);
  out->image.scene.T_world_node = {Pose(Eigen::Translation3d(taken.thing_x, 0, 1))};
  if (taken.lit) out->light = std::make_shared<const SceneLight>();
  return out;
}

/// Of things a metre away; the first is the newest.
class Images {
 public:
  Images(std::initializer_list<Taken> all) {
    for (const Taken& taken : all) {
      const auto one = image(taken);
      place_[one.get()] = static_cast<int>(place_.size());
      if (lent_.newest)
        lent_.others.emplace_back(one);
      else
        lent_.newest = Lease<PublishedImage>(one);
    }
  }
  std::vector<ChosenImage> chosen(double x) const { return choose_images(lent_, Pose(Eigen::Translation3d(x, 0, 0))); }
  std::vector<int> order(double x) const {
    std::vector<int> out;
    for (const ChosenImage& one : chosen(x)) out.push_back(place_.at(one.image));
    return out;
  }
  int place(const PublishedImage* one) const { return place_.at(one); }

 private:
  NewestImages lent_;
  std::map<const PublishedImage*, int> place_;
};

using Order = std::vector<int>;

TEST(ImageChoice, TheOneFromTheEyesSideIsDrawnLast) {
  const Images all{{0.3, 0}, {0.2, 0.1}, {0, 0.5}};
  EXPECT_EQ(all.order(0.35), Order{}) << "the others are worse";
  EXPECT_EQ(all.order(0.02), (Order{1, 2}));
}

TEST(ImageChoice, TheRightEyeHasItsOwnImage) {
  const Images pair{{0, 0}, {0.065, 0}};
  EXPECT_EQ(pair.order(0), Order{});
  EXPECT_EQ(pair.order(0.065), Order{1});
}

TEST(ImageChoice, OfImagesFromOnePlaceTheNewestIsEnough) {
  EXPECT_EQ((Images{{0, 0}, {0, 1.0 / 30}, {0, 2.0 / 30}}.order(0.1)), Order{});
}

TEST(ImageChoice, AnImageThatIsYetToComeIsLeftOut) {
  EXPECT_EQ((Images{{0.3, 1}, {0, 0.5}}.order(0)), Order{});
}

TEST(ImageChoice, WhileTheLampIsNotKnownNothingMayHaveMoved) {
  EXPECT_EQ((Images{{0.3, 0}, {0, 0.5}}.order(0)), Order{1});
  EXPECT_EQ((Images{{0.3, 0}, {0, 0.5, 0.01}}.order(0)), Order{}) << "its shadow is elsewhere";
  EXPECT_EQ((Images{{0.3, 0, 0, true}, {0, 0.5, 0.01, true}}.order(0)), Order{1}) << "it is taken out of both";
  EXPECT_EQ((Images{{0.3, 0, 0, true}, {0, 0.5, 0, false}}.order(0)), Order{});
}

// As the eye moves from the one to the other, what they claim of a pixel changes step by step.
TEST(ImageChoice, NothingJumpsAsTheEyeMoves) {
  const Images all{{1, 0}, {0, 0.1}, {0.065, 0.1}};
  const auto share_of_first = [&](double x) {
    const auto chosen = all.chosen(x);
    const float best = chosen.back().claim;
    return all.place(chosen.back().image) == 1 ? best : 1 - best;
  };
  EXPECT_EQ(share_of_first(0.0), 1);
  EXPECT_EQ(share_of_first(0.065), 0);
  for (double x = 0; x < 0.065; x += 0.0003) EXPECT_NEAR(share_of_first(x), share_of_first(x + 0.0003), 0.05) << x;
}

}  // namespace
}  // namespace foresight::image_choice_test
