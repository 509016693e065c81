#include "link/coding/coded_pair.hpp"

#include <random>

#include "common/error.hpp"
#include "link/coding/pair_coder.hpp"
#include "link/coding/quality_model.hpp"

namespace foresight::coded_pair_test {
namespace {

CodedPair some_pair() {
  CodedPair pair{.number = 7, .captured = {-123'456'789'012}, .coding = Coding::h264, .lane = 2, .reference = 5};
  pair.width = 640;
  pair.height = 480;
  pair.colour = pair.stereo = pair.halved = true;
  pair.left_bytes = 2;
  pair.data = {1, 2, 3, 4, 5};
  pair.notes = {9, 8, 7};
  return pair;
}

TEST(CodedPair, ComesBackAsItWas) {
  const CodedPair pair = some_pair();
  const std::vector<std::uint8_t> bytes = to_bytes(pair);
  EXPECT_EQ(bytes.size(), kCodedPairHeader + pair.notes.size() + pair.data.size());
  const std::optional<CodedPair> back = parse_coded_pair(bytes);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->number, pair.number);
  EXPECT_EQ(back->captured, pair.captured);
  EXPECT_EQ(back->coding, pair.coding);
  EXPECT_EQ(back->lane, pair.lane);
  EXPECT_EQ(back->reference, pair.reference);
  EXPECT_EQ(back->width, pair.width);
  EXPECT_EQ(back->height, pair.height);
  EXPECT_TRUE(back->colour && back->stereo && back->halved);
  EXPECT_EQ(back->left_bytes, pair.left_bytes);
  EXPECT_EQ(back->data, pair.data);
  EXPECT_EQ(back->notes, pair.notes);
}

TEST(CodedPair, RefusesEveryDamage) {
  const std::vector<std::uint8_t> bytes = to_bytes(some_pair());
  for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
    std::vector<std::uint8_t> damaged = bytes;
    damaged[bit / 8] ^= static_cast<std::uint8_t>(1 << bit % 8);
    EXPECT_FALSE(parse_coded_pair(damaged)) << bit;
  }
  for (std::size_t size = 0; size < bytes.size(); ++size)
    EXPECT_FALSE(parse_coded_pair(std::span(bytes).first(size))) << size;
}

TEST(CodedPair, RefusesWhatIsOutOfBoundsThoughItsChecksumIsRight) {
  const auto refused = [](auto change) {
    CodedPair pair = some_pair();
    change(pair);
    return !parse_coded_pair(to_bytes(pair));
  };
  EXPECT_FALSE(refused([](CodedPair&) {}));
  EXPECT_TRUE(refused([](CodedPair& pair) { pair.lane = kMostLanes; }));
  EXPECT_TRUE(refused([](CodedPair& pair) { pair.coding = Coding::jpeg; })) << "no JPEG is halved";
  EXPECT_TRUE(refused([](CodedPair& pair) { pair.reference = pair.number; }));
  EXPECT_TRUE(refused([](CodedPair& pair) { pair.number = pair.reference = 0; }));
  EXPECT_TRUE(refused([](CodedPair& pair) { pair.width = 0; }));
  EXPECT_TRUE(refused([](CodedPair& pair) { pair.height = kLargestPictureSide + 1; }));
  EXPECT_TRUE(refused([](CodedPair& pair) { pair.coding = static_cast<Coding>(3); }));
  EXPECT_TRUE(refused([](CodedPair& pair) { pair.left_bytes = 6; }));
  EXPECT_TRUE(refused([](CodedPair& pair) { pair.data.clear(); }));
}

TEST(CodedPair, DecodersRefuseAnyDataOfARightFrame) {
  std::mt19937 random(5);
  for (const Coding coding : {Coding::jpeg, Coding::h264}) {
    const auto decoder = make_pair_decoder();
    for (std::uint32_t i = 1; i < 300; ++i) {
      CodedPair pair = some_pair();
      pair.number = i;
      pair.coding = coding;
      pair.reference = 0;
      pair.data.resize(random() % 400 + 1);
      for (std::uint8_t& byte : pair.data) byte = static_cast<std::uint8_t>(random());
      pair.left_bytes = static_cast<std::uint32_t>(random() % pair.data.size());
      EXPECT_FALSE(decoder->decode(pair));
    }
  }
}

TEST(PairEncoder, RefusesPicturesItCannotCode) {
  const auto encoder = make_pair_encoder(Coding::h264);
  const cv::Mat right_size(64, 96, CV_8UC3);
  const auto refused = [&](const cv::Mat& left, const cv::Mat& right) {
    EXPECT_THROW(encoder->encode({.left = left, .right = right, .captured = {}}, {}), InputError);
  };
  refused({}, {});
  refused(cv::Mat(64, 96, CV_16UC1), {});
  refused(right_size, cv::Mat(64, 94, CV_8UC3));
  refused(right_size, cv::Mat(64, 96, CV_8UC1));
  refused(cv::Mat(16, kLargestPictureSide + 1, CV_8UC1), {});
}

TEST(QualityModel, HalvesTheBytesInItsSteps) {
  QualityModel model({10, 51}, 5, 30, 8000);
  EXPECT_EQ(model.step_for(8000), 30);
  EXPECT_EQ(model.step_for(4000), 35);
  EXPECT_EQ(model.step_for(1), 51);
  EXPECT_EQ(model.step_for(100'000'000), 10);
  model.learn(35, 8000);
  EXPECT_EQ(model.step_for(8000), 35);
}

}  // namespace
}  // namespace foresight::coded_pair_test
