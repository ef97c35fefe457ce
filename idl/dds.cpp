#include "idl/dds.hpp"

#include <algorithm>
#include <cstdlib>
#include <limits>

#include "idl/dds_security.hpp"
#include "idl/keys/key_folder.hpp"

namespace collided::dds {
namespace {

using wire_contract::Durability;
using wire_contract::Reliability;
using wire_contract::TopicQos;

struct QosDeleter {
  void operator()(dds_qos_t* qos) const { dds_delete_qos(qos); }
};
using Qos = std::unique_ptr<dds_qos_t, QosDeleter>;

struct ListenerDeleter {
  void operator()(dds_listener_t* listener) const { dds_delete_listener(listener); }
};
using Listener = std::unique_ptr<dds_listener_t, ListenerDeleter>;

Qos make_qos() { return Qos(dds_create_qos()); }

// The QoS that topic, reader and writer of a row share.
Qos row_qos(const TopicQos& row, std::int64_t max_blocking_ns) {
  Qos qos = make_qos();
  const bool reliable = row.reliability == Reliability::reliable;
  dds_qset_reliability(qos.get(), reliable ? DDS_RELIABILITY_RELIABLE : DDS_RELIABILITY_BEST_EFFORT, max_blocking_ns);
  dds_qset_history(qos.get(), row.keep_last > 0 ? DDS_HISTORY_KEEP_LAST : DDS_HISTORY_KEEP_ALL, row.keep_last);
  if (row.durability == Durability::transient_local) {
    dds_qset_durability(qos.get(), DDS_DURABILITY_TRANSIENT_LOCAL);
    // This, not the history, determines what a late joiner receives.
    dds_qset_durability_service(qos.get(), 0, DDS_HISTORY_KEEP_LAST, std::max(row.keep_last, 1), DDS_LENGTH_UNLIMITED,
                                DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  return qos;
}

Entity make_group(dds_entity_t participant, const std::string& partition, const std::string& topic, bool publisher) {
  Qos qos = make_qos();
  if (!partition.empty()) { dds_qset_partition1(qos.get(), partition.c_str()); }
  return Entity(check(publisher ? dds_create_publisher(participant, qos.get(), nullptr)
                                : dds_create_subscriber(participant, qos.get(), nullptr),
                      topic + (publisher ? ": create publisher" : ": create subscriber")));
}

// C calls these. An exception cannot unwind through C frames; noexcept ends the process instead.
void call_data(dds_entity_t reader, void* callbacks) noexcept {
  static_cast<EntityCallbacks*>(callbacks)->data(reader);
}
void call_subscribed(dds_entity_t, const dds_subscription_matched_status_t status, void* callbacks) noexcept {
  static_cast<EntityCallbacks*>(callbacks)->matched(status.current_count);
}
void call_published(dds_entity_t, const dds_publication_matched_status_t status, void* callbacks) noexcept {
  static_cast<EntityCallbacks*>(callbacks)->matched(status.current_count);
}
void call_liveliness(dds_entity_t, const dds_liveliness_changed_status_t status, void* callbacks) noexcept {
  static_cast<EntityCallbacks*>(callbacks)->liveliness(
      {status.alive_count, status.not_alive_count, status.last_publication_handle});
}

Listener make_listener(EntityCallbacks& callbacks) {
  Listener listener(dds_create_listener(&callbacks));
  if (callbacks.data) { dds_lset_data_available(listener.get(), call_data); }
  if (callbacks.matched) {
    dds_lset_subscription_matched(listener.get(), call_subscribed);
    dds_lset_publication_matched(listener.get(), call_published);
  }
  if (callbacks.liveliness) { dds_lset_liveliness_changed(listener.get(), call_liveliness); }
  return listener;
}

// The configuration is XML built from user input, which must not be able to add an element.
const std::string& checked_word(const std::string& word, const char* what) {
  const auto allowed = [](char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || (c >= '0' && c <= '9') ||
           std::string_view("._-:%[]").find(c) != std::string_view::npos;
  };
  if (word.empty() || !std::all_of(word.begin(), word.end(), allowed)) {
    throw DdsError(std::string(what) + " '" + word + "': a character that no address or interface has");
  }
  return word;
}

std::string network_config(const ParticipantOptions& options) {
  // Large datagrams only on loopback, where no fragment can be lost.
  if (options.interface == "lo") {
    return R"(<Interfaces><NetworkInterface name="lo" multicast="false"/></Interfaces>)"
           "<AllowMulticast>false</AllowMulticast><MaxMessageSize>65500B</MaxMessageSize>"
           "<FragmentSize>65000B</FragmentSize><MaxRexmitMessageSize>65500B</MaxRexmitMessageSize>";
  }
  const std::string interface = options.interface == "auto"
                                    ? R"(autodetermine="true")"
                                    : "name=\"" + checked_word(options.interface, "interface") + '"';
  return "<Interfaces><NetworkInterface " + interface + "/></Interfaces><AllowMulticast>spdp</AllowMulticast>";
}

std::string peers_config(const ParticipantOptions& options) {
  std::string peers;
  if (options.interface == "lo") { peers += R"(<Peer address="127.0.0.1"/>)"; }
  for (const std::string& peer : options.peers) { peers += "<Peer address=\"" + checked_word(peer, "peer") + "\"/>"; }
  return peers.empty() ? peers : "<Peers>" + peers + "</Peers>";
}

}  // namespace

dds_return_t check(dds_return_t code, std::string_view what) {
  if (code >= 0) { return code; }
  const std::string message = std::string(what) + ": " + dds_strretcode(-code);
  if (code == DDS_RETCODE_NOT_ALLOWED_BY_SECURITY) {
    throw NotAllowedError(message + ": the keys of this process do not give the right to it");
  }
  throw DdsError(message);
}

void Entity::reset() {
  if (handle_ > 0) {
    dds_delete(handle_);  // waits for callbacks under way
  }
  handle_ = 0;
}

std::string domain_config(const ParticipantOptions& options) {
  const std::string index = options.role == Role::server ? "auto" : "none";
  // A client itself waits for required deliveries. DDS would also wait for the reader of a dead server.
  const std::string linger = options.role == Role::server ? "1s" : "0s";
  // A writer with a full history waits for acknowledgements, which come only after a heartbeat. A client's writer has
  // one reader, the server's writers have many.
  const std::string heartbeat =
      options.role == Role::server
          ? R"(<HeartbeatInterval min="2ms" minsched="5ms" max="500ms">10ms</HeartbeatInterval>)"
          : R"(<HeartbeatInterval min="500us" minsched="500us" max="500ms">1ms</HeartbeatInterval>)";
  // A participant with its own process_domain reads messages of other programs, such as point clouds.
  constexpr std::uint32_t kMaxForeignBytes = 64 << 20;
  const std::uint32_t most_bytes = options.process_domain ? kMaxForeignBytes : wire_contract::kMaxMessageBytes;
  return R"(<Domain id="any"><General>)" + network_config(options) + "</General><Discovery>" + "<ExternalDomainId>" +
         std::to_string(options.domain) + "</ExternalDomainId>" + "<ParticipantIndex>" + index +
         "</ParticipantIndex><MaxAutoParticipantIndex>" + std::to_string(wire_contract::kMaxParticipantIndex) +
         "</MaxAutoParticipantIndex>" + peers_config(options) +
         "<SPDPInterval>1s</SPDPInterval><LeaseDuration>10s</LeaseDuration></Discovery><Internal>"
         // A sample is assembled in memory before any code can refuse it, so its size is limited here.
         "<MaxSampleSize>" +
         std::to_string(most_bytes) +
         "B</MaxSampleSize>"
         // `max` only requests; `min` would stop the start on a machine with small limits.
         R"(<SocketReceiveBufferSize max="8MB"/>)"
         // By default a lost datagram is requested again after 100 ms, too long for a question.
         "<NackDelay>10ms</NackDelay><PreEmptiveAckDelay>5ms</PreEmptiveAckDelay>"
         "<AutoReschedNackDelay>50ms</AutoReschedNackDelay>" +
         heartbeat + "<WriterLingerDuration>" + linger +
         "</WriterLingerDuration>"
         "<Watermarks><WhcHigh>16MB</WhcHigh><WhcHighInit>4MB</WhcHighInit><WhcLow>1MB</WhcLow></Watermarks>"
         "</Internal>" +
         security_config(options.keys, options.handshake) + "</Domain>";
}

Participant::Participant(const ParticipantOptions& options) {
  if (options.domain < 0 || options.domain > wire_contract::kLastDomain) {
    throw std::invalid_argument("domain " + std::to_string(options.domain) + ": allowed 0 to " +
                                std::to_string(wire_contract::kLastDomain));
  }
  const auto domain = static_cast<dds_domainid_t>(options.process_domain.value_or(options.domain));
  const char* const uri = std::getenv("CYCLONEDDS_URI");
  configured_by_environment_ = uri != nullptr && *uri != 0;
  const std::string where = "domain " + std::to_string(options.domain) + ", interface '" + options.interface + "': ";
  if (!options.keys.empty()) {
    // That configuration may lack keys, and all traffic would be unencrypted.
    if (configured_by_environment_) throw KeysError(where + "CYCLONEDDS_URI is set, so keys cannot be used; unset it");
    try {
      keys::check_keys(options.keys);
    } catch (const keys::KeyError& wrong) { throw KeysError(wrong.what()); }
  }
  if (!configured_by_environment_) {
    domain_ = Entity(check(dds_create_domain(domain, domain_config(options).c_str()), where + "create domain"));
  }
  participant_ = Entity(check(dds_create_participant(domain, nullptr, nullptr), where + "create participant"));
}

std::size_t Participant::others_seen() const {
  const Entity reader(check(dds_create_reader(get(), DDS_BUILTIN_TOPIC_DCPSPARTICIPANT, nullptr, nullptr),
                            "create reader of participants"));
  std::size_t seen = 0;
  constexpr std::size_t kMost = 64;
  void* samples[kMost] = {};
  dds_sample_info_t infos[kMost];
  while (true) {
    const dds_return_t count = check(dds_take(reader.get(), samples, infos, kMost, kMost), "read participants");
    if (count == 0) { break; }
    seen += static_cast<std::size_t>(std::count_if(infos, infos + count, [](const dds_sample_info_t& info) {
      return info.valid_data && info.instance_state == DDS_ALIVE_INSTANCE_STATE;
    }));
    dds_return_loan(reader.get(), samples, count);
  }
  return seen > 0 ? seen - 1 : 0;  // this participant is among them
}

void Participant::set_deaf_mute(bool deaf, bool mute, std::int64_t nanoseconds) {
  check(dds_domain_set_deafmute(get(), deaf, mute, nanoseconds), "set deaf and mute");
}

TopicBase::TopicBase(const Participant& participant, std::string_view name_space, const TopicQos& row,
                     const dds_topic_descriptor_t* descriptor)
    : participant_(participant.get()), name_(wire_contract::topic_name(name_space, row)), row_(row) {
  topic_ = Entity(
      check(dds_create_topic(participant_, descriptor, name_.c_str(), nullptr, nullptr), name_ + ": create topic"));
}

WriterBase::WriterBase(const TopicBase& topic, const TopicQos& row, WriterOptions options)
    : topic_name_(topic.name()), callbacks_(std::make_unique<EntityCallbacks>()) {
  callbacks_->matched = std::move(options.matched);
  const Qos qos = row_qos(row, options.max_blocking_ns);
  dds_qset_writer_data_lifecycle(qos.get(), row.autodispose);
  if (options.lease_ns > 0) { dds_qset_liveliness(qos.get(), DDS_LIVELINESS_MANUAL_BY_TOPIC, options.lease_ns); }
  if (options.lifespan_ns > 0) { dds_qset_lifespan(qos.get(), options.lifespan_ns); }
  const Listener listener = make_listener(*callbacks_);
  publisher_ = make_group(topic.participant(), options.partition, topic_name_, true);
  writer_ = Entity(check(dds_create_writer(publisher_.get(), topic.get(), qos.get(), listener.get()),
                         topic_name_ + ": create writer"));
}

std::uint32_t WriterBase::matched_readers() const {
  dds_publication_matched_status_t status;
  check(dds_get_publication_matched_status(get(), &status), topic_name_);
  return status.current_count;
}

void WriterBase::assert_liveliness() { check(dds_assert_liveliness(get()), topic_name_ + ": assert liveliness"); }

bool WriterBase::wait_for_acknowledgements(std::int64_t nanoseconds) {
  const dds_return_t code = dds_wait_for_acks(get(), nanoseconds);
  return code != DDS_RETCODE_TIMEOUT && check(code, topic_name_ + ": wait for acknowledgements") >= 0;
}

bool WriterBase::write_sample(const void* sample) {
  const dds_return_t code = dds_write(get(), sample);
  if (code == DDS_RETCODE_OK) { return true; }
  if (code == DDS_RETCODE_TIMEOUT) { return false; }
  check(code, topic_name_ + ": write");
  return false;
}

void WriterBase::dispose_sample(const void* sample) { check(dds_dispose(get(), sample), topic_name_ + ": dispose"); }

ReaderBase::ReaderBase(const TopicBase& topic, const TopicQos& row, const std::string& partition,
                       EntityCallbacks callbacks)
    : callbacks_(std::make_unique<EntityCallbacks>(std::move(callbacks))) {
  const Qos qos = row_qos(row, 0);
  // Histories bound the samples a writer keeps for slow readers. A reader drains from its listener and must not lose
  // samples that arrive meanwhile. Topics of state keep the newest sample of each key.
  if (row.durability == Durability::volatile_data) { dds_qset_history(qos.get(), DDS_HISTORY_KEEP_ALL, 0); }
  if (row.reader_max_samples > 0) {
    dds_qset_resource_limits(qos.get(), row.reader_max_samples, DDS_LENGTH_UNLIMITED, DDS_LENGTH_UNLIMITED);
  }
  const Listener listener = make_listener(*callbacks_);
  subscriber_ = make_group(topic.participant(), partition, topic.name(), false);
  reader_ = Entity(check(dds_create_reader(subscriber_.get(), topic.get(), qos.get(), listener.get()),
                         topic.name() + ": create reader"));
}

std::uint32_t ReaderBase::matched_writers() const {
  dds_subscription_matched_status_t status;
  check(dds_get_subscription_matched_status(get(), &status), "matched writers");
  return status.current_count;
}

std::vector<dds_instance_handle_t> ReaderBase::matched_writer_handles() const {
  std::vector<dds_instance_handle_t> handles(16);
  while (true) {
    const dds_return_t count =
        check(dds_get_matched_publications(get(), handles.data(), handles.size()), "matched writers");
    const bool all = static_cast<std::size_t>(count) <= handles.size();
    handles.resize(static_cast<std::size_t>(count));
    if (all) return handles;
  }
}

WaitSet::WaitSet(const Participant& participant)
    : wake_condition_(check(dds_create_guardcondition(participant.get()), "create guard condition")),
      waitset_(check(dds_create_waitset(participant.get()), "create waitset")) {
  check(dds_waitset_attach(waitset_.get(), wake_condition_.get(), kWakeToken), "attach guard condition");
}

void WaitSet::attach(const ReaderBase& reader, std::intptr_t token) {
  conditions_.emplace_back(check(dds_create_readcondition(reader.get(), DDS_ANY_STATE), "create read condition"));
  check(dds_waitset_attach(waitset_.get(), conditions_.back().get(), token), "attach read condition");
  ++attached_;
}

void WaitSet::wake() { check(dds_set_guardcondition(wake_condition_.get(), true), "wake waitset"); }

std::vector<std::intptr_t> WaitSet::wait(std::int64_t nanoseconds) {
  std::vector<dds_attach_t> fired(attached_);
  const dds_return_t count = check(dds_waitset_wait(waitset_.get(), fired.data(), fired.size(), nanoseconds), "wait");
  fired.resize(std::min(fired.size(), static_cast<std::size_t>(count)));
  if (std::erase(fired, kWakeToken) > 0) { dds_set_guardcondition(wake_condition_.get(), false); }
  return fired;
}

}  // namespace collided::dds
