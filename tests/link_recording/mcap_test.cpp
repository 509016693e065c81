// MCAP as it is written and read, whole, cut off and damaged.
#include <zlib.h>

#include <cstring>
#include <random>
#include <sstream>

#include "common/error.hpp"
#include "link/recording/mcap_reader.hpp"
#include "link/recording/mcap_writer.hpp"

#include <gmock/gmock.h>

namespace foresight::link::mcap_test {
namespace {

using Bytes = std::vector<std::uint8_t>;
using testing::HasSubstr;

struct Seen {
  std::string topic, type;
  std::uint32_t sequence = 0;
  std::int64_t log_ns = 0, publish_ns = 0;
  Bytes data;
  bool operator==(const Seen&) const = default;
};

struct Content {
  std::vector<Seen> messages;
  std::map<std::string, Bytes> attachments;
  std::map<std::string, std::map<std::string, std::string>> metadata;
  McapOutcome outcome;
};

Content read(std::span<const std::uint8_t> bytes) {
  std::istringstream stream(std::string(bytes.begin(), bytes.end()));
  Content out;
  McapVisitor visitor;
  visitor.message = [&](const McapMessage& m) {
    out.messages.push_back(
        {m.channel.topic, m.channel.schema->name, m.sequence, m.log_ns, m.publish_ns, {m.data.begin(), m.data.end()}});
    return true;
  };
  visitor.attachment = [&](const std::string& name, const std::string&, Bytes data) { out.attachments[name] = data; };
  visitor.metadata = [&](const std::string& name, const auto& texts) { out.metadata[name] = texts; };
  out.outcome = read_mcap(stream, "a.mcap", visitor);
  return out;
}

/// Two topics, three chunks (the middle one does not get smaller), an attachment and metadata at both ends.
struct Written {
  Bytes bytes;
  std::vector<Seen> messages;
  std::vector<std::size_t> good;  // good_bytes() behind each chunk

  Written() {
    McapWriter writer([&](std::span<const std::uint8_t> more) { bytes.insert(bytes.end(), more.begin(), more.end()); },
                      "ros2", "test");
    const std::string file = "a rig";
    writer.add_attachment("rig/a.yaml", "text/plain", 5, {reinterpret_cast<const std::uint8_t*>(file.data()), 5});
    writer.add_metadata("facts", {{"rig", "rig/a.yaml"}, {"empty", ""}});
    const auto joints = writer.add_schema("sensor_msgs/msg/JointState", "ros2msg", "string name\n");
    const auto strange = writer.add_schema("who/knows", "", "");
    const std::array channels{writer.add_channel(joints, "/joint_states", {{"kept", "no"}}),
                              writer.add_channel(strange, "/strange", {})};
    std::mt19937 random(1);
    for (std::uint32_t i = 0; i < 30; ++i) {
      const bool dense = i >= 10 && i < 20;
      Bytes data(dense ? 400 : 60, 7);
      if (dense)
        for (std::uint8_t& byte : data) byte = static_cast<std::uint8_t>(random());
      const std::size_t channel = i % 3 == 0 ? 1 : 0;
      writer.add_message(channels[channel], i, 100 + i, 90 + i, data);
      messages.push_back({channel ? "/strange" : "/joint_states", channel ? "who/knows" : "sensor_msgs/msg/JointState",
                          i, 100 + i, 90 + i, data});
      if (i % 10 != 9) continue;
      writer.close_chunk();
      good.push_back(writer.good_bytes());
    }
    writer.add_metadata("end", {});
    writer.finish();
    EXPECT_EQ(writer.good_bytes(), bytes.size());
  }
};

TEST(Mcap, WhatIsWrittenIsRead) {
  const Written written;
  const Content content = read(written.bytes);
  EXPECT_TRUE(content.outcome.whole) << content.outcome.trouble;
  EXPECT_EQ(content.outcome.messages, 30u);
  EXPECT_EQ(content.messages, written.messages);
  EXPECT_EQ(content.attachments.at("rig/a.yaml"), (Bytes{'a', ' ', 'r', 'i', 'g'}));
  EXPECT_EQ(content.metadata.at("facts").at("rig"), "rig/a.yaml");
  EXPECT_TRUE(content.metadata.contains("end"));
}

template <typename T>
T number(const Bytes& bytes, std::size_t at) {
  T out{};
  EXPECT_LE(at + sizeof(T), bytes.size());
  std::memcpy(&out, bytes.data() + at, sizeof(T));
  return out;
}

// By the specification alone, from the end backwards, as a reader does that seeks.
TEST(Mcap, SummaryIndicesAndChecksumsAreThoseOfTheSpecification) {
  const Written written;
  const Bytes& b = written.bytes;
  const std::size_t footer = b.size() - 8 - 29;
  ASSERT_EQ(b[footer], 0x02);
  const auto summary = number<std::uint64_t>(b, footer + 9), offsets = number<std::uint64_t>(b, footer + 17);
  const auto crc = number<std::uint32_t>(b, footer + 25);
  EXPECT_EQ(crc, ::crc32(0, b.data() + summary, static_cast<unsigned>(footer + 25 - summary)));
  EXPECT_EQ(b[summary - 13], 0x0F);  // DataEnd

  std::map<int, int> records;
  std::size_t chunks = 0;
  for (std::size_t at = summary; at < offsets; at += 9 + number<std::uint64_t>(b, at + 1)) {
    ++records[b[at]];
    if (b[at] == 0x0B) {
      EXPECT_EQ(number<std::uint64_t>(b, at + 9), 30u);  // messages
      EXPECT_EQ(number<std::uint16_t>(b, at + 17), 2u);  // schemas
      EXPECT_EQ(number<std::uint32_t>(b, at + 19), 2u);  // channels
      EXPECT_EQ(number<std::uint32_t>(b, at + 31), 3u);  // chunks
      EXPECT_EQ(number<std::int64_t>(b, at + 35), 100);  // first and last
      EXPECT_EQ(number<std::int64_t>(b, at + 43), 129);
      EXPECT_EQ(number<std::uint64_t>(b, at + 51 + 4 + 2), 20u);  // of channel 1
    }
    if (b[at] != 0x08) continue;
    const auto place = number<std::uint64_t>(b, at + 25), length = number<std::uint64_t>(b, at + 33);
    EXPECT_EQ(b[place], 0x06);
    EXPECT_EQ(number<std::uint64_t>(b, place + 1) + 9, length);
    EXPECT_EQ(number<std::int64_t>(b, place + 9), number<std::int64_t>(b, at + 9));
    const auto map_bytes = number<std::uint32_t>(b, at + 41);
    EXPECT_EQ(map_bytes, 20u);
    const std::size_t index = number<std::uint64_t>(b, at + 47);
    EXPECT_EQ(index, place + length) << "indices follow their chunk";
    EXPECT_EQ(b[index], 0x07);
    EXPECT_EQ(number<std::uint64_t>(b, at + 45 + map_bytes) + place + length, written.good[chunks++]);
    const bool compressed = number<std::uint32_t>(b, place + 9 + 28) == 4;
    EXPECT_EQ(compressed, chunks != 2) << "only where it saves something";
    if (compressed) continue;
    const std::size_t content = place + 9 + 28 + 4 + 8;  // the message that its index tells, in the chunk
    const std::size_t message = content + number<std::uint64_t>(b, index + 9 + 2 + 4 + 8);
    EXPECT_EQ(b[message], 0x05);
    EXPECT_EQ(number<std::int64_t>(b, message + 15), number<std::int64_t>(b, index + 9 + 2 + 4));
  }
  EXPECT_EQ(records, (std::map<int, int>{{3, 2}, {4, 2}, {8, 3}, {10, 1}, {11, 1}, {13, 2}}));
  std::size_t group = offsets;
  for (; b[group] == 0x0E; group += 26) {
    const auto begin = number<std::uint64_t>(b, group + 10), length = number<std::uint64_t>(b, group + 18);
    EXPECT_EQ(b[begin], b[group + 9]);
    EXPECT_LE(begin + length, offsets);
  }
  EXPECT_EQ(group, footer);
}

TEST(Mcap, AFileThatIsCutAnywhereGivesAllWholeChunks) {
  const Written written;
  for (std::size_t length = 0; length < written.bytes.size(); ++length) {
    const std::span<const std::uint8_t> cut(written.bytes.data(), length);
    if (length < 8) {
      EXPECT_THROW(read(cut), InputError) << length;
      continue;
    }
    const Content content = read(cut);
    EXPECT_FALSE(content.outcome.whole) << length;
    EXPECT_THAT(content.outcome.trouble, HasSubstr("the file ends"));
    std::size_t chunks = 0;
    while (chunks < written.good.size() && written.good[chunks] <= length) ++chunks;
    EXPECT_GE(content.messages.size(), 10 * chunks) << length;
    ASSERT_LE(content.messages.size(), written.messages.size());
    EXPECT_TRUE(std::equal(content.messages.begin(), content.messages.end(), written.messages.begin())) << length;
  }
}

// Whatever the bytes are, nothing is told that was not written under its checksum, and no room is made for what is not
// there (a chunk that says 64 MiB would be seen in the time this takes).
TEST(Mcap, DamagedFilesNeitherCrashNorLie) {
  const Written written;
  std::mt19937 random(2);
  std::uint64_t troubled = 0;
  const int rounds = std::getenv("FORESIGHT_LONG") ? 1'000'000 : 20'000;
  for (int i = 0; i < rounds; ++i) {
    Bytes bytes = written.bytes;
    for (int changes = 1 + static_cast<int>(random() % 4); changes > 0; --changes) {
      const std::size_t at = 8 + random() % (bytes.size() - 8);
      if (random() % 3 == 0)
        bytes.resize(std::max<std::size_t>(at, 9));
      else
        bytes[at % bytes.size()] = static_cast<std::uint8_t>(random());
      if (bytes.size() <= 9) break;
    }
    try {
      const Content content = read(bytes);
      troubled += content.outcome.trouble.empty() ? 0 : 1;
      EXPECT_EQ(content.outcome.whole, content.outcome.trouble.empty());
      for (const Seen& seen : content.messages) {
        ASSERT_LT(seen.sequence, written.messages.size());
        EXPECT_EQ(seen.data, written.messages[seen.sequence].data);
      }
    } catch (const InputError&) {  // the magic
      ++troubled;
    }
  }
  EXPECT_GT(troubled, static_cast<std::uint64_t>(rounds / 2));
}

TEST(Mcap, ChunksThatNobodyWantsArePassedOver) {
  const Written written;
  std::istringstream stream(std::string(written.bytes.begin(), written.bytes.end()));
  std::vector<std::int64_t> ends, seen;
  McapVisitor visitor;
  visitor.wants_chunk = [&](std::int64_t end_ns, std::span<const McapChannel* const> channels) {
    EXPECT_EQ(channels.size(), 2u);
    EXPECT_EQ(channels[1]->topic, "/strange");
    ends.push_back(end_ns);
    return end_ns > 110 && end_ns < 125;
  };
  visitor.message = [&](const McapMessage& message) {
    seen.push_back(message.log_ns);
    return true;
  };
  EXPECT_TRUE(read_mcap(stream, "a.mcap", visitor).whole);
  EXPECT_EQ(ends, (std::vector<std::int64_t>{109, 119, 129}));
  ASSERT_EQ(seen.size(), 10u);
  EXPECT_EQ(seen.front(), 110);
}

TEST(Mcap, WhatIsNoMcapIsNamed) {
  const std::string text = "time_s,elbow\n0,0.2\n";
  const auto words = [](std::span<const std::uint8_t> bytes) {
    try {
      read(bytes);
    } catch (const InputError& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  EXPECT_THAT(words({reinterpret_cast<const std::uint8_t*>(text.data()), text.size()}),
              HasSubstr("a.mcap: is no MCAP"));
  Bytes other = Written().bytes;
  other[5] = '1';
  EXPECT_THAT(words(other), HasSubstr("is an MCAP of another version"));
}

// A disk that fails in the middle of a chunk: the file goes on behind the last whole one, and is a whole file.
TEST(Mcap, AfterAFailureTheFileIsFinishedBehindWhatIsWhole) {
  Bytes bytes;
  bool fails = false;
  McapWriter writer(
      [&](std::span<const std::uint8_t> more) {
        if (fails) more = more.first(more.size() / 2);
        bytes.insert(bytes.end(), more.begin(), more.end());
        if (fails) throw std::runtime_error("full");
      },
      "ros2", "test");
  const auto channel = writer.add_channel(writer.add_schema("a", "", ""), "/a", {});
  const auto put_chunk = [&](std::uint32_t from) {
    for (std::uint32_t i = from; i < from + 5; ++i) writer.add_message(channel, i, i, i, Bytes(10, 1));
    writer.close_chunk();
  };
  put_chunk(1);
  fails = true;
  EXPECT_THROW(put_chunk(6), std::runtime_error);
  fails = false;
  bytes.resize(writer.good_bytes());
  writer.go_on_behind_good();
  writer.finish();
  const Content content = read(bytes);
  EXPECT_TRUE(content.outcome.whole) << content.outcome.trouble;
  EXPECT_EQ(content.messages.size(), 5u);
}

}  // namespace
}  // namespace foresight::link::mcap_test
