// A head whose joints are off: calibrated from the mock lab's own pictures, then registered where nobody has looked.
#include <fmt/core.h>
#include <gmock/gmock.h>

#include <opencv2/imgproc.hpp>

#include "calibration/result/result_file.hpp"
#include "rig/open_stereo.hpp"
#include "session/encoder_poses.hpp"
#include "session/recorder_options.hpp"
#include "tests/calibrate/mock_head.hpp"
#include "tests/support/folders.hpp"
#include "tests/support/headless_test.hpp"

namespace foresight::mock_head_session_test {
namespace {

constexpr double kEvery = 0.9;  // s; beyond the window of the tags' correction: each pose stands on its own tags

const std::string kMap = source_folder() / "configs/lab_tags.txt";

/// What the mock lab's cameras took, and how it was.
struct Session {
  std::vector<StereoPair> pairs;
  std::vector<Pose> true_left;
  std::vector<std::pair<RobotTime, HeadAngles>> encoders;
};

class MockLabHead : public HeadlessTest {
 protected:
  void SetUp() override {
    HeadlessTest::SetUp();
    if (IsSkipped()) return;
    context_.reset();
    MockWorld world = mock_world(kMap);
    world.hidden.joint_rad = 0.005;
    StereoConfig config = as_mock({});
    for (CameraConfig& camera : config.cameras) camera.settings.rate = 1 / kEvery;
    opened_ = open_stereo(
        config, [this](auto joint, RobotTime t) { return shaft(joint, t); }, clock_, world);
  }

  std::optional<double> shaft(std::string_view joint, RobotTime t) const {
    const HeadAngles q = MockHead::motors(session_, to_seconds(t - started_));
    if (joint == "pan") return q.pan;
    if (joint == "tilt") return q.tilt;
    return sim::shafts_at_rest(joint);
  }

  Session look(int session, int pairs) {
    session_ = session;
    started_ = clock_.now();
    Session out;
    opened_.cameras->start_polled();
    while (static_cast<int>(out.pairs.size()) < pairs) {
      clock_.sleep_until(clock_.now() + seconds(kEvery));
      opened_.cameras->poll();
      if (auto pair = opened_.cameras->take(Duration{0})) out.pairs.push_back(std::move(*pair));
      if (clock_.now() - started_ > seconds(2 * pairs)) throw RuntimeFailure("the mock cameras gave no pairs", "");
    }
    opened_.cameras->stop();
    for (const StereoPair& pair : out.pairs)
      out.true_left.push_back(
          opened_.mock->world()->T_world_left([&](std::string_view joint) { return shaft(joint, pair.left.time); }));
    std::mt19937 random(static_cast<unsigned>(session));
    std::normal_distribution<double> noise(0, MockHead::kEncoderNoise);
    for (RobotTime t = started_ - seconds(1); t < clock_.now() + seconds(1); t = t + seconds(0.01))
      out.encoders.emplace_back(t + seconds(MockHead::kClockOffset),
                                HeadAngles{*shaft("pan", t) + noise(random), *shaft("tilt", t) + noise(random)});
    return out;
  }

  /// As `foresight robot --record` does.
  void write(const std::string& name, const Session& session) {
    const auto scene = std::make_shared<const LiveScene>(*opened_.mock);
    RecorderOptions options = recorder_options(*scene);
    options.posed = false;
    options.tags = kMap;
    LiveFrames frames(std::make_shared<GivenPoses>(scene, nullptr), clock_);
    RunRecorder recorder(folder_ / name, options, frames.subscribe(RunRecorder::kRoom, true));
    for (const StereoPair& pair : session.pairs) {
      frames.add(pair);
      frames.step();
    }
    recorder.finish("");
    std::ofstream joints(folder_ / (name + "-joints.csv"));
    joints << "time_s,pan,tilt\n";
    for (const auto& [time, q] : session.encoders)
      joints << fmt::format("{:.9f},{:.7f},{:.7f}\n", to_seconds(time - RobotTime{}), q.pan, q.tilt);
  }

  /// What `calibrate photometric` finds of the mock cameras, from a series that `calibrate capture` takes of their lab.
  std::string response() {
    const std::string file = folder_ / "photometric.yaml", series = folder_ / "series";
    if (std::filesystem::exists(file)) return file;
    EXPECT_EQ(run_calibrate({"capture", "--mock", "--exposures", "0.0005", "0.001", "0.002", "0.004", "0.008", "0.016",
                             "0.03", "--out", series}),
              "0");
    EXPECT_EQ(run_calibrate({"photometric", "--left", series + "/left", "--right", series + "/right", "--exposures",
                             series + "/exposures.txt", "--out", file, "--json", folder_ / "p.json"}),
              "0");
    return file;
  }

  const TempFolder folder_;
  SteppedClock clock_;
  int session_ = 0;
  RobotTime started_;
  OpenStereo opened_;
};

cv::Mat grey(const ColourImage& image) {
  cv::Mat out;
  cv::cvtColor(image.bgr, out, cv::COLOR_BGR2GRAY);
  return out;
}

/// The inverse of sim/sensor.cpp's response, 1 as it saturates.
double true_exposure(int level) {
  const double y = level / 255.0, light = y < 0.04045 ? y / 12.92 : std::pow((y + 0.055) / 1.055, 2.4);
  return light < 0.55 ? light : 0.55 - 0.45 * std::log(1 - (light - 0.55) / 0.45);
}

/// Over most of the levels; darker, noise bends it.
double worst_ratio(const std::vector<double>& found) {
  double worst = 0;
  for (int v = 24; v <= 240; ++v) {
    const double ratio = found[static_cast<std::size_t>(v)] / true_exposure(v) * true_exposure(128) / found[128];
    worst = std::max(worst, std::abs(std::log(ratio)));
  }
  return worst;
}

// The documented session: a series of exposures tells the cameras' response, a sweep with it the head.
TEST_F(MockLabHead, IsCalibratedByTheLabsOwnPictures) {
  EXPECT_LT(worst_ratio(read_inverse_response(response())), 0.04);
  for (const char* side : {"left", "right"}) EXPECT_LT(json_of(folder_, "p.json")[side]["held_out_levels"], 6) << side;
  const std::string head_file = folder_ / "head.yaml";
  write("sweep", look(1, 24));
  ASSERT_EQ(run_calibrate({"pan-tilt", "--run", folder_ / "sweep", "--photometric", response(), "--json",
                           folder_ / "head.json", "--out", head_file}),
            "0");
  const auto numbers = json_of(folder_, "head.json");
  const HeadModel head = read_head_model(head_file, {});
  EXPECT_NEAR(head.offset_s, MockHead::kClockOffset, 0.001);

  const Session unseen = look(7, 12);
  const StereoLenses lenses{opened_.mock->lens(Side::left), opened_.mock->lens(Side::right),
                            opened_.mock->T_left_right()};
  Registration blind(head, lenses, {}, {});
  RegistrationOptions options = options_for(head);
  options.detector.inverse_response = read_inverse_response(response());
  Registration seeing(head, lenses, read_tag_map(kMap), options);
  std::size_t fed = 0;
  double by_encoders = 0, with_tags = 0, drawn = 0;
  for (std::size_t i = 0; i < unseen.pairs.size(); ++i) {
    const RobotTime time = unseen.pairs[i].left.time;
    for (; fed < unseen.encoders.size() && unseen.encoders[fed].first < time + seconds(0.05); ++fed) {
      blind.add_encoders(unseen.encoders[fed].first, unseen.encoders[fed].second);
      seeing.add_encoders(unseen.encoders[fed].first, unseen.encoders[fed].second);
    }
    const Pose& truth = unseen.true_left[i];
    const auto without = blind.register_pair(time, {}, {});
    const auto with = seeing.register_pair(time, grey(unseen.pairs[i].left), grey(unseen.pairs[i].right));
    ASSERT_EQ(without.quality, RegistrationQuality::encoders);
    EXPECT_EQ(with.quality, RegistrationQuality::tags);
    const auto square = [&](const Pose& found) {
      return std::pow(error_px(lenses.left, truth, found), 2) / static_cast<double>(unseen.pairs.size());
    };
    by_encoders += square(without.T_world_left);
    with_tags += square(with.T_world_left);
    drawn += square(sim::LiveLab::T_world_left_modelled([&](std::string_view joint) { return shaft(joint, time); }));
  }
  std::printf("unseen: drawing %.2f px, encoders %.3f px, with tags %.3f px; loo %.3f px\n", std::sqrt(drawn),
              std::sqrt(by_encoders), std::sqrt(with_tags), numbers["loo_px"].get<double>());
  EXPECT_LE(std::sqrt(by_encoders), 1.0);
  EXPECT_LE(std::sqrt(with_tags), 0.3);
  EXPECT_GT(std::sqrt(drawn), 2) << "or nothing was hidden";
  write("second", unseen);
  EXPECT_EQ(run_calibrate({"verify", "--result", head_file, "--run", folder_ / "second", "--photometric", response()}),
            "0");
}

}  // namespace
}  // namespace foresight::mock_head_session_test
