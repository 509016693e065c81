#include <arpa/inet.h>

#include "child.hpp"
#include "common/error.hpp"
#include "echo.hpp"
#include "link/dds/endpoints.hpp"
#include "link/dds/refusal_watch.hpp"
#include "link/dds/settings.hpp"
#include "link/dds/topic_watch.hpp"
#include "random_message.hpp"
#include "tests/support/private_network.hpp"

namespace foresight::link::dds_test {
namespace {

using namespace std::chrono_literals;
using testing::HasSubstr;

class Dds : public PrivateNetworkTest {};

TEST_F(Dds, SamplesGoFromWriterToReaderAndAreChecked) {
  Participant program(LinkConfig{}, "test");
  const Topic topic{"rt/joint_states", JointStateMessage::kType, Delivery::newest, 8};
  Writer writer(program, topic);
  Reader reader(program, topic);
  ASSERT_TRUE(comes_true([&] { return writer.readers() == 1 && reader.writers() == 1; }));

  JointStateMessage message;
  message.name = {"elbow"};
  message.position = {0.5};
  EXPECT_TRUE(writer.write(message));
  message.position = {NAN};
  EXPECT_TRUE(writer.write(message));
  EXPECT_TRUE(writer.write(Bytes{0, 1, 0, 0, 9, 9, 9}));
  EXPECT_TRUE(writer.write(Bytes{}));
  std::vector<double> positions;
  const auto visit = [&](JointStateMessage&& m, const Sample& sample) {
    EXPECT_NE(sample.writer, 0u);
    positions.push_back(m.position.at(0));
  };
  ASSERT_TRUE(comes_true([&] {
    reader.take<JointStateMessage>({}, visit);
    return positions.size() + program.refused() >= 4;
  }));
  EXPECT_EQ(positions, std::vector<double>{0.5});
  EXPECT_EQ(program.refused(), 3u);
  EXPECT_EQ(program.refusal(), "rt/joint_states: bytes are no such message");
  RefusalWatch log;
  EXPECT_EQ(log.news(program, RobotTime{}),
            "3 messages refused, the last on rt/joint_states: bytes are no such message");
  message.position = {NAN};
  EXPECT_TRUE(writer.write(message));
  ASSERT_TRUE(comes_true([&] { return reader.take<JointStateMessage>({}, visit) > 0; }));
  EXPECT_EQ(log.news(program, RobotTime{} + 9s), "") << "a log is no place for a flood";
  EXPECT_EQ(log.news(program, RobotTime{} + 10s), "1 message refused, the last on rt/joint_states: position[0] is nan");
  EXPECT_EQ(log.news(program, RobotTime{} + 30s), "");
}

TEST_F(Dds, WhoComesLateGetsWhatWasKept) {
  Participant program(LinkConfig{}, "test");
  const Topic topic{"rt/tf_static", TFMessage::kType, Delivery::kept};
  Writer writer(program, topic);
  TFMessage message;
  for (const char* name : {"first", "second"}) {
    message.transforms.resize(1);
    message.transforms[0].child_frame_id = name;
    EXPECT_TRUE(writer.write(message));
  }
  Reader reader(program, topic);
  std::vector<std::string> names;
  ASSERT_TRUE(comes_true([&] {
    reader.take<TFMessage>({}, [&](TFMessage&& m, const Sample&) { names.push_back(m.transforms[0].child_frame_id); });
    return !names.empty();
  }));
  EXPECT_EQ(names, std::vector<std::string>{"second"});
}

// Who listens is told when the last writer goes, comes back, and is there without a word.
TEST_F(Dds, ATopicThatFallsSilentIsTold) {
  Participant program(LinkConfig{}, "test");
  const Topic topic{"rt/x", Header::kType};
  auto writer = std::make_unique<Writer>(program, topic);
  Reader reader(program, topic);
  RobotTime now{};
  TopicWatch watch(topic.name, now);
  EXPECT_EQ(watch.news(0, 0, now + 2 * TopicWatch::kSilent), "") << "nobody has come yet";
  ASSERT_TRUE(comes_true([&] { return reader.writers() == 1; }));
  EXPECT_EQ(watch.news(reader.writers(), 1, now), "");
  EXPECT_EQ(watch.news(1, 0, now + TopicWatch::kSilent - 1ms), "");
  now = now + TopicWatch::kSilent;
  EXPECT_THAT(watch.news(1, 0, now),
              HasSubstr("rt/x is written by a program that is there, but nothing has come for 5"));
  EXPECT_EQ(watch.news(1, 0, now + 2 * TopicWatch::kSilent), "") << "said once";
  EXPECT_EQ(watch.news(1, 1, now), "");
  writer.reset();
  ASSERT_TRUE(comes_true([&] { return reader.writers() == 0; }));
  EXPECT_THAT(watch.news(reader.writers(), 0, now), HasSubstr("nobody writes rt/x any more"));
  EXPECT_EQ(watch.news(0, 0, now), "") << "said once";
  writer = std::make_unique<Writer>(program, topic);
  ASSERT_TRUE(comes_true([&] { return reader.writers() == 1; }));
  EXPECT_EQ(watch.news(reader.writers(), 0, now), "rt/x is written again");
  EXPECT_EQ(watch.news(1, 0, now), "");
}

TEST_F(Dds, RequestsComeEachAndInOrder) {
  Participant program(LinkConfig{}, "test");
  const Topic topic{"rt/requests", Header::kType, Delivery::each};
  Writer writer(program, topic);
  Reader reader(program, topic);
  ASSERT_TRUE(comes_true([&] { return writer.readers() == 1; }));
  Header message;
  for (message.stamp.sec = 0; message.stamp.sec < 500; ++message.stamp.sec) EXPECT_TRUE(writer.write(to_cdr(message)));
  std::vector<int> numbers;
  ASSERT_TRUE(comes_true([&] {
    reader.take([&](const Sample& sample) { numbers.push_back(from_cdr<Header>(sample.cdr)->stamp.sec); });
    return numbers.size() == 500;
  }));
  EXPECT_TRUE(std::is_sorted(numbers.begin(), numbers.end()));
}

TEST_F(Dds, ATopicHasOneType) {
  Participant program(LinkConfig{}, "test");
  Writer writer(program, {"rt/x", Header::kType});
  EXPECT_THAT(
      [&] {
        Reader(program, {"rt/x", TFMessage::kType});
      },
      testing::ThrowsMessage<RuntimeFailure>(HasSubstr("rt/x has the type std_msgs::msg::dds_::Header_ here")));
}

// Our bytes against Cyclone's own reading of the IDL, there and back, through sockets between two processes.
TEST_F(Dds, EveryTypeIsWhatTheIdlSays) {
  const LinkConfig config;
  const Child echo(
      [&] { echo_as_idl_says(config.domain, cyclone_settings(config, granted_receive_buffer()).c_str()); });
  Participant program(config, "test");
  std::mt19937 random(4);
  each_message_type([&]<typename T>() {
    const std::string type = T::kType;
    std::string name = type;
    std::erase(name, ':');
    Writer writer(program, {"in/" + name, type, Delivery::each});
    Reader reader(program, {"out/" + name, type, Delivery::each});
    ASSERT_TRUE(comes_true([&] { return writer.readers() == 1 && reader.writers() == 1; })) << type;
    std::vector<Bytes> sent, back;
    for (int i = 0; i < 20; ++i) {
      sent.push_back(to_cdr(random_message<T>(random)));
      EXPECT_TRUE(writer.write(sent.back()));
    }
    EXPECT_TRUE(comes_true([&] {
      reader.take([&](const Sample& sample) { back.emplace_back(sample.cdr.begin(), sample.cdr.end()); });
      return back.size() == sent.size();
    })) << type
        << ": " << back.size() << " came back";
    for (std::size_t i = 0; i < back.size(); ++i) {
      sent[i].resize((sent[i].size() + 3) / 4 * 4);
      back[i].resize((back[i].size() + 3) / 4 * 4);
      back[i][3] = 0;  // says how many bytes pad to a word
      EXPECT_EQ(back[i], sent[i]) << type;
    }
  });
}

TEST_F(Dds, ProgramsSeeEachOther) {
  const LinkConfig config;
  const Child other([&] {
    Participant program(config, "operator\n of the test");
    Writer writer(program, {"rt/tf", TFMessage::kType});
    for (;;) ::pause();
  });
  Participant program(config, "robot test");
  Reader reader(program, {"rt/tf", TFMessage::kType});
  ASSERT_TRUE(comes_true([&] { return reader.writers() == 1; }));
  const auto peers = program.peers();
  ASSERT_EQ(peers.size(), 2u);
  EXPECT_EQ(peers[0].name, "operator? of the test");
  EXPECT_FALSE(peers[0].own);
  ASSERT_EQ(peers[0].endpoints.size(), 1u);
  EXPECT_EQ(peers[0].endpoints[0].topic, "rt/tf");
  EXPECT_TRUE(peers[0].endpoints[0].writes);
  EXPECT_EQ(peers[1].name, "robot test");
  EXPECT_TRUE(peers[1].own);
  EXPECT_NE(peers[1].host, "");
}

// More endpoints have ended than are looked at in one go: whoever is there now is seen nevertheless.
TEST_F(Dds, ProgramsThatHaveEndedHideNobody) {
  Participant program(LinkConfig{}, "robot test");
  EXPECT_EQ(program.peers().size(), 1u);
  const auto run = [&](const std::string& name, const std::function<void()>& then) {
    Participant other(program, name);
    std::vector<std::unique_ptr<Writer>> writers;
    for (const char* topic : {"rt/a", "rt/b", "rt/c", "rt/d", "rt/e", "rt/f", "rt/g", "rt/h", "rt/i", "rt/j"})
      writers.push_back(std::make_unique<Writer>(other, Topic{topic, Header::kType}));
    then();
  };
  for (int i = 0; i < 60; ++i) run("operator before", [] {});
  run("operator now", [&] {
    ASSERT_TRUE(comes_true([&] { return program.peers().size() == 2; }));
    const Peer peer = program.peers().front();
    EXPECT_EQ(peer.name, "operator now");
    EXPECT_EQ(peer.endpoints.size(), 10u);
  });
}

// A reader that takes nothing, and a whole program that stands still: each write goes on at once, and a third one who
// listens gets what is newest. write() would be false, or never return, where a writer waits for its readers.
TEST_F(Dds, ASlowReaderHoldsUpNobody) {
  const LinkConfig config;
  const Topic topic{"rt/images", CompressedImage::kType};
  const auto never_takes = [&] {
    Participant program(config, "slow");
    Reader reader(program, topic);
    for (;;) ::pause();
  };
  const Child slow(never_takes), stopped(never_takes);
  Participant program(config, "robot");
  Writer writer(program, topic);
  Reader good(program, topic);
  ASSERT_TRUE(comes_true([&] { return writer.readers() == 3; }));
  stopped.pause();
  CompressedImage image;
  image.data.resize(600'000);
  int newest = 0;
  for (int i = 1; i <= 200; ++i) {
    image.header.stamp.sec = i;
    ASSERT_TRUE(writer.write(image)) << i;
    good.take<CompressedImage>({}, [&](CompressedImage&& m, const Sample&) { newest = m.header.stamp.sec; });
    ASSERT_EQ(newest, i);  // both in this process: no wire between them
  }
}

// --- what is wrong --------------------------------------------------------------------------------------------------

auto refused_as(const char* text) {
  return testing::ThrowsMessage<InputError>(HasSubstr(text));
}

TEST_F(Dds, ANetworkThatThereIsNotIsNamed) {
  LinkConfig config;
  config.where = "rig.yaml:7: link";
  config.interface = "eth7";
  EXPECT_THAT([&] { Participant(config, "test"); },
              refused_as("rig.yaml:7: link: there is no network interface 'eth7'"));
  EXPECT_THAT([&] { Participant(config, "test"); }, refused_as("set link.interface to one of lo"));
  config.interface = "lo";
  config.peers = {"no-such-host.invalid"};
  EXPECT_THAT([&] { Participant(config, "test"); }, refused_as("nobody knows the peer 'no-such-host.invalid'"));
}

TEST_F(Dds, PortsInUseAreNamed) {
  LinkConfig config;
  config.domain = 3;
  std::vector<UniqueFd> sockets;
  for (int i = 0; i < 160; ++i) {
    sockets.emplace_back(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(7400 + 250 * config.domain + i));
    ASSERT_EQ(::bind(sockets.back().get(), reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
  }
  EXPECT_THAT([&] { Participant(config, "test"); },
              testing::ThrowsMessage<RuntimeFailure>(testing::AllOf(
                  HasSubstr("the link cannot be opened on domain 3, interface lo"), HasSubstr("another link.domain"))));
}

// Noise, and packets that begin as the protocol's do, at every port of the domain.
TEST_F(Dds, PacketsOfNobodyDoNoHarm) {
  Participant program(LinkConfig{}, "test");
  const Topic topic{"rt/x", Header::kType, Delivery::newest, 8};
  Writer writer(program, topic);
  Reader reader(program, topic);
  ASSERT_TRUE(comes_true([&] { return writer.readers() == 1; }));
  const UniqueFd socket(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0));
  std::mt19937 random(5);
  for (int i = 0; i < 3000; ++i) {
    Bytes packet(random() % 300);
    for (std::uint8_t& byte : packet) byte = static_cast<std::uint8_t>(random());
    const Bytes head = {'R', 'T', 'P', 'S', 2, 1, 1, 16};
    if (i % 2 && packet.size() > 24) {
      std::copy(head.begin(), head.end(), packet.begin());
      packet[20] = static_cast<std::uint8_t>(random() % 24);  // a kind of submessage
    }
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_port = htons(static_cast<std::uint16_t>(7410 + i % 4));
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    ::sendto(socket.get(), packet.data(), packet.size(), 0, reinterpret_cast<const sockaddr*>(&address),
             sizeof address);
  }
  EXPECT_TRUE(writer.write(Header{{1, 2}, "still here"}));
  std::string text;
  EXPECT_TRUE(comes_true([&] {
    reader.take([&](const Sample& sample) { text = from_cdr<Header>(sample.cdr)->frame_id; });
    return text == "still here";
  }));
}

}  // namespace
}  // namespace foresight::link::dds_test
