#include "rig_view/rig_picture.hpp"

#include <gmock/gmock.h>

#include <cstdlib>
#include <opencv2/imgcodecs.hpp>

#include "rig_view/words.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::rig_picture_test {
namespace {

constexpr int kWidth = 900, kHeight = 560;

class RigPictureTest : public HeadlessTest {
 protected:
  cv::Mat picture(const std::vector<double>& positions, const Layers& layers = kAllLayers) {
    RigPicture draw(body_);
    PanelState state;
    state.title = rig_.name;
    state.positions = positions;
    state.layers = layers;
    return draw(body_, body_.at(positions), state, eye_, kWidth, kHeight);
  }
  cv::Vec3b at(const cv::Mat& picture, const Eigen::Vector3d& p) const {
    const Eigen::Vector2d pixel = eye_.pixel(p, kWidth - kPanelWidth, kHeight).value();
    return picture.at<cv::Vec3b>(cvRound(pixel.y()), cvRound(pixel.x()));
  }
  const Rig rig_ = read_rig(source_folder() / "configs/minerva.yaml");
  RigBody body_{rig_, {}};
  const Eye eye_ = Eye::from(LookFrom::side, body_.extent(), (kWidth - kPanelWidth) / double{kHeight});
};

// Names of joints differ at their ends; a whole one would be too small to be read.
TEST(Words, LongOnesLoseTheirMiddle) {
  EXPECT_EQ(fitting_text("elbow", 0.4, 120), "elbow");
  const std::string cut = fitting_text("the_left_manipulators_long_descriptive_joint_name_number_11", 0.4, 120);
  EXPECT_LT(cut.size(), 24u);
  EXPECT_GT(cut.size(), 8u);
  EXPECT_TRUE(cut.starts_with("the_") && cut.ends_with("_11")) << cut;
  EXPECT_EQ(fitting_text("a\u00e4\u80a9z", 0.4, 0), "a\xc3\xe8z") << "one letter each";
}

TEST_F(RigPictureTest, ShowsLinksWhereTheyStandAndGuardsAroundThem) {
  Layers bare{};
  bare[static_cast<std::size_t>(Layer::links)] = true;
  std::vector<double> positions = body_.rest();
  const cv::Mat links = picture(positions, bare);
  const PlacedRig placed = body_.at(positions);
  const auto middle_of = [&](const char* name) {
    const auto guard = std::ranges::find(placed.guards, name, &GuardedLink::name);
    return Eigen::Vector3d(0.5 * (guard->body.a + guard->body.b));
  };
  for (const char* name : {"stand", "arm_1", "arm_3", "arm_5"}) {
    const cv::Vec3b seen = at(links, middle_of(name));
    EXPECT_LT(seen[0], 225) << name << " is not the ground";
    EXPECT_NEAR(seen[0], seen[2], 40) << name << " is grey";
  }
  const Eigen::Vector3d beside = middle_of("arm_3") + Eigen::Vector3d(0.3, 0, 0);
  EXPECT_GT(at(links, beside)[0], 225);

  bare[static_cast<std::size_t>(Layer::guards)] = true;
  const cv::Mat guarded = picture(positions, bare);
  EXPECT_GT(cv::norm(at(guarded, middle_of("arm_3")), at(links, middle_of("arm_3"))), 10);
  positions[3] = 1.5;  // elbow
  EXPECT_GT(at(picture(positions, bare), middle_of("arm_5"))[0], 225) << "the forearm has gone";
  if (const char* folder = std::getenv("FORESIGHT_KEEP_IMAGES")) {
    cv::imwrite(std::string(folder) + "/rig_links.png", guarded);
    cv::imwrite(std::string(folder) + "/rig_all.png", picture(positions));
  }
}

TEST_F(RigPictureTest, WordsDoNotCoverEachOther) {
  cv::Mat paper(kHeight, kWidth, CV_8UC3, cv::Scalar::all(246));
  std::vector<Drawing::Word> words;
  for (int i = 0; i < 12; ++i)
    words.push_back({Eigen::Vector3d(0, 0, 0.5 + 0.001 * i), "word " + std::to_string(i), Colour(0, 0, 0, 1)});
  words.push_back({Eigen::Vector3d(1e3, 0, 0), "far out", Colour(0, 0, 0, 1)});
  EXPECT_EQ(write_words(paper, words, eye_), 12u);
  // Twelve words of ink, not one on top of the other.
  cv::Mat one(kHeight, kWidth, CV_8UC3, cv::Scalar::all(246));
  words.resize(1);
  write_words(one, words, eye_);
  const auto ink = [](const cv::Mat& m) { return cv::countNonZero(m.reshape(1) < 128); };
  EXPECT_GT(ink(paper), 9 * ink(one));
}

}  // namespace
}  // namespace foresight::rig_picture_test
