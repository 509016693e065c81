#include <set>

#include "link/messages/message_types.hpp"
#include "random_message.hpp"
#include "tests/support/mutated_bytes.hpp"

namespace foresight::link::cdr_test {
namespace {

using testing::HasSubstr;

// By hand from the specification: what any DDS reads as this JointState.
TEST(Cdr, BytesAreThoseOfTheSpecification) {
  JointStateMessage message;
  message.header.stamp = {1, 2};
  message.header.frame_id = "w";
  message.name = {"elbow"};
  message.position = {1.0};
  const Bytes expected = {0,   1,   0,   0,                        // CDR, little-endian
                          1,   0,   0,   0,   2,   0, 0,    0,     // stamp
                          2,   0,   0,   0,   'w', 0, 0,    0,     // frame_id, then aligned to 4
                          1,   0,   0,   0,   6,   0, 0,    0,     // one name, of 6 bytes
                          'e', 'l', 'b', 'o', 'w', 0, 0,    0,     // aligned to 4
                          1,   0,   0,   0,   0,   0, 0,    0,     // one position, aligned to 8 ...
                          0,   0,   0,   0,   0,   0, 0xF0, 0x3F,  // ... is 1.0
                          0,   0,   0,   0,   0,   0, 0,    0};    // no velocity, no effort
  EXPECT_EQ(to_cdr(message), expected);
}

TEST(Cdr, BigEndianIsRead) {
  const Bytes bytes = {0, 0, 0, 0, 0, 0, 0, 7, 0, 0, 0, 9, 0, 0, 0, 2, 'x', 0};
  const auto header = from_cdr<Header>(bytes);
  ASSERT_TRUE(header);
  EXPECT_EQ(header->stamp.sec, 7);
  EXPECT_EQ(header->stamp.nanosec, 9u);
  EXPECT_EQ(header->frame_id, "x");
}

TEST(Cdr, EveryTypeComesBackToTheBit) {
  std::mt19937 random(1);
  std::set<std::string> seen;
  each_message_type([&]<typename T>() {
    const MessageType* const type = find_message_type(T::kType);
    ASSERT_TRUE(type) << T::kType;
    seen.insert(type->name);
    for (int i = 0; i < 50; ++i) {
      const Bytes bytes = to_cdr(random_message<T>(random));
      const auto again = from_cdr<T>(bytes);
      ASSERT_TRUE(again) << T::kType;
      EXPECT_EQ(to_cdr(*again), bytes) << T::kType;
    }
  });
  EXPECT_EQ(seen.size(), message_types().size()) << "a type that no test knows";
}

TEST(Cdr, NothingIsReadBeyondTheEnd) {
  std::mt19937 random(2);
  each_message_type([&]<typename T>() {
    const Bytes bytes = to_cdr(random_message<T>(random));
    for (std::size_t size = 0; size < bytes.size(); ++size)  // a copy of its own: sanitizers see a byte too far
      EXPECT_FALSE(from_cdr<T>(Bytes(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size))))
          << T::kType << ", " << size << " of " << bytes.size();
  });
}

TEST(Cdr, OtherEncodingsAndLyingCountsAreRefused) {
  Bytes bytes = to_cdr(TFMessage{});
  bytes[1] = 7;  // XCDR2
  EXPECT_FALSE(from_cdr<TFMessage>(bytes));
  for (const std::uint8_t high : {0xFF, 0x7F, 0x00}) {  // of a count; 16 million transforms at least
    const Bytes lie = {0, 1, 0, 0, 0xFF, 0xFF, 0xFF, high};
    EXPECT_FALSE(from_cdr<TFMessage>(lie));
    EXPECT_FALSE(from_cdr<CompressedImage>(lie));
  }
  Bytes longer = to_cdr(Header{});
  longer.resize(longer.size() + 4);
  EXPECT_FALSE(from_cdr<Header>(longer)) << "of a type with more fields";
  const Bytes broken = {0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 'a', 0, 0};
  EXPECT_FALSE(from_cdr<Header>(broken)) << "a text with a 0 in it";
}

TEST(MessageTypes, NamesAndTextsAreThoseOfRos) {
  EXPECT_EQ(ros_name(JointStateMessage::kType), "sensor_msgs/msg/JointState");
  EXPECT_EQ(ros_name("something"), "something");
  JointStateMessage message;
  message.header.stamp = ros_time(1'700'000'000'500'000'000);
  message.name = {"elbow"};
  message.position = {0.5};
  const auto reading = find_message_type(JointStateMessage::kType)->read(to_cdr(message), true);
  EXPECT_EQ(reading.objection, "");
  EXPECT_EQ(reading.stamp_unix_ns, 1'700'000'000'500'000'000);
  EXPECT_THAT(reading.text, HasSubstr("header:\n  stamp:\n    sec: 1700000000\n"));
  EXPECT_THAT(reading.text, HasSubstr("name: ['elbow']\nposition: [0.5]\n"));
  EXPECT_EQ(unix_ns(ros_time(-1)), -1);
}

// --- checks ---------------------------------------------------------------------------------------------------------

StereoFrame good_frame() {
  StereoFrame frame;
  frame.number = 1;
  frame.coding = kJpegCoding;
  frame.joints = {{"elbow", JointSample::kKnown, 0.5}};
  for (CodedImage* image : {&frame.left, &frame.right}) {
    image->capture_ns = 1000;
    image->width = 640;
    image->height = 480;
    image->data = {1, 2, 3};
  }
  return frame;
}

TEST(Checks, AGoodFramePasses) {
  EXPECT_EQ(objection(good_frame(), {1000, {"elbow"}, {{640, 480, 640, 480}}}), "");
}

TEST(Checks, EachFaultOfAFrameIsNamed) {
  const Expected expected{1000, {"elbow", "wrist"}, {{640, 480, 640, 480}}};
  const auto with = [&](auto&& change) {
    StereoFrame frame = good_frame();
    change(frame);
    return objection(frame, expected);
  };
  EXPECT_EQ(with([](StereoFrame& f) { f.joints[0].position = NAN; }), "joints[0].position is nan");
  EXPECT_EQ(with([](StereoFrame& f) { f.joints[0].name = "elbov"; }),
            "joints has 'elbov', which the rig has not; did you mean 'elbow'?");
  EXPECT_EQ(with([](StereoFrame& f) { f.joints.push_back(f.joints[0]); }), "joints has 'elbow' twice");
  EXPECT_EQ(with([](StereoFrame& f) { f.joints[0].status = 9; }), "joints have a status that there is not");
  EXPECT_EQ(with([](StereoFrame& f) { f.left.capture_ns = 500'001'000; }), "left lies 0.5 s in the future");
  EXPECT_EQ(with([](StereoFrame& f) { f.right.width = 320; }),
            "right is 320 x 480 px, but its lens was calibrated at 640 x 480 px");
  EXPECT_EQ(with([](StereoFrame& f) { f.right.height = 1'000'000; }), "right is 640 x 1000000 px");
  EXPECT_EQ(with([](StereoFrame& f) { f.left.data.clear(); }), "left.data is empty");
  EXPECT_EQ(with([](StereoFrame& f) { f.coding = kH264Coding; }), "left.data is not empty");
  EXPECT_EQ(with([](StereoFrame& f) { f.coding = "gif"; }), "coding is 'gif'");
  EXPECT_EQ(with([](StereoFrame& f) { f.left.t_world_camera.orientation.w = 0; }),
            "left.t_world_camera.orientation has the length 0, not 1");
  EXPECT_EQ(with([](StereoFrame& f) { f.left.t_world_camera.position.x = INFINITY; }),
            "left.t_world_camera.position.x is inf");
  EXPECT_EQ(with([](StereoFrame& f) { f.header.stamp.nanosec = 1'000'000'000; }),
            "header.stamp has 1000000000 nanoseconds in a second");
  EXPECT_EQ(with([](StereoFrame& f) { f.quality = "a\x1b[2J"; }), "quality has control characters: 'a?[2J'");
  EXPECT_EQ(with([](StereoFrame& f) { f.coding.assign(5000, 'x'); }), "coding has 5000 characters");
}

TEST(Checks, CountsOfOtherMessagesMustFit) {
  JointStateMessage joints;
  joints.name = {"a", "b"};
  joints.position = {1};
  EXPECT_EQ(objection(joints), "position has 1 values for 2 joints");
  joints.position = {1, 2};
  EXPECT_EQ(objection(joints), "");

  ImageMessage image;
  image.width = image.height = 2;
  image.step = 6;
  image.data.resize(11);
  EXPECT_EQ(objection(image), "data has 11 bytes, where 2 rows of 6 are wanted");
  image.data.resize(12);
  EXPECT_EQ(objection(image), "");

  StereoReport report;
  EXPECT_EQ(objection(report), "");
  report.acknowledgement.resize(1201);
  EXPECT_EQ(objection(report), "acknowledgement has 1201 bytes");

  StereoPiece piece;
  piece.stream = 1;
  EXPECT_EQ(objection(piece), "data has 0 bytes");
  piece.data = {'q'};
  EXPECT_EQ(objection(piece), "");
  piece.stream = 0;
  EXPECT_EQ(objection(piece), "stream is 0");

  TFMessage transforms;
  transforms.transforms.resize(1);
  EXPECT_EQ(objection(transforms), "transforms[0] leads from '' to ''");

  JointTrajectory path;
  path.joint_names = {"a"};
  path.points.resize(1);
  path.points[0].positions = {1, 2};
  EXPECT_EQ(objection(path), "points[0] has 2 values for 1 joints");
}

// --- anybody's bytes ------------------------------------------------------------------------------------------------

// Whatever comes: it decodes or it does not, checks find words for what it is, and what decodes goes out again as the
// same bytes. FORESIGHT_FUZZ_RUNS inputs of each type.
TEST(CdrFuzz, NoBytesDoHarm) {
  std::mt19937 random(3);
  each_message_type([&]<typename T>() {
    const MessageType& type = *find_message_type(T::kType);
    int decoded = 0, good = 0;
    const int runs = fuzz_runs();
    for (int i = 0; i < runs; ++i) {
      Bytes bytes = to_cdr(random_message<T>(random));
      for (std::size_t n = random() % 4; n > 0; --n) mutate(bytes, random);
      const auto message = from_cdr<T>(bytes);
      if (message) {
        ++decoded;
        ASSERT_TRUE(type.round_trips(bytes)) << T::kType;
      }
      const auto reading = type.read(bytes, i % 16 == 0);
      if (reading.objection.empty()) ++good;
      ASSERT_LT(reading.objection.size(), 2 * kMostText);
    }
    EXPECT_GT(decoded, runs / 8) << T::kType;
    EXPECT_LT(good, runs) << T::kType;
  });
}

}  // namespace
}  // namespace foresight::link::cdr_test
