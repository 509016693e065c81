// A program on another DDS, eProsima's Fast DDS, with types that its own compiler made of our IDL: it listens to a
// robot as a lab's tools would, and says what it heard. Built and run by scripts/test-line.
//
//   listener DOMAIN SECONDS [set-points]
//
// With "set-points" it also writes set-points of its own, far from everything, on the robot's topic: nothing may move.
// Prints one line for each kind of message with its count and the last one's contents. Exit code: 0 where all kinds
// came and were whole, else 1.
#include <fastdds/rtps/transport/UDPv4TransportDescriptor.h>
#include <fastrtps/utils/IPLocator.h>
#include <fastdds/dds/domain/DomainParticipant.hpp>
#include <fastdds/dds/domain/DomainParticipantFactory.hpp>
#include <fastdds/dds/publisher/DataWriter.hpp>
#include <fastdds/dds/publisher/Publisher.hpp>
#include <fastdds/dds/subscriber/DataReader.hpp>
#include <fastdds/dds/subscriber/SampleInfo.hpp>
#include <fastdds/dds/subscriber/Subscriber.hpp>
#include <fastdds/dds/topic/TypeSupport.hpp>

#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>
#include <string>
#include <thread>

#include "ros_messagesPubSubTypes.h"

namespace fast = eprosima::fastdds::dds;
namespace rtps = eprosima::fastrtps::rtps;

namespace {

/// One loopback, no multicast, as the robot's.
fast::DomainParticipant* join(std::uint32_t domain) {
  fast::DomainParticipantQos qos;
  qos.name("a stranger on Fast DDS");
  const auto udp = std::make_shared<eprosima::fastdds::rtps::UDPv4TransportDescriptor>();
  udp->interfaceWhiteList.emplace_back("127.0.0.1");
  udp->maxInitialPeersRange = 32;
  udp->receiveBufferSize = 4'000'000;
  qos.transport().use_builtin_transports = false;
  qos.transport().user_transports.push_back(udp);
  rtps::Locator_t peer;
  rtps::IPLocator::setIPv4(peer, 127, 0, 0, 1);
  qos.wire_protocol().builtin.initialPeersList.push_back(peer);
  return fast::DomainParticipantFactory::get_instance()->create_participant(domain, qos);
}

/// Reads one topic; `Type`: what fastddsgen made.
template <typename Message, typename Type>
class Ear {
 public:
  Ear(fast::DomainParticipant& participant, const std::string& topic, bool kept = false) {
    fast::TypeSupport type(new Type);
    type.register_type(&participant);
    fast::Topic* const on = participant.create_topic(topic, type.get_type_name(), fast::TOPIC_QOS_DEFAULT);
    fast::DataReaderQos qos;
    qos.reliability().kind = fast::RELIABLE_RELIABILITY_QOS;
    qos.durability().kind = kept ? fast::TRANSIENT_LOCAL_DURABILITY_QOS : fast::VOLATILE_DURABILITY_QOS;
    qos.history().depth = 64;
    reader_ = participant.create_subscriber(fast::SUBSCRIBER_QOS_DEFAULT)->create_datareader(on, qos);
  }
  void listen() {
    fast::SampleInfo info;
    Message message;
    while (reader_->take_next_sample(&message, &info) == ReturnCode_t::RETCODE_OK)
      if (info.valid_data) {
        last = message;
        ++count;
      }
  }

  int count = 0;
  Message last;

 private:
  using ReturnCode_t = eprosima::fastrtps::types::ReturnCode_t;
  fast::DataReader* reader_ = nullptr;
};

using JointState = sensor_msgs::msg::dds_::JointState_;
using Transforms = tf2_msgs::msg::dds_::TFMessage_;
using Image = sensor_msgs::msg::dds_::CompressedImage_;
using Path = trajectory_msgs::msg::dds_::JointTrajectory_;

bool whole(const Image& image) {  // begins and ends as a JPEG does
  const auto& d = image.data();
  return d.size() > 4 && d[0] == 0xFF && d[1] == 0xD8 && d[d.size() - 2] == 0xFF && d[d.size() - 1] == 0xD9;
}

bool unit(const Transforms& transforms) {
  for (const auto& t : transforms.transforms()) {
    const auto& q = t.transform().rotation();
    if (std::abs(q.x() * q.x() + q.y() * q.y() + q.z() * q.z() + q.w() * q.w() - 1) > 1e-6) return false;
  }
  return !transforms.transforms().empty();
}

/// Writes what nobody asked for.
class Stranger {
 public:
  explicit Stranger(fast::DomainParticipant& participant) {
    fast::TypeSupport type(new trajectory_msgs::msg::dds_::JointTrajectory_PubSubType);
    type.register_type(&participant);
    fast::Topic* const on =
        participant.create_topic("rt/foresight/set_points", type.get_type_name(), fast::TOPIC_QOS_DEFAULT);
    writer_ =
        participant.create_publisher(fast::PUBLISHER_QOS_DEFAULT)->create_datawriter(on, fast::DATAWRITER_QOS_DEFAULT);
  }
  void write(const JointState& joints) {
    Path path;
    path.joint_names(joints.name());
    path.points().resize(1);
    for (const double position : joints.position()) path.points()[0].positions().push_back(position + 0.5);
    writer_->write(&path);
  }

 private:
  fast::DataWriter* writer_ = nullptr;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc < 3) return std::fprintf(stderr, "listener DOMAIN SECONDS [set-points]\n"), 2;
  fast::DomainParticipant* const participant = join(static_cast<std::uint32_t>(std::atoi(argv[1])));
  if (!participant) return std::fprintf(stderr, "listener: cannot join\n"), 1;
  Ear<JointState, sensor_msgs::msg::dds_::JointState_PubSubType> joints(*participant, "rt/joint_states");
  Ear<Transforms, tf2_msgs::msg::dds_::TFMessage_PubSubType> transforms(*participant, "rt/tf");
  Ear<Transforms, tf2_msgs::msg::dds_::TFMessage_PubSubType> fixed(*participant, "rt/tf_static", true);
  Ear<Image, sensor_msgs::msg::dds_::CompressedImage_PubSubType> left(*participant, "rt/left/image_raw/compressed");
  Ear<Image, sensor_msgs::msg::dds_::CompressedImage_PubSubType> right(*participant, "rt/right/image_raw/compressed");
  std::unique_ptr<Stranger> stranger;
  if (argc > 3) stranger = std::make_unique<Stranger>(*participant);

  bool all_whole = true;
  const auto end = std::chrono::steady_clock::now() + std::chrono::seconds(std::atoi(argv[2]));
  while (std::chrono::steady_clock::now() < end) {
    joints.listen();
    const int before = transforms.count;
    transforms.listen();
    if (transforms.count > before) all_whole &= unit(transforms.last);
    fixed.listen();
    const int images = left.count + right.count;
    left.listen();
    right.listen();
    if (left.count + right.count > images)
      all_whole &= (left.count == 0 || whole(left.last)) && (right.count == 0 || whole(right.last));
    if (stranger && joints.count > 0) stranger->write(joints.last);
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::printf("joint_states %d:", joints.count);
  for (std::size_t i = 0; i < joints.last.name().size() && i < joints.last.position().size(); ++i)
    std::printf(" %s=%.3f", joints.last.name()[i].c_str(), joints.last.position()[i]);
  std::printf("\ntf %d: %zu transforms\ntf_static %d: %zu transforms\n", transforms.count,
              transforms.last.transforms().size(), fixed.count, fixed.last.transforms().size());
  std::printf("left %d: %zu bytes, %s\nright %d: %zu bytes, %s\n", left.count, left.last.data().size(),
              left.last.header().frame_id().c_str(), right.count, right.last.data().size(),
              right.last.header().frame_id().c_str());
  const bool came = joints.count && transforms.count && fixed.count && left.count && right.count;
  std::printf("%s\n", !came ? "something never came" : all_whole ? "all whole" : "something was damaged");
  std::fflush(stdout);
  std::_Exit(came && all_whole ? 0 : 1);  // Fast DDS's own end may take seconds
}
