#include "operators/follow_file.hpp"

#include "tests/scene/test_run.hpp"
#include "tests/support/folders.hpp"

namespace foresight::follow_file_test {
namespace {

class FollowFileTest : public testing::Test {
 protected:
  std::string error_of(const std::string& text) {
    const auto file = folder_.write("motion.csv", text);
    return input_error([&] { FollowFile(file, rig_); });
  }
  TempFolder folder_;
  Rig rig_ = read_rig(source_folder() / "configs/minerva.yaml");
};

TEST_F(FollowFileTest, GoesStraightBetweenItsRows) {
  const auto file = folder_.write("motion.csv", "# a nod\ntime_s, elbow, tilt\r\n1,0.5,0\r\n2,1.0,-0.5\n\n4,1,0.5\n");
  const FollowFile follow(file, rig_);
  EXPECT_EQ(follow.duration_s(), 3);
  JointValues q{};
  q[0] = 0.25;
  const auto expect = [&](double t, double elbow, double tilt) {
    follow.at(t, q);
    EXPECT_NEAR(q[3], elbow, 1e-12) << t;
    EXPECT_NEAR(q[9], tilt, 1e-12) << t;
    EXPECT_EQ(q[0], 0.25) << "not in the file";
  };
  expect(-1, 0.5, 0);
  expect(0, 0.5, 0);
  expect(0.5, 0.75, -0.25);
  expect(2, 1, 0);
  expect(9, 1, 0.5);
}

TEST_F(FollowFileTest, SaysHowLongItTakesAndThatItHardlyMoves) {
  const auto words = [&](const char* rows) {
    return words_on_start(FollowFile(folder_.write("motion.csv", std::string("time_s,elbow\n") + rows), rig_));
  };
  const auto takes = [](const char* time) { return testing::HasSubstr(std::string("takes ") + time); };
  EXPECT_THAT(words("0,0\n2,0.5\n4,0\n"), testing::ElementsAre(takes("4.00 s")));
  EXPECT_THAT(words("0,0\n2000,0.5\n4000,0\n"),
              testing::ElementsAre(takes("4000.00 s"), testing::HasSubstr("seconds, not milliseconds")));
  EXPECT_THAT(words("0,0\n2000,0\n2001,0.5\n"), testing::ElementsAre(takes("2001.00 s"))) << "it waits, then moves";
  EXPECT_THAT(words("0,0\n60,0\n"), testing::ElementsAre(takes("60.00 s"))) << "it stands on purpose";
}

TEST_F(FollowFileTest, EveryMistakeHasItsMessage) {
  const auto expect = [&](const char* text, std::initializer_list<const char*> words) {
    const std::string message = error_of(text);
    for (const char* word : words) EXPECT_THAT(message, testing::HasSubstr(word)) << text;
  };
  expect("", {"motion.csv", "no positions"});
  expect("time_s,elbow\n", {"no positions"});
  expect("0,1\n", {"motion.csv:1", "no heading"});
  expect("time_s,elbo\n0,1\n", {"motion.csv:1", "elbo", "'elbow'"});
  expect("time_s,elbow,elbow\n0,1,1\n", {"two columns"});
  expect("time_s,elbow\n0,1,2\n", {"motion.csv:2", "3 fields", "give 2"});
  expect("time_s,elbow\n0,one\n", {"motion.csv:2:3", "elbow is 'one'"});
  expect("time_s,elbow\n0,nan\n", {"motion.csv:2", "nan"});
  expect("time_s,elbow\n0,0\n0,0\n", {"motion.csv:3", "after the row before"});
  expect("time_s,elbow\n0,3\n", {"motion.csv:2:3", "elbow", "beyond its limits"});
  expect("time_s,elbow\n0,0\n0.1,1\n", {"motion.csv:3", "faster than"});
  EXPECT_THAT(input_error([&] { FollowFile("none.csv", rig_); }), testing::HasSubstr("none.csv"));
  EXPECT_THAT(input_error([&] { FollowFile("/dev/null", rig_); }), testing::HasSubstr("not a regular file"));
}

}  // namespace
}  // namespace foresight::follow_file_test
