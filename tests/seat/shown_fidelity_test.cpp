// What was shown is compared with the image of its own instant, and what is learnt of it holds for the next pictures.
#include "seat/shown_fidelity.hpp"

#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>
#include <random>

namespace foresight::shown_fidelity_test {
namespace {

using namespace std::chrono_literals;

constexpr int kWidth = 96, kHeight = 64;

RobotTime at(Duration time) {
  return RobotTime{} + time;
}
cv::Mat image(int level = 120) {
  return {kHeight, kWidth, CV_8UC3, cv::Scalar(level, level, level)};
}
/// All of it coloured by images, without doubt.
RememberedView view(Duration instant, int level = 120) {
  return {at(instant), cv::Mat(kHeight, kWidth, CV_8UC4, cv::Scalar(level, level, level, 255)),
          cv::Mat::zeros(kHeight, kWidth, CV_8UC1)};
}

TEST(ShownFidelity, ComparesWithTheImageOfTheSameInstant) {
  ShownFidelity fidelity;
  for (int i = 0; i < 10; ++i) fidelity.shown(view(i * 100ms, 100 + 10 * i));
  EXPECT_FALSE(fidelity.arrived(at(-200ms), image()));
  const auto third = fidelity.arrived(at(312ms), image(130));
  ASSERT_TRUE(third);
  EXPECT_EQ(third->instant, at(300ms));
  EXPECT_EQ(third->psnr_db, 100);
  EXPECT_FALSE(fidelity.arrived(at(300ms), image())) << "it was used";
  EXPECT_FALSE(fidelity.arrived(at(350ms), image())) << "nothing was shown for it";
  const auto fifth = fidelity.arrived(at(500ms), image(140));
  ASSERT_TRUE(fifth);
  EXPECT_NEAR(fifth->psnr_db.value(), 20 * std::log10(255 / 10.0), 0.01);
}

TEST(ShownFidelity, SaysWhereItWasWrong) {
  ShownFidelity fidelity;
  fidelity.shown(view(100ms));
  cv::Mat truth = image();
  const cv::Rect there(kWidth - 14, kHeight - 14, 10, 10);
  truth(there) = cv::Scalar(160, 160, 160);
  const auto out = fidelity.arrived(at(100ms), truth);
  ASSERT_TRUE(out);
  EXPECT_EQ(place_of(out->worst), "bottom right");
  EXPECT_EQ(out->comparison.at<uchar>(kHeight - 9, kWidth - 9), kInPatch);
  EXPECT_EQ(out->comparison.at<uchar>(10, 10), 0);
  EXPECT_NEAR(out->exact_wrong, 100.0 / (kWidth * kHeight), 1e-9);
  EXPECT_EQ(place_of(0), "top left");
  EXPECT_EQ(place_of(Fidelity::kColumns * 2 + 3), "middle");
}

// An outline that is a pixel aside is no thing that moves by itself.
TEST(ShownFidelity, ALineIsNoPatch) {
  ShownFidelity fidelity;
  fidelity.shown(view(100ms));
  cv::Mat truth = image();
  cv::line(truth, {0, 20}, {kWidth, 20}, cv::Scalar(220, 220, 220), 1);
  const cv::Mat comparison = fidelity.arrived(at(100ms), truth)->comparison;
  EXPECT_EQ(cv::countNonZero(comparison == kInPatch), 0);
  EXPECT_NEAR(comparison.at<uchar>(20, 40), 100 / 3.0, 1) << "about each pixel";
  EXPECT_EQ(comparison.at<uchar>(22, 40), 0);
}

/// Pixels of all contrasts, of which half are wrong beyond one; those that are suspect beyond another.
class LearntKinds {
 public:
  Fidelity round(int wrong_beyond, int suspects_wrong_beyond) {
    RememberedView shown = view(rounds_ * 100ms);
    cv::Mat truth = image();
    for (int y = 0; y < kHeight; ++y)
      for (int x = 0; x < kWidth; ++x) {
        const DoubtKind kind{contrast_(random_), 0, percent_(random_) < 50 ? Compared::suspect : Compared::alike};
        shown.doubt.at<uchar>(y, x) = static_cast<uchar>(doubt_of(kind));
        const bool risky = kind.contrast > (kind.compared == Compared::suspect ? suspects_wrong_beyond : wrong_beyond);
        if (risky && percent_(random_) < 50) truth.at<cv::Vec3b>(y, x) = {180, 180, 180};
      }
    fidelity_.shown(std::move(shown));
    return fidelity_.arrived(at(rounds_++ * 100ms), truth).value();
  }
  double risk(const DoubtKind& kind) const { return fidelity_.risks()[static_cast<std::size_t>(doubt_of(kind))]; }
  /// How many contrasts count as exact.
  std::vector<int> exact() const {
    std::vector<int> out(2);
    for (int i = 0; i < DoubtKind::kContrasts; ++i) {
      out[0] += fidelity_.exact()[static_cast<std::size_t>(doubt_of({i, 0, Compared::alike}))] ? 1 : 0;
      out[1] += fidelity_.exact()[static_cast<std::size_t>(doubt_of({i, 0, Compared::suspect}))] ? 1 : 0;
    }
    return out;
  }

 private:
  ShownFidelity fidelity_;
  std::mt19937 random_{1};
  std::uniform_int_distribution<int> contrast_{0, DoubtKind::kContrasts - 1}, percent_{0, 99};
  int rounds_ = 0;
};

// A sharp view of what came blurred is not wrong.
TEST(ShownFidelity, WhatCodingTookAwayIsNotCompared) {
  ShownFidelity fidelity;
  fidelity.shown(view(100ms));
  cv::Mat lost = cv::Mat::zeros(kLossRows, kLossColumns, CV_8UC1), came = image();
  lost(cv::Rect(0, 0, kLossColumns / 2, kLossRows)) = 4;
  came(cv::Rect(0, 0, kWidth / 2, kHeight)) = cv::Scalar(160, 160, 160);
  const auto out = fidelity.arrived(at(100ms), came, lost);
  ASSERT_TRUE(out);
  EXPECT_EQ(out->psnr_db, 100);
  EXPECT_EQ(out->exact_wrong, 0);
  EXPECT_EQ(out->wrong[0], 0);
  EXPECT_EQ(out->comparison.at<uchar>(10, 10), kNotShown);
  EXPECT_EQ(out->comparison.at<uchar>(10, kWidth - 10), 0);
  fidelity.shown(view(200ms));
  EXPECT_FALSE(fidelity.arrived(at(200ms), came, cv::Mat(kLossRows, kLossColumns, CV_8UC1, cv::Scalar(1)))->psnr_db)
      << "nothing of it can be compared";
}

// Of half of a picture coding took some percent: how often that is wrong no image tells, so that it is as told.
class CodedAway {
 public:
  /// Shares that are told, by contrast, of tiles of each step; nothing: no robot tells them.
  explicit CodedAway(const std::optional<std::array<double, kLossContrasts>>& told = {}) {
    if (!told) return;
    LossShares shares;
    shares.fill(*told);
    fidelity_.told(shares);
  }
  /// `contrast`: loss_contrast().
  bool is_exact(int step, int contrast, double wrong_elsewhere = 0) {
    const int doubt = coded_away(step, contrast);
    for (int i = 0; i < 20; ++i) {
      RememberedView shown = view(++rounds_ * 100ms);
      shown.doubt = doubt_of({kStepsAContrast * contrast, 0, Compared::same});
      shown.doubt(cv::Rect(0, 0, kWidth / 2, kHeight)) = doubt;
      fidelity_.shown(std::move(shown));
      cv::Mat truth = image();
      truth(cv::Rect(kWidth / 2, 0, static_cast<int>(wrong_elsewhere * kWidth / 2), kHeight)) =
          cv::Scalar(160, 160, 160);
      EXPECT_TRUE(fidelity_.arrived(at(rounds_ * 100ms), truth));
    }
    return fidelity_.exact()[static_cast<std::size_t>(doubt)];
  }

 private:
  ShownFidelity fidelity_;
  int rounds_ = 0;
};

TEST(ShownFidelity, WhatCodingTookAwayCountsAsMuchAsItIs) {
  EXPECT_TRUE(CodedAway().is_exact(1, 0));
  EXPECT_TRUE(CodedAway().is_exact(2, 0)) << "2.2 % of one half, nothing of the other";
  EXPECT_FALSE(CodedAway().is_exact(3, 0));
  EXPECT_FALSE(CodedAway().is_exact(kLossSteps - 1, 0));
  EXPECT_FALSE(CodedAway().is_exact(1, 0, 0.03)) << "what is wrong elsewhere is wrong there, too";
}

TEST(ShownFidelity, CodingSparesWhatIsFlat) {
  CodedAway lossy({{0.002, 0.01, 0.1, 0.3, 0.5}});
  EXPECT_TRUE(lossy.is_exact(3, 0)) << "4 % of its tile, and next to nothing of what is flat there";
  EXPECT_TRUE(lossy.is_exact(kToldSteps, 1));
  EXPECT_FALSE(lossy.is_exact(1, 2));
  EXPECT_FALSE(lossy.is_exact(kToldSteps + 1, 0)) << "of which nothing is told";
  CodedAway kept({{0, 0, 0, 0, 0}});
  EXPECT_TRUE(kept.is_exact(1, 3));
  EXPECT_FALSE(kept.is_exact(1, 3, 0.08)) << "of this contrast much is wrong elsewhere";
  EXPECT_TRUE(kept.is_exact(1, 1)) << "and little of that";
}

// One column in 72 is wrong: 1.4 %.
TEST(ShownFidelity, ImagesOfAThinLineAgreeMoreThanTheTruth) {
  const auto exact_by = [](const cv::Mat& lost) {
    ShownFidelity fidelity;
    double exact = 0;
    for (int i = 1; i <= 100; ++i) {
      RememberedView shown = view(i * 100ms);
      shown.doubt = doubt_of({8, 0, Compared::close});
      cv::Mat truth = image();
      for (int x = 5 * i % 72; x < kWidth; x += 72) truth.col(x) = cv::Scalar(180, 180, 180);
      fidelity.shown(std::move(shown));
      exact = fidelity.arrived(at(i * 100ms), truth, lost)->exact_share;
    }
    return exact;
  };
  EXPECT_GT(exact_by({}), 0.99);
  EXPECT_EQ(exact_by(cv::Mat::zeros(kLossRows, kLossColumns, CV_8UC1)), 0) << "coded, though it lost next to nothing";
}

TEST(ShownFidelity, KindsOfDoubtFitAByte) {
  static_assert(kKindsEnd <= kUnconfirmed);
  static_assert(coded_away(kToldSteps, kLossContrasts - 1) + 1 == kMostlyCodedAway);
  static_assert(coded_away(kToldSteps + 1, 0) == kMostlyCodedAway && coded_away(1, 0) == kCodedAway);
  for (int i = 0; i < DoubtKind::kCount; ++i) EXPECT_EQ(doubt_of(kind_of(i)), i);
  EXPECT_LT(DoubtKind::kCount, kUnconfirmed);
}

TEST(ShownFidelity, BeforeAnythingWasComparedLittleContrastIsExact) {
  const ShownFidelity fidelity;
  EXPECT_TRUE(fidelity.exact()[doubt_of({0, 0, Compared::never})]);
  EXPECT_FALSE(fidelity.exact()[doubt_of({15, 0, Compared::never})]);
  EXPECT_FALSE(fidelity.exact()[doubt_of({0, 0, Compared::suspect})]);
  EXPECT_FALSE(fidelity.exact()[kUnconfirmed]);
  int before = DoubtKind::kContrasts;
  for (int reach = 0; reach < DoubtKind::kReaches; ++reach) {
    int contrasts = 0;
    for (int i = 0; i < DoubtKind::kContrasts; ++i)
      contrasts += fidelity.exact()[doubt_of({i, reach, Compared::never})] ? 1 : 0;
    EXPECT_LE(contrasts, before) << "the farther off a surface may be";
    before = contrasts;
  }
}

TEST(ShownFidelity, AFewPixelsOfAKindThatWasNeverSeenAreNotHeldBack) {
  ShownFidelity fidelity;
  const DoubtKind sure{2, 0, Compared::same}, print{8, 0, Compared::never}, edge{15, 0, Compared::never};
  RememberedView shown = view(100ms);
  shown.doubt = doubt_of(sure);
  shown.doubt.colRange(0, kWidth / 10) = doubt_of(print);
  shown.doubt.colRange(kWidth / 10, kWidth / 8) = doubt_of(edge);
  fidelity.shown(std::move(shown));
  EXPECT_TRUE(fidelity.exact()[doubt_of(print)]) << "few pixels lie far aside";
  EXPECT_FALSE(fidelity.exact()[doubt_of(edge)]);
}

TEST(ShownFidelity, LearnsOfWhatKindPixelsAreRight) {
  LearntKinds learnt;
  for (int i = 0; i < 20; ++i) learnt.round(9, 3);
  EXPECT_EQ(learnt.exact(), (std::vector{10, 4}));
  EXPECT_LT(learnt.round(9, 3).exact_wrong, 0.02);
  for (int i = 0; i < 60; ++i) learnt.round(5, -1);
  EXPECT_EQ(learnt.exact(), (std::vector{6, 0})) << "it has become worse";
  for (int i = 0; i < 200; ++i) learnt.round(15, 15);
  EXPECT_EQ(learnt.exact(), (std::vector{16, 16})) << "all is well";
}

TEST(ShownFidelity, RisksAreSharesThatWereWrong) {
  LearntKinds learnt;
  for (int i = 0; i < 60; ++i) learnt.round(9, 3);
  for (int i = 0; i < DoubtKind::kContrasts; ++i) {
    EXPECT_NEAR(learnt.risk({i, 0, Compared::alike}), i > 9 ? 0.5 : 0, 0.06) << i;
    EXPECT_NEAR(learnt.risk({i, 0, Compared::suspect}), i > 3 ? 0.5 : 0, 0.06) << i;
  }
}

TEST(ShownFidelity, PicturesMakeUpForEachOther) {
  ShownFidelity fidelity;
  const DoubtKind sure{2, 0, Compared::same}, risky{8, 0, Compared::close};
  int rounds = 0;
  const auto round = [&](int risky_columns) {
    RememberedView shown = view(++rounds * 100ms);
    cv::Mat truth = image();
    shown.doubt = doubt_of(sure);
    shown.doubt.colRange(0, risky_columns) = doubt_of(risky);
    // One column in 56 of the risky ones.
    for (int x = 5 * rounds % 56; x < risky_columns; x += 56) truth.col(x) = cv::Scalar(180, 180, 180);
    fidelity.shown(std::move(shown));
    return fidelity.arrived(at(rounds * 100ms), truth).value();
  };
  for (int i = 0; i < 40; ++i) round(kWidth / 2);
  EXPECT_GT(round(kWidth).exact_share, 0.99) << "alone it has more wrong pixels than may be";
  for (int i = 0; i < 200; ++i) round(kWidth);
  EXPECT_EQ(round(kWidth).exact_share, 0) << "now there is nothing to make up for it";
}

// As a ball that rolls through a picture in which nothing else goes on.
TEST(ShownFidelity, AllElseDoesNotMakeUpForAKindThatIsOftenWrong) {
  ShownFidelity fidelity;
  const DoubtKind sure{2, 0, Compared::same}, ball{8, 0, Compared::suspect};
  constexpr int kBall = 8;  // px: its sides
  for (int i = 0; i < 40; ++i) {
    RememberedView shown = view(i * 100ms);
    cv::Mat truth = image();
    shown.doubt = doubt_of(sure);
    const cv::Rect at_ball(10 + i, 10, kBall, kBall);
    shown.doubt(at_ball) = doubt_of(ball);
    truth(cv::Rect(at_ball.x, at_ball.y, kBall / 4, kBall)) = cv::Scalar(180, 180, 180);  // what it came to cover
    fidelity.shown(std::move(shown));
    const auto out = fidelity.arrived(at(i * 100ms), truth);
    ASSERT_TRUE(out);
    EXPECT_NEAR(out->exact_share, 1 - 1.0 * kBall * kBall / (kWidth * kHeight), 1e-9) << i;
    EXPECT_EQ(out->exact_wrong, 0) << i;
  }
}

// As a shadow that lay where it had been seen, until it is known where it falls.
TEST(ShownFidelity, WhatHadAReasonThatIsNoMoreTellsNothing) {
  ShownFidelity fidelity;
  const DoubtKind kind{8, 0, Compared::alike};
  int rounds = 0;
  const auto round = [&](int shadow) {
    RememberedView shown = view(++rounds * 100ms);
    cv::Mat truth = image();
    shown.doubt = doubt_of(kind);
    truth.col(rounds % kWidth) = cv::Scalar(180, 180, 180);  // lines are no patches
    truth(cv::Rect(0, 0, shadow, kHeight)) = cv::Scalar(60, 60, 60);
    fidelity.shown(std::move(shown));
    return fidelity.arrived(at(rounds * 100ms), truth).value();
  };
  for (int i = 0; i < 20; ++i) round(0);
  EXPECT_EQ(round(0).exact_share, 1);
  for (int i = 0; i < 20; ++i) round(kWidth / 3);
  EXPECT_EQ(round(kWidth / 3).exact_share, 0) << "of this kind many are wrong";
  fidelity.begin_anew(at((rounds + 2) * 100ms));
  EXPECT_TRUE(fidelity.exact()[doubt_of(kind)]) << "few were beside the patches";
  const Fidelity before = round(kWidth / 3);
  EXPECT_TRUE(before.psnr_db);
  EXPECT_TRUE(before.comparison.empty()) << "it was shown before";
  const Fidelity after = round(0);
  EXPECT_FALSE(after.comparison.empty());
  EXPECT_EQ(after.exact_share, 1);
}

TEST(ShownFidelity, OfARobotThatDidSomethingElseNothingIsLearnt) {
  ShownFidelity fidelity;
  int rounds = 0;
  const auto round = [&](int level, bool surprised) {
    fidelity.shown(view(++rounds * 100ms));
    return fidelity.arrived(at(rounds * 100ms), image(level), {}, surprised).value();
  };
  for (int i = 0; i < 20; ++i) round(120, false);
  for (int i = 0; i < 10; ++i) {
    const Fidelity surprised = round(60, true);
    EXPECT_EQ(surprised.exact_share, 1);
    EXPECT_EQ(surprised.exact_wrong, 1) << "that is told all the same";
    EXPECT_TRUE(surprised.comparison.empty());
  }
  EXPECT_EQ(round(120, false).exact_share, 1);
  for (int i = 0; i < 10; ++i) round(60, false);
  EXPECT_EQ(round(120, false).exact_share, 0);
}

TEST(ShownFidelity, WhatNoImageColouredIsLeftOut) {
  ShownFidelity fidelity;
  RememberedView shown = view(100ms);
  shown.picture(cv::Rect(0, 0, kWidth / 2, kHeight)) = cv::Scalar(0, 0, 0, 128);
  shown.doubt.colRange(kWidth - 10, kWidth) = kUnconfirmed;
  fidelity.shown(std::move(shown));
  const auto out = fidelity.arrived(at(100ms), image());
  ASSERT_TRUE(out);
  EXPECT_EQ(out->psnr_db, 100);
  EXPECT_NEAR(out->exact_share, (kWidth / 2.0 - 10) / (kWidth / 2.0), 1e-9);
}

// What was drawn with fewer pixels is compared as it looks: blurred at edges, and that counts.
TEST(ShownFidelity, SmallerPicturesAreComparedAsTheyLook) {
  cv::Mat half = image();
  half.colRange(0, kWidth / 2) = cv::Scalar::all(200);
  half.colRange(kWidth / 2, kWidth) = cv::Scalar::all(40);
  RememberedView small = view(100ms);
  cv::Mat bgr;
  cv::resize(half, bgr, {kWidth / 2, kHeight / 2}, 0, 0, cv::INTER_AREA);
  cv::cvtColor(bgr, small.picture, cv::COLOR_BGR2BGRA);
  small.picture.rowRange(0, kHeight / 4).setTo(cv::Scalar(7, 7, 7, 128));  // filled
  small.doubt = cv::Mat(kHeight / 2, kWidth / 2, CV_8UC1, cv::Scalar(small.doubt.at<uchar>(0, 0)));
  ShownFidelity fidelity;
  fidelity.shown(std::move(small));
  const auto out = fidelity.arrived(at(100ms), half);
  ASSERT_TRUE(out);
  EXPECT_EQ(out->comparison.size(), half.size());
  EXPECT_GT(*out->psnr_db, 20);
  EXPECT_LT(*out->psnr_db, 60) << "the edge is blurred";
  const int row = 3 * kHeight / 4;
  EXPECT_EQ(out->comparison.at<uchar>(row, 3), 0);
  EXPECT_GT(out->comparison.at<uchar>(row, kWidth / 2), 10);
  EXPECT_EQ(out->comparison.at<uchar>(kHeight / 4, 3), kNotShown) << "no image coloured it";
}

TEST(ShownFidelity, BearsWhatDoesNotFit) {
  ShownFidelity fidelity({.kept = 3});
  fidelity.shown(view(100ms));
  EXPECT_FALSE(fidelity.arrived(at(100ms), cv::Mat(10, 10, CV_8UC3, cv::Scalar::all(1)))) << "of another size";
  for (int i = 0; i < 100; ++i) fidelity.shown(view(i * 100ms));
  EXPECT_FALSE(fidelity.arrived(at(9600ms), image())) << "only so many are kept";
  EXPECT_TRUE(fidelity.arrived(at(9700ms), image()));
  fidelity.shown(view(5ms));  // the robot's clock began anew
  EXPECT_TRUE(fidelity.arrived(at(5ms), image()));
  RememberedView dark = view(200ms);
  dark.picture = cv::Scalar::all(0);
  fidelity.shown(std::move(dark));
  const auto nothing = fidelity.arrived(at(200ms), image());
  ASSERT_TRUE(nothing);
  EXPECT_FALSE(nothing->psnr_db);
}

}  // namespace
}  // namespace foresight::shown_fidelity_test
