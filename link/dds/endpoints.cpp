#include "link/dds/endpoints.hpp"

#include <map>

#include "link/dds/cyclone.hpp"
#include "link/dds/pretended_line.hpp"
#include "link/dds/raw_type.hpp"

namespace foresight::link {

struct Writer::State {
  Entity writer;
  const ddsi_sertype* type = nullptr;
  std::shared_ptr<PretendedLine> line;
  bool repaired = false;

  bool write(Bytes cdr) const noexcept {
    return dds_writecdr(writer.get(), new_raw_sample(type, std::move(cdr))) == DDS_RETCODE_OK;
  }
};

Writer::Writer(Participant& participant, const Topic& topic) : state_(std::make_shared<State>()) {
  const auto& used = participant.state_->topic(topic);
  state_->type = used.type;
  state_->line = participant.state_->line;
  state_->repaired = topic.delivery != Delivery::once;
  state_->writer = Entity(
      checked(dds_create_writer(participant.state_->participant.get(), used.topic.get(), qos_of(topic).get(), nullptr),
              "topic " + topic.name + " cannot be written"));
}

Writer::~Writer() = default;

bool Writer::write(Bytes cdr) noexcept {
  // What nobody reads takes nothing of the line.
  if (!state_->line || readers() == 0) return state_->write(std::move(cdr));
  const std::size_t bytes = cdr.size();
  state_->line->send(bytes, state_->repaired, [weak = std::weak_ptr(state_), cdr = std::move(cdr)]() mutable {
    if (const auto state = weak.lock()) state->write(std::move(cdr));
  });
  return true;
}

std::size_t Writer::readers() const noexcept {
  dds_publication_matched_status_t status{};
  dds_get_publication_matched_status(state_->writer.get(), &status);
  return status.current_count;
}

struct Reader::State {
  using Owner = std::unique_ptr<ddsi_serdata, void (*)(ddsi_serdata*)>;
  struct Held {
    Owner sample;
    dds_sample_info_t info;
  };
  static constexpr std::size_t kMostHeld = 64U << 20;  // bytes

  Entity reader, waiting;
  CountedWords* refusals = nullptr;  // the participant's
  std::shared_ptr<PretendedLine> line;
  bool repaired = false;
  std::size_t room = SIZE_MAX;          // that samples which are there may take before the oldest goes, as DDS has it
  std::multimap<RobotTime, Held> held;  // on their way over the line, by arrival
  std::size_t held_bytes = 0;

  void each_that_came(const std::function<void(Owner, const dds_sample_info_t&)>& visit) const;
  void take_in();
  bool is_due() const { return !held.empty() && held.begin()->first <= line->now(); }
  Held pop();
};

void Reader::State::each_that_came(const std::function<void(Owner, const dds_sample_info_t&)>& visit) const {
  constexpr std::uint32_t kAtOnce = 32;
  for (;;) {
    std::array<ddsi_serdata*, kAtOnce> samples{};
    std::array<dds_sample_info_t, kAtOnce> infos;
    const dds_return_t count = dds_takecdr(reader.get(), samples.data(), kAtOnce, infos.data(), DDS_ANY_STATE);
    if (count <= 0) return;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      Owner owner(samples[i], [](ddsi_serdata* sample) { ddsi_serdata_unref(sample); });
      if (infos[i].valid_data) visit(std::move(owner), infos[i]);  // else a writer that ended
    }
  }
}

/// What has come over the network begins to cross the pretended line.
void Reader::State::take_in() {
  each_that_came([this](Owner sample, const dds_sample_info_t& info) {
    const std::size_t bytes = raw_bytes(sample.get()).size();
    const auto there = line->receive(bytes, repaired);
    if (!there || held_bytes + bytes > kMostHeld) return;
    held_bytes += bytes;
    held.emplace(*there, Held{std::move(sample), info});
  });
}

Reader::State::Held Reader::State::pop() {
  Held out = std::move(held.begin()->second);
  held.erase(held.begin());
  held_bytes -= raw_bytes(out.sample.get()).size();
  return out;
}

Reader::Reader(Participant& participant, const Topic& topic) : state_(std::make_unique<State>()), topic_(topic.name) {
  const auto& used = participant.state_->topic(topic);
  const dds_entity_t under = participant.state_->participant.get();
  state_->refusals = &participant.state_->refusals;
  state_->line = participant.state_->line;
  state_->repaired = topic.delivery != Delivery::once;
  if (topic.delivery != Delivery::each) state_->room = static_cast<std::size_t>(topic.depth);
  state_->reader = Entity(checked(dds_create_reader(under, used.topic.get(), qos_of(topic).get(), nullptr),
                                  "topic " + topic.name + " cannot be read"));
  checked(dds_set_status_mask(state_->reader.get(), DDS_DATA_AVAILABLE_STATUS), "topic " + topic.name);
  state_->waiting = Entity(checked(dds_create_waitset(under), "topic " + topic.name));
  checked(dds_waitset_attach(state_->waiting.get(), state_->reader.get(), 0), "topic " + topic.name);
}

Reader::~Reader() = default;

std::size_t Reader::take(const std::function<void(const Sample&)>& visit) {
  std::size_t visited = 0;
  const auto show = [&](const ddsi_serdata* sample, const dds_sample_info_t& info) {
    ++visited;
    visit({raw_bytes(sample), info.source_timestamp, info.publication_handle});
  };
  if (!state_->line) {
    state_->each_that_came([&](State::Owner sample, const dds_sample_info_t& info) { show(sample.get(), info); });
    return visited;
  }
  state_->take_in();
  const auto due = [&] {
    return static_cast<std::size_t>(std::distance(state_->held.begin(), state_->held.upper_bound(state_->line->now())));
  };
  for (std::size_t n = due(); n > 0; --n) {
    const State::Held one = state_->pop();
    if (n <= state_->room) show(one.sample.get(), one.info);
  }
  return visited;
}

bool Reader::wait(Duration timeout) const noexcept {
  const auto came = [this](Duration time) {
    return dds_waitset_wait(state_->waiting.get(), nullptr, 0, std::max<std::int64_t>(0, time.count())) > 0;
  };
  if (!state_->line) return came(timeout);
  const RobotTime end = state_->line->now() + timeout;
  for (;;) {
    state_->take_in();
    if (state_->is_due()) return true;
    const RobotTime now = state_->line->now();
    if (now >= end) return false;
    const RobotTime next = state_->held.empty() ? end : std::min(end, state_->held.begin()->first);
    if (came(next - now) && waits_for_others_) return true;
  }
}

void Reader::wait_also_for(const Reader& other) {
  checked(dds_waitset_attach(state_->waiting.get(), other.state_->reader.get(), 0), "topic " + other.topic_);
  waits_for_others_ = true;
}

std::size_t Reader::writers() const noexcept {
  dds_subscription_matched_status_t status{};
  dds_get_subscription_matched_status(state_->reader.get(), &status);
  return status.current_count;
}

std::uint64_t Reader::lost() const noexcept {
  dds_sample_lost_status_t status{};
  dds_get_sample_lost_status(state_->reader.get(), &status);
  return status.total_count;
}

void Reader::refuse(const std::string& why) {
  state_->refusals->note(topic_ + ": " + why);
}

}  // namespace foresight::link
