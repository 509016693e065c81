// Cyclone's handles with owners. Private to link/dds.
#pragma once

#include <dds/dds.h>

#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>

#include "link/dds/participant.hpp"

namespace foresight::link {

/// Owns one of Cyclone's entities; with it go those below it.
class Entity {
 public:
  Entity() = default;
  explicit Entity(dds_entity_t handle) : handle_(handle) {}
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  ~Entity() {
    if (handle_ > 0) dds_delete(handle_);
  }
  dds_entity_t get() const noexcept { return handle_; }

 private:
  dds_entity_t handle_ = 0;
};

struct QosDeleter {
  void operator()(dds_qos_t* qos) const noexcept { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

/// Throws RuntimeFailure with Cyclone's word for `code` where it is one for an error.
dds_entity_t checked(dds_entity_t code, const std::string& what);

/// What happens again and again is told by the last of it, and how often it did. Any thread.
class CountedWords {
 public:
  void note(std::string text);
  std::string last() const;  ///< "" before the first
  std::uint64_t count() const;

 private:
  mutable std::mutex mutex_;
  std::string last_;
  std::uint64_t count_ = 0;
};

/// Takes what Cyclone would print, of all domains of this process, until it ends.
struct Complaints {
  Complaints();
  ~Complaints();
  Complaints(const Complaints&) = delete;
  CountedWords words;
};

struct Participant::State {
  std::shared_ptr<Complaints> complaints;  // the first: it hears what the others' ends complain about
  CountedWords refusals;
  int domain_id = 0;
  std::shared_ptr<PretendedLine> line;  // null: none
  Entity domain, participant;
  /// Readers of who is there. Made when somebody asks first: what they hear of whoever comes and goes is kept until it
  /// is taken, and most programs never ask.
  struct Discovery {
    Entity programs, publications, subscriptions;
  };
  struct UsedTopic {
    Entity topic;
    const struct ddsi_sertype* type = nullptr;
    std::string type_name;
  };
  std::mutex mutex;  // discovery, topics
  std::optional<Discovery> discovery;
  std::map<std::string, UsedTopic> topics;

  const UsedTopic& topic(const Topic& wanted);
  const Discovery& who_is_there();
};

Qos qos_of(const Topic& topic);

}  // namespace foresight::link
