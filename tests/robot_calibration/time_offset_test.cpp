#include "calibration/robot/time_offset.hpp"

#include "synthetic_rig.hpp"
#include "tests/scene/test_run.hpp"

namespace foresight::time_offset_test {
namespace {

using testing::AllOf;
using testing::HasSubstr;

TEST(TimeOffset, RecoversOffsetAndHandEye) {
  Random random(31);
  for (const bool inverted : {false, true}) {
    const StreamRig rig = make_streams(random, 40, inverted ? 0.1234 : -0.0456, inverted);
    const TimeOffsetSummary summary = solve_time_offset(rig.encoder, rig.camera, {});
    EXPECT_NEAR(summary.offset_s, rig.offset_s, 4 * summary.offset_sigma_s);
    EXPECT_LT(summary.offset_sigma_s, 2e-3);
    EXPECT_EQ(summary.camera_inverted, inverted);
    EXPECT_LT(step_between(summary.X, rig.X).norm(), 5e-3);
    EXPECT_GE(summary.outliers, 5);
    EXPECT_LE(summary.outliers, 40);
  }
}

// t_encoder = t_camera + offset: stamping the camera's poses later makes the offset smaller.
TEST(TimeOffset, HasTheSignOfItsDefinition) {
  Random random(32);
  StreamRig rig = make_streams(random, 30, 0);
  const double before = solve_time_offset(rig.encoder, rig.camera, {}).offset_s;
  for (PoseTrack::Sample& sample : rig.camera) sample.time = sample.time + seconds(0.25);
  EXPECT_NEAR(solve_time_offset(rig.encoder, rig.camera, {}).offset_s, before - 0.25, 1e-4);
}

TEST(TimeOffset, FromSweptJoints) {
  Random random(33);
  const Pose X = random_pose(random, 3, 0.1), Y = random_pose(random, 3, 0.3);
  for (const int joints : {1, 2}) {
    std::vector<JointRow> rows;
    std::vector<PoseTrack::Sample> camera;
    const auto joint = [&](double t) {
      std::vector<double> q{0.6 * std::sin(1.7 * t) + 0.1 * std::sin(5 * t)};
      if (joints == 2) q.push_back(0.4 * std::sin(1.1 * t + 1));
      return q;
    };
    for (double t = 0; t < 30; t += 0.02) rows.push_back({{seconds(1.6e9).count() + seconds(t).count()}, joint(t)});
    for (double t = 0.1; t < 29.9; t += 1 / 30.0) {
      const auto swept = swept_poses({{{0}, joint(t + 0.035)}}, "test");
      camera.push_back(
          {{seconds(1.6e9).count() + seconds(t).count()}, noisy(Y.inverse() * swept[0].pose * X, random, 3e-3, 2e-3)});
    }
    TimeOffsetOptions options;
    options.rotation_only = true;
    const TimeOffsetSummary summary = solve_time_offset(swept_poses(rows, "test"), camera, options);
    EXPECT_NEAR(summary.offset_s, 0.035, 4 * summary.offset_sigma_s) << joints;
    EXPECT_LT(summary.offset_sigma_s, 2e-3);
  }
}

TEST(TimeOffset, SaysWhatStreamsLack) {
  Random random(34);
  const StreamRig rig = make_streams(random, 30, 0.02);
  StreamRig late = rig;
  for (PoseTrack::Sample& sample : late.camera) sample.time = sample.time + seconds(100);
  EXPECT_THAT(input_error([&] { solve_time_offset(late.encoder, late.camera, {}); }),
              AllOf(HasSubstr("share less than 3 s"), HasSubstr("--around")));
  TimeOffsetOptions around;
  around.around_s = -100;
  EXPECT_NEAR(solve_time_offset(late.encoder, late.camera, around).offset_s, -99.98, 0.005);

  const StreamRig one = make_streams(random, 90, 0.02), other = make_streams(random, 90, 0.02);
  EXPECT_THAT(input_error([&] { solve_time_offset(one.encoder, other.camera, {}); }), HasSubstr("do not correlate"));

  StreamRig single = rig;
  for (auto* stream : {&single.encoder, &single.camera})
    for (PoseTrack::Sample& sample : *stream) {
      const double t = to_seconds(sample.time - rig.encoder.front().time);
      sample.pose.linear() = rotation_of({0, 0, std::sin(t)});
    }
  EXPECT_THAT(input_error([&] { solve_time_offset(single.encoder, single.camera, {}); }),
              HasSubstr("the hand turned about one axis only"));
}

// Cut and thinned: every `nth` sample of those between `from` and `to` seconds after the first.
std::vector<PoseTrack::Sample> part(const std::vector<PoseTrack::Sample>& all, std::size_t nth, double from,
                                    double to) {
  std::vector<PoseTrack::Sample> out;
  for (std::size_t i = 0; i < all.size(); i += nth) {
    const double t = to_seconds(all[i].time - all.front().time);
    if (t >= from && t <= to) out.push_back(all[i]);
  }
  return out;
}

TEST(TimeOffset, LargeOffsetsOfBothSigns) {
  Random random(35);
  for (const double offset : {-4.3, -0.5, 0.5, 3.7}) {
    StreamRig rig = make_streams(random, 30, 0.01);
    for (PoseTrack::Sample& sample : rig.camera) sample.time = sample.time + seconds(0.01 - offset);
    const TimeOffsetSummary summary = solve_time_offset(rig.encoder, rig.camera, {});
    EXPECT_NEAR(summary.offset_s, offset, 4 * summary.offset_sigma_s) << offset;
    EXPECT_LT(summary.offset_sigma_s, 2e-3);
  }
}

TEST(TimeOffset, OtherRatesGapsAndLengths) {
  Random random(36);
  const StreamRig rig = make_streams(random, 60, -0.08);
  struct Case {
    const char* name;
    std::vector<PoseTrack::Sample> encoder, camera;
  };
  std::vector<Case> cases{
      {"slow camera", rig.encoder, part(rig.camera, 5, 0, 60)},
      {"slow encoders", part(rig.encoder, 10, 0, 100), rig.camera},
      {"short camera", rig.encoder, part(rig.camera, 1, 20, 32)},
      {"short encoders", part(rig.encoder, 1, 20, 32), rig.camera},
      {"streams that overlap in the middle", part(rig.encoder, 1, 0, 40), part(rig.camera, 1, 20, 60)},
      {"gaps", {}, {}}};
  for (std::size_t i = 0; i < rig.encoder.size(); ++i)
    if (i / 150 % 4 != 3) cases.back().encoder.push_back(rig.encoder[i]);
  for (std::size_t i = 0; i < rig.camera.size(); ++i)
    if (i / 70 % 3 != 1) cases.back().camera.push_back(rig.camera[i]);
  for (const Case& of : cases) {
    const TimeOffsetSummary summary = solve_time_offset(of.encoder, of.camera, {});
    EXPECT_NEAR(summary.offset_s, rig.offset_s, 4 * summary.offset_sigma_s) << of.name;
    EXPECT_LT(summary.offset_sigma_s, 4e-3) << of.name;
    EXPECT_LT(step_between(summary.X, rig.X).norm(), 1e-2) << of.name;
  }
}

// However the time is cut, what is stated is about the error that is made; where too little is known of it, it is said.
TEST(TimeOffset, FewStretchesDoNotMakeItLookCertain) {
  Random random(38);
  const StreamRig rig = make_streams(random, 40, 0.03);
  const auto solved = [&](double segment_s) {
    TimeOffsetOptions options;
    options.segment_s = segment_s;
    return solve_time_offset(rig.encoder, rig.camera, options);
  };
  const TimeOffsetSummary usual = solved(2), one = solved(60), two = solved(20);
  EXPECT_TRUE(usual.verdict.usable()) << usual.verdict.text();
  EXPECT_EQ(one.segments, 1);
  for (const TimeOffsetSummary* few : {&one, &two}) {
    EXPECT_GT(few->offset_sigma_s, 0.5 * usual.offset_sigma_s);
    EXPECT_LT(few->offset_sigma_s, 4 * usual.offset_sigma_s);
    EXPECT_THAT(few->verdict.text(), AllOf(HasSubstr("too little about the error"), HasSubstr("give --segment 2.")));
  }
}

TEST(TimeOffset, NamesAStreamThatStandsStillOrIsTooSparse) {
  Random random(37);
  const StreamRig rig = make_streams(random, 30, 0.02);
  StreamRig still = rig;
  for (PoseTrack::Sample& sample : still.encoder) sample.pose = rig.encoder.front().pose;
  EXPECT_THAT(input_error([&] { solve_time_offset(still.encoder, rig.camera, {}); }),
              AllOf(HasSubstr("--poses"), HasSubstr("hardly turn"), HasSubstr("to and fro")));
  for (PoseTrack::Sample& sample : still.camera) sample.pose = rig.camera.front().pose;
  EXPECT_THAT(input_error([&] { solve_time_offset(rig.encoder, still.camera, {}); }),
              AllOf(HasSubstr("--camera-poses"), HasSubstr("hardly turn")));
  EXPECT_THAT(input_error([&] { solve_time_offset(rig.encoder, part(rig.camera, 12, 0, 30), {}); }),
              AllOf(HasSubstr("--camera-poses"), HasSubstr("more than 0.2 s apart")));
  EXPECT_THAT(input_error([&] { solve_time_offset(rig.encoder, part(rig.camera, 1, 0, 1.2), {}); }),
              HasSubstr("share less than 3 s"));
}

TEST(PoseStream, TakesOtherUnitsOfTimeAndSaysSo) {
  TempFolder folder;
  const std::string pose = " 0 0 0 0 0 0 1\n";
  const auto read = [&](const std::string& a, const std::string& b) {
    return read_pose_stream(folder.write("s.csv", a + pose + b + pose));
  };
  const std::int64_t ns = 1'487'321'563'180'327'900;
  for (const auto& [a, b, note] : {std::tuple{"1487321563.1803279", "1487321563.2136", ""},
                                   {"1487321563180.3279", "1487321563213.6", "milliseconds"},
                                   {"1487321563180327.9", "1487321563213600", "microseconds"},
                                   {"1487321563180327900", "1487321563213600000", "nanoseconds"}}) {
    const PoseStream stream = read(a, b);
    EXPECT_NEAR(static_cast<double>(stream.samples[0].time.ns - ns), 0, 500) << a;
    EXPECT_NEAR(to_seconds(stream.samples[1].time - stream.samples[0].time), 0.0332721, 1e-6) << a;
    EXPECT_EQ(stream.notes.empty(), std::string(note).empty());
    if (!stream.notes.empty()) {
      EXPECT_THAT(stream.notes[0], AllOf(HasSubstr(note), HasSubstr("--time-unit")));
    }
  }
  EXPECT_EQ(read("1487321563180327901", "1487321563180327903").samples[0].time.ns, 1'487'321'563'180'327'901);
  for (const auto& [a, b] : {std::pair{"0", "0.033"}, {"0", "33"}, {"0", "33000"}, {"0", "33000000"}})
    EXPECT_NEAR(to_seconds(read(a, b).samples[1].time - read(a, b).samples[0].time), 0.033, 1e-12) << b;
  EXPECT_EQ(read_pose_stream(folder / "s.csv", TimeUnit::microsecond).samples[1].time.ns, 33'000'000'000);
  EXPECT_THAT(input_error([&] { read_pose_stream(folder.write("s.csv", "0 0 0 0 0 0 0 1\nx" + pose)); }),
              HasSubstr("s.csv:2"));
}

TEST(PoseStream, KeepsNanosecondsAndNamesLines) {
  TempFolder folder;
  const auto read = [&](const std::string& text) { return read_pose_stream(folder.write("s.csv", text)); };
  const PoseStream stream =
      read("t,x,y,z,qx,qy,qz,qw\n1487321563.180327901, 1,2,3, 0,0,0,1\n1487321563.180327902 1 2 3 0 0 0 1\n");
  ASSERT_EQ(stream.samples.size(), 2u);
  EXPECT_EQ(stream.samples[0].time.ns, 1'487'321'563'180'327'901);
  EXPECT_EQ(read("1 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n").notes.size(), 1u);
  EXPECT_THAT(input_error([&] { read("2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n"); }),
              AllOf(HasSubstr("s.csv:2"), HasSubstr("sort the rows")));
  EXPECT_THAT(input_error([&] { read("1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0\n"); }),
              AllOf(HasSubstr("s.csv:2"), HasSubstr("has 7 fields")));
  EXPECT_THAT(input_error([&] { read("1 0 0 0 0 0 0 2\n"); }), HasSubstr("quaternion has length 2"));
  EXPECT_THAT(input_error([&] { read("1 0 0 nan 0 0 0 1\n"); }), HasSubstr("not a finite number"));
  EXPECT_THAT(input_error([&] { read("\n"); }), HasSubstr("holds no row"));
}

}  // namespace
}  // namespace foresight::time_offset_test
