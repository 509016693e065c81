#include "link/dds/participant.hpp"

#include <dlfcn.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstring>

#include "common/error.hpp"
#include "common/text.hpp"
#include "link/dds/cyclone.hpp"
#include "link/dds/raw_type.hpp"
#include "link/dds/settings.hpp"

namespace foresight::link {
namespace {

constexpr char kRole[] = "foresight=";  // in the participant's user data, beside what ROS 2's tools look for

void note_complaint(void* complaints, const dds_log_data_t* data) {
  static_cast<Complaints*>(complaints)->words.note({data->message + data->hdrsize, data->size - data->hdrsize});
}

/// Cyclone's plugins lie in a folder that the loader does not search.
std::string plugin(const char* name) {
  Dl_info cyclone{};
  ::dladdr(reinterpret_cast<const void*>(&dds_create_domain), &cyclone);
  const std::string file = std::string("libdds_security_") + name + ".so";
  const std::filesystem::path beside = std::filesystem::path(cyclone.dli_fname).parent_path();
  for (const auto& folder : {beside / "libddsc0debian", beside})
    if (std::filesystem::exists(folder / file)) return folder / file;
  throw RuntimeFailure("Cyclone DDS has no " + file + " beside " + beside.string(),
                       "install a Cyclone DDS that was built with security, as Debian's libddsc0debian is");
}

void secure(dds_qos_t* qos, const KeyFiles& files) {
  const auto set = [qos](const char* name, const std::string& value) { dds_qset_prop(qos, name, value.c_str()); };
  for (const auto& [kind, name, words] : {std::array{"auth", "auth", "authentication"},
                                          {"access", "ac", "access_control"},
                                          {"crypto", "crypto", "crypto"}}) {
    const std::string prefix = std::string("dds.sec.") + kind + ".library.";
    set((prefix + "path").c_str(), plugin(name));
    set((prefix + "init").c_str(), std::string("init_") + words);
    set((prefix + "finalize").c_str(), std::string("finalize_") + words);
  }
  const auto file = [](const std::filesystem::path& path) {
    return "file:" + std::filesystem::absolute(path).string();
  };
  set("dds.sec.auth.identity_ca", file(files.authority));
  set("dds.sec.auth.identity_certificate", file(files.certificate));
  set("dds.sec.auth.private_key", file(files.key));
  set("dds.sec.access.permissions_ca", file(files.authority));
  set("dds.sec.access.governance", file(files.rules));
  set("dds.sec.access.permissions", file(files.permissions));
}

Qos participant_qos(const LinkConfig& config, const std::string& name, Role role) {
  Qos qos(dds_create_qos());
  const std::string data = "enclave=/;" + (kRole + name) + ";";
  dds_qset_userdata(qos.get(), data.data(), data.size());
  if (config.security) secure(qos.get(), key_files(*config.security, role));
  return qos;
}

std::string property(const dds_qos_t* qos, const char* name) {
  char* value = nullptr;
  if (!dds_qget_prop(qos, name, &value) || !value) return "";
  const std::unique_ptr<char, decltype(&dds_free)> owner(value, &dds_free);
  return value;
}

std::string role_of(const dds_qos_t* qos) {
  void* data = nullptr;
  std::size_t size = 0;
  if (!dds_qget_userdata(qos, &data, &size) || !data) return "";
  const std::unique_ptr<void, decltype(&dds_free)> owner(data, &dds_free);
  const std::string text(static_cast<const char*>(data), size);
  const std::size_t at = text.find(kRole);
  if (at == text.npos) return "";
  const std::size_t begin = at + std::strlen(kRole);
  return text.substr(begin, text.find(';', begin) - begin);
}

std::string entity_name(const dds_qos_t* qos) {
  char* value = nullptr;
  if (!dds_qget_entity_name(qos, &value) || !value) return "";
  const std::unique_ptr<char, decltype(&dds_free)> owner(value, &dds_free);
  return value;
}

/// Printable, and of a bounded length: others may call themselves anything.
std::string shown(std::string text, std::size_t most = 80) {
  if (text.size() > most) text.resize(most);
  for (char& c : text)
    if (static_cast<unsigned char>(c) < ' ' || c == 127) c = '?';
  return text;
}

std::string id_of(const dds_guid_t& guid) {
  std::string out;
  for (const std::uint8_t byte : guid.v) out += fmt::format("{:02x}", byte);
  return out;
}

/// Visits what a reader of Cyclone's own topics holds, alive only. What has ended is let go of: Cyclone keeps it until
/// it is taken, and after some hundred ends those who are there would not be among the first kMost.
template <typename T, typename Visit>
void each_alive(dds_entity_t reader, Visit&& visit) {
  constexpr std::size_t kMost = 512;
  constexpr std::uint32_t kEnded = DDS_ANY_SAMPLE_STATE | DDS_ANY_VIEW_STATE | DDS_NOT_ALIVE_DISPOSED_INSTANCE_STATE |
                                   DDS_NOT_ALIVE_NO_WRITERS_INSTANCE_STATE;
  std::array<void*, kMost> samples{};
  std::array<dds_sample_info_t, kMost> infos;
  for (;;) {
    const dds_return_t ended = dds_take_mask(reader, samples.data(), infos.data(), kMost, kMost, kEnded);
    if (ended <= 0) break;
    dds_return_loan(reader, samples.data(), ended);
  }
  const dds_return_t count = dds_read(reader, samples.data(), infos.data(), kMost, kMost);
  if (count <= 0) return;
  for (std::size_t i = 0; i < static_cast<std::size_t>(count); ++i)
    if (infos[i].valid_data && infos[i].instance_state == DDS_IST_ALIVE) visit(*static_cast<const T*>(samples[i]));
  dds_return_loan(reader, samples.data(), count);
}

Delivery delivery_of(const dds_qos_t* qos) {
  dds_durability_kind_t durability = DDS_DURABILITY_VOLATILE;
  if (dds_qget_durability(qos, &durability) && durability != DDS_DURABILITY_VOLATILE) return Delivery::kept;
  dds_reliability_kind_t reliability = DDS_RELIABILITY_RELIABLE;
  const bool known = dds_qget_reliability(qos, &reliability, nullptr);
  return known && reliability == DDS_RELIABILITY_BEST_EFFORT ? Delivery::once : Delivery::newest;
}

Peer peer_of(const dds_builtintopic_participant_t& participant) {
  Peer out;
  out.id = id_of(participant.key);
  out.host = shown(property(participant.qos, "__Hostname"));
  const std::string process = property(participant.qos, "__ProcessName"), pid = property(participant.qos, "__Pid");
  out.process = shown(process.empty() || pid.empty() ? process : process + " " + pid);
  out.name = shown(role_of(participant.qos));
  if (out.name.empty()) out.name = shown(entity_name(participant.qos));
  if (out.name.empty()) out.name = out.process.empty() ? "?" : out.process;
  return out;
}

}  // namespace

Complaints::Complaints() {
  dds_set_log_sink(note_complaint, this);
}

Complaints::~Complaints() {
  dds_set_log_sink(nullptr, nullptr);
}

void CountedWords::note(std::string text) {
  while (!text.empty() && text.back() == '\n') text.pop_back();
  const std::lock_guard lock(mutex_);
  last_ = shown(std::move(text), 200);
  ++count_;
}

std::string CountedWords::last() const {
  const std::lock_guard lock(mutex_);
  return last_;
}

std::uint64_t CountedWords::count() const {
  const std::lock_guard lock(mutex_);
  return count_;
}

dds_entity_t checked(dds_entity_t code, const std::string& what) {
  if (code == DDS_RETCODE_NOT_ALLOWED_BY_SECURITY)
    throw RuntimeFailure(what + ": this program's certificate does not permit it",
                         "use the keys of the role that may (docs/line.md)");
  if (code < 0)
    throw RuntimeFailure(what + ": Cyclone DDS says '" + dds_strretcode(code) + "'",
                         "see whether another program uses the domain's ports, or choose another link.domain");
  return code;
}

Qos qos_of(const Topic& topic) {
  constexpr int kMostWaiting = 1024;  // samples of Delivery::each that nobody has taken
  Qos qos(dds_create_qos());
  dds_qset_reliability(qos.get(),
                       topic.delivery == Delivery::once ? DDS_RELIABILITY_BEST_EFFORT : DDS_RELIABILITY_RELIABLE, 0);
  dds_qset_durability(qos.get(),
                      topic.delivery == Delivery::kept ? DDS_DURABILITY_TRANSIENT_LOCAL : DDS_DURABILITY_VOLATILE);
  if (topic.delivery == Delivery::each) {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, DDS_LENGTH_UNLIMITED);
    dds_qset_resource_limits(qos.get(), kMostWaiting, DDS_LENGTH_UNLIMITED, kMostWaiting);
  } else {
    dds_qset_history(qos.get(), DDS_HISTORY_KEEP_LAST, topic.depth);
  }
  if (topic.delivery == Delivery::kept)
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, topic.depth, DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  const dds_data_representation_id_t representation = DDS_DATA_REPRESENTATION_XCDR1;
  dds_qset_data_representation(qos.get(), 1, &representation);
  return qos;
}

const Participant::State::UsedTopic& Participant::State::topic(const Topic& wanted) {
  const std::lock_guard lock(mutex);
  auto& used = topics[wanted.name];
  if (used.topic.get() > 0) {
    if (used.type_name == wanted.type) return used;
    throw RuntimeFailure("topic " + wanted.name + " has the type " + used.type_name + " here, not " + wanted.type,
                         "choose another name");
  }
  ddsi_sertype* type = new_raw_type(wanted.type);
  const dds_entity_t made =
      dds_create_topic_sertype(participant.get(), wanted.name.c_str(), &type, nullptr, nullptr, nullptr);
  if (made < 0) ddsi_sertype_unref(type);
  used.topic = Entity(checked(made, "topic " + wanted.name + " cannot be made"));
  used.type = type;
  used.type_name = wanted.type;
  return used;
}

// A reader gets what was heard before it was made, too.
const Participant::State::Discovery& Participant::State::who_is_there() {
  const std::lock_guard lock(mutex);
  if (discovery) return *discovery;
  const auto reader = [this](dds_entity_t topic) {
    return Entity(checked(dds_create_reader(participant.get(), topic, nullptr, nullptr), "discovery"));
  };
  return discovery.emplace(Discovery{reader(DDS_BUILTIN_TOPIC_DCPSPARTICIPANT),
                                     reader(DDS_BUILTIN_TOPIC_DCPSPUBLICATION),
                                     reader(DDS_BUILTIN_TOPIC_DCPSSUBSCRIPTION)});
}

Participant::Participant(const LinkConfig& config, const std::string& name, Role role,
                         std::shared_ptr<PretendedLine> line)
    : state_(std::make_unique<State>()) {
  state_->complaints = std::make_shared<Complaints>();
  state_->line = std::move(line);
  check_network(config);
  if (config.security) check_keys(*config.security, role, config.where);
  State& s = *state_;
  const auto domain = static_cast<dds_domainid_t>(config.domain);
  try {
    const std::string settings = cyclone_settings(config, granted_receive_buffer());
    s.domain = Entity(checked(dds_create_domain(domain, settings.c_str()), "the link cannot be opened"));
    open(config.domain, participant_qos(config, name, role).get());
  } catch (const RuntimeFailure&) {
    const std::string why = s.complaints->words.last();
    if (why.empty()) throw;
    throw RuntimeFailure(fmt::format("{}: the link cannot be opened on domain {}, interface {}: {}", config.where,
                                     config.domain, config.interface, why),
                         "end the programs that use the domain's ports, or choose another link.domain on both sides");
  }
}

Participant::Participant(Participant& first, const std::string& name, std::shared_ptr<PretendedLine> line)
    : state_(std::make_unique<State>()) {
  state_->complaints = first.state_->complaints;
  state_->line = std::move(line);
  open(first.state_->domain_id, participant_qos(LinkConfig{}, name, Role::observer).get());
}

void Participant::open(int domain, const void* qos) {
  State& s = *state_;
  s.domain_id = domain;
  s.participant = Entity(
      checked(dds_create_participant(static_cast<dds_domainid_t>(domain), static_cast<const dds_qos_t*>(qos), nullptr),
              "the link cannot be opened"));
}

Participant::~Participant() = default;

std::vector<Peer> Participant::peers() const {
  const State::Discovery& there = state_->who_is_there();
  std::vector<Peer> out;
  dds_guid_t own{};
  dds_get_guid(state_->participant.get(), &own);
  each_alive<dds_builtintopic_participant_t>(there.programs.get(), [&](const dds_builtintopic_participant_t& one) {
    out.push_back(peer_of(one));
    out.back().own = out.back().id == id_of(own);
  });
  for (const bool writes : {true, false})
    each_alive<dds_builtintopic_endpoint_t>(
        (writes ? there.publications : there.subscriptions).get(), [&](const dds_builtintopic_endpoint_t& one) {
          const auto of = std::ranges::find(out, id_of(one.participant_key), &Peer::id);
          if (of != out.end())
            of->endpoints.push_back({shown(one.topic_name), shown(one.type_name), writes, delivery_of(one.qos)});
        });
  for (Peer& peer : out)
    std::ranges::sort(peer.endpoints, [](const auto& a, const auto& b) { return a.topic < b.topic; });
  std::ranges::sort(out, [](const Peer& a, const Peer& b) { return std::tie(a.name, a.id) < std::tie(b.name, b.id); });
  return out;
}

std::string Participant::trouble() const {
  const CountedWords& words = state_->complaints->words;
  const auto count = static_cast<unsigned long long>(words.count());
  return count == 0 ? "" : fmt::format("{} ({} such messages)", words.last(), count);
}

std::uint64_t Participant::refused() const {
  return state_->refusals.count();
}

std::string Participant::refusal() const {
  return state_->refusals.last();
}

std::string robot_beside(const Participant& program) {
  for (const Peer& peer : program.peers())
    if (!peer.own && peer.name.starts_with("robot "))
      return in_quotes(peer.name) + (peer.host.empty() ? "" : " on " + peer.host);
  return "";
}

}  // namespace foresight::link
