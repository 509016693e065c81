#include "echo.hpp"

#include <dds/dds.h>

#include <string>
#include <vector>

#include "foresight_msgs.h"
#include "ros_messages.h"

namespace foresight::link {
namespace {

const dds_topic_descriptor_t* const kTypes[] = {&sensor_msgs_msg_dds__JointState__desc,
                                                &tf2_msgs_msg_dds__TFMessage__desc,
                                                &geometry_msgs_msg_dds__PoseStamped__desc,
                                                &geometry_msgs_msg_dds__Twist__desc,
                                                &sensor_msgs_msg_dds__Image__desc,
                                                &sensor_msgs_msg_dds__CompressedImage__desc,
                                                &sensor_msgs_msg_dds__CameraInfo__desc,
                                                &trajectory_msgs_msg_dds__JointTrajectory__desc,
                                                &diagnostic_msgs_msg_dds__DiagnosticArray__desc,
                                                &foresight_msgs_msg_dds__StereoFrame__desc,
                                                &foresight_msgs_msg_dds__StereoPiece__desc,
                                                &foresight_msgs_msg_dds__StereoReport__desc,
                                                &foresight_msgs_msg_dds__GateMotion__desc,
                                                &foresight_msgs_msg_dds__RobotState__desc};

/// Topics may not have colons.
std::string plain(std::string name) {
  std::erase(name, ':');
  return name;
}

struct Pipe {
  dds_entity_t reader, writer;
};

}  // namespace

void echo_as_idl_says(int domain, const char* settings) {
  const auto id = static_cast<dds_domainid_t>(domain);
  dds_create_domain(id, settings);
  const dds_entity_t participant = dds_create_participant(id, nullptr, nullptr);
  dds_qos_t* const qos = dds_create_qos();
  dds_qset_reliability(qos, DDS_RELIABILITY_RELIABLE, 0);
  dds_qset_history(qos, DDS_HISTORY_KEEP_ALL, DDS_LENGTH_UNLIMITED);
  std::vector<Pipe> pipes;
  for (const dds_topic_descriptor_t* type : kTypes) {
    const auto topic = [&](const char* way) {
      return dds_create_topic(participant, type, (way + plain(type->m_typename)).c_str(), nullptr, nullptr);
    };
    pipes.push_back({dds_create_reader(participant, topic("in/"), qos, nullptr),
                     dds_create_writer(participant, topic("out/"), qos, nullptr)});
  }
  for (;;) {
    for (const Pipe& pipe : pipes) {
      // Who listens may know of us before we know of them: what was written then would be lost.
      dds_publication_matched_status_t matched{};
      if (dds_get_publication_matched_status(pipe.writer, &matched) != DDS_RETCODE_OK || matched.current_count == 0)
        continue;
      void* sample = nullptr;
      dds_sample_info_t info;
      while (dds_take(pipe.reader, &sample, &info, 1, 1) == 1) {
        if (info.valid_data) dds_write(pipe.writer, sample);
        dds_return_loan(pipe.reader, &sample, 1);
      }
    }
    dds_sleepfor(DDS_MSECS(2));
  }
}

}  // namespace foresight::link
