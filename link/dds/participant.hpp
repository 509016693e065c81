// One program's place on a DDS domain, and who else is there. No header of Cyclone is needed to use it.
#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "common/time.hpp"
#include "link/config/link_config.hpp"
#include "link/keys/keys.hpp"

namespace foresight::link {

class PretendedLine;

/// How samples of a topic get to who reads them. All but `once` are reliable: what a loss takes is sent again while it
/// is still wanted. No writer ever waits for a reader.
enum class Delivery : std::uint8_t {
  newest,  ///< the newest replaces one that has not gone or been read yet: images, states
  kept,    ///< as `newest`; who comes late gets the last one, too: what does not change
  once,    ///< sent once: who writes sees to losses himself, or tells all again soon
  each,    ///< every one, in order, or write() says that it did not go: requests, which are acknowledged
};

struct Topic {
  std::string name;  ///< on DDS: "rt/joint_states"
  std::string type;  ///< on DDS: "sensor_msgs::msg::dds_::JointState_"
  Delivery delivery = Delivery::newest;
  int depth = 1;  ///< of `newest`, `kept` and `once`: samples that a reader may be behind; > 0
};

/// A program on the domain.
struct Peer {
  std::string name;     ///< its role, such as "robot minerva"; its process where it has told none
  std::string host;     ///< "" where it has not told
  std::string process;  ///< "foresight 4711"; "" where it has not told
  std::string id;       ///< of its participant, hexadecimal
  bool own = false;     ///< this program
  struct Endpoint {
    std::string topic, type;
    bool writes = false;
    /// What who reads it should ask for: kept, once, or newest.
    Delivery delivery = Delivery::newest;
  };
  std::vector<Endpoint> endpoints;  ///< by topic
};

/// Any thread. One at a time for each domain in a process, but for those that are made beside it.
class Participant {
 public:
  /// `name`: as others see it, such as "robot minerva". `role`: whose keys it uses, where the link has any. Throws
  /// InputError (no such interface, or one that is down or without an address; a peer whose name nobody knows; what
  /// check_keys() does), RuntimeFailure (the domain's ports are in use, or Cyclone
  /// says no: its words are in it).
  /// `line`: null, or what all samples pass, on their way out and in.
  Participant(const LinkConfig& config, const std::string& name, Role role = Role::observer,
              std::shared_ptr<PretendedLine> line = nullptr);
  /// Another program of the same domain in this process, so that a test or a trial holds both ends of a line: what one
  /// writes is at the other when write() returns. `first` must outlive it.
  Participant(Participant& first, const std::string& name, std::shared_ptr<PretendedLine> line = nullptr);
  ~Participant();

  /// All programs that are heard of, this one included, by name.
  std::vector<Peer> peers() const;
  /// The last thing that Cyclone complained about, such as a packet that makes no sense, and how often it did; "" while
  /// there is nothing.
  std::string trouble() const;
  /// Messages that its readers refused (Reader::refuse), and the last of them in words, with its topic; "" before the
  /// first.
  std::uint64_t refused() const;
  std::string refusal() const;

 private:
  friend class Writer;
  friend class Reader;
  struct State;
  void open(int domain, const void* qos);
  std::unique_ptr<State> state_;
};

/// Who else speaks as a robot on the domain: "'robot minerva' on lab1"; "" where nobody does. Nobody may speak beside
/// it, as an operator would see the one and move the other.
std::string robot_beside(const Participant& program);
/// After so long a participant has heard of all that were there before it, on any line that this is for.
inline constexpr Duration kAllHeardOf = std::chrono::seconds(1);

/// Why images would be lost for the size of the kernel's receive buffers, and what to type about it; "" where they are
/// large enough.
std::string receive_buffer_trouble();

}  // namespace foresight::link
