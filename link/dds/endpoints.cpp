#include "link/dds/endpoints.hpp"

#include "link/dds/cyclone.hpp"
#include "link/dds/raw_type.hpp"

namespace foresight::link {

struct Writer::State {
  Entity writer;
  const ddsi_sertype* type = nullptr;
};

Writer::Writer(Participant& participant, const Topic& topic) : state_(std::make_unique<State>()) {
  const auto& used = participant.state_->topic(topic);
  state_->type = used.type;
  state_->writer = Entity(
      checked(dds_create_writer(participant.state_->participant.get(), used.topic.get(), qos_of(topic).get(), nullptr),
              "topic " + topic.name + " cannot be written"));
}

Writer::~Writer() = default;

bool Writer::write(Bytes cdr) noexcept {
  return dds_writecdr(state_->writer.get(), new_raw_sample(state_->type, std::move(cdr))) == DDS_RETCODE_OK;
}

std::size_t Writer::readers() const noexcept {
  dds_publication_matched_status_t status{};
  dds_get_publication_matched_status(state_->writer.get(), &status);
  return status.current_count;
}

struct Reader::State {
  Entity reader, waiting;
};

Reader::Reader(Participant& participant, const Topic& topic) : state_(std::make_unique<State>()), topic_(topic.name) {
  const auto& used = participant.state_->topic(topic);
  const dds_entity_t under = participant.state_->participant.get();
  state_->reader = Entity(checked(dds_create_reader(under, used.topic.get(), qos_of(topic).get(), nullptr),
                                  "topic " + topic.name + " cannot be read"));
  checked(dds_set_status_mask(state_->reader.get(), DDS_DATA_AVAILABLE_STATUS), "topic " + topic.name);
  state_->waiting = Entity(checked(dds_create_waitset(under), "topic " + topic.name));
  checked(dds_waitset_attach(state_->waiting.get(), state_->reader.get(), 0), "topic " + topic.name);
}

Reader::~Reader() = default;

std::size_t Reader::take(const std::function<void(const Sample&)>& visit) {
  constexpr std::uint32_t kAtOnce = 32;
  std::size_t visited = 0;
  for (;;) {
    std::array<ddsi_serdata*, kAtOnce> samples{};
    std::array<dds_sample_info_t, kAtOnce> infos;
    const dds_return_t count = dds_takecdr(state_->reader.get(), samples.data(), kAtOnce, infos.data(), DDS_ANY_STATE);
    if (count <= 0) return visited;
    for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i) {
      const std::unique_ptr<ddsi_serdata, void (*)(ddsi_serdata*)> owner(
          samples[i], [](ddsi_serdata* sample) { ddsi_serdata_unref(sample); });
      if (!infos[i].valid_data) continue;  // a writer that ended
      ++visited;
      visit({raw_bytes(samples[i]), infos[i].source_timestamp, infos[i].publication_handle});
    }
  }
}

bool Reader::wait(Duration timeout) const noexcept {
  return dds_waitset_wait(state_->waiting.get(), nullptr, 0, timeout.count()) > 0;
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

void Reader::refuse(std::string why) {
  ++refused_;
  last_refusal_ = topic_ + ": " + std::move(why);
}

}  // namespace foresight::link
