#include "calibration/registration/motion_model.hpp"

#include <gtest/gtest.h>

namespace foresight::motion_model_test {
namespace {

const Eigen::VectorXd kPast = (Eigen::VectorXd(6) << 0, -1, -2, -3, -4, -5).finished() / 30;

Eigen::VectorXd since(int images) {
  Eigen::VectorXd out(images);
  for (int i = 0; i < images; ++i) out[i] = (i + 1) / 30.0;
  return out;
}

TEST(MotionModel, CarriesALineOn) {
  for (const int lag : {1, 3}) {
    const auto given = since(lag);
    const MotionWeights w = motion_weights({}, kPast, given, lag / 30.0);
    EXPECT_NEAR(w.refined.sum() + w.given.sum(), 1, 0.01) << lag;  // stays where it stays
    EXPECT_NEAR(w.refined.dot(kPast) + w.given.dot(given), lag / 30.0, 0.03 * lag / 30.0) << lag;
  }
}

TEST(MotionModel, TrustsGivenPosesMoreTheLongerAgoTheRefinedOnesAre) {
  double weight = 0, sigma = 0;
  for (const int lag : {1, 3, 6}) {
    const MotionWeights w = motion_weights({}, kPast, since(lag), lag / 30.0);
    EXPECT_GT(w.given.sum(), weight) << lag;
    EXPECT_GT(w.sigma_px, sigma) << lag;
    EXPECT_LT(w.sigma_px, MotionModel{}.given_px) << lag;  // never worse than the given pose alone
    weight = w.given.sum(), sigma = w.sigma_px;
  }
}

TEST(MotionModel, ErrorsThatPersistAreTakenAway) {
  MotionModel model;
  model.persist_s = 10;
  // Given: of the newest refined pose, and of the wanted one.
  const Eigen::VectorXd given = (Eigen::VectorXd(2) << 0, 0.5).finished();
  const MotionWeights w = motion_weights(model, kPast, given, 0.5);
  EXPECT_NEAR(w.given[1], 1, 0.1);
  EXPECT_NEAR(w.given[0], -1, 0.1);
  EXPECT_LT(w.sigma_px, MotionModel{}.given_px / 2);
}

}  // namespace
}  // namespace foresight::motion_model_test
