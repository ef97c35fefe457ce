#pragma once

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

#include <dds/dds.h>

#include "idl/collided.h"
#include "idl/topics.hpp"

/// Owning C++ over Cyclone DDS's C interface: the only door to DDS.
///
///   dds::Participant participant({.domain = 0, .role = dds::Role::server});
///   dds::Topic<wire::Query> queries(participant, "collided");             // the row in topics.hpp sets its QoS
///   dds::Reader<wire::Query> reader(queries, {.data = [&](dds::Taker<wire::Query> taker) {
///     while (taker.take(*free_sample)) { queue.push(free_sample); ... }   // listener: only take and hand over
///   }});
///   dds::Topic<wire::Reply> replies(participant, "collided");
///   dds::Writer<wire::Reply> writer(replies, {.partition = wire_contract::reply_partition(client)});
///   dds::borrow(reply->answers, my_answers);                              // no copy: must outlive write()
///   if (!writer.write(*reply)) { /* timed out: the reader's queue is full */ }
///
/// Errors throw DdsError, which names the failed call. Everything is move-only; an object must outlive the objects made
/// from it.
namespace collided::wire {

using Definition = ::collided_wire_v2_Definition;
using PoseBatch = ::collided_wire_v2_PoseBatch;
using Query = ::collided_wire_v2_Query;
using Reply = ::collided_wire_v2_Reply;
using EventFrame = ::collided_wire_v2_EventFrame;
using ContactShard = ::collided_wire_v2_ContactShard;
using StandingFrame = ::collided_wire_v2_StandingFrame;
using StandingShard = ::collided_wire_v2_StandingShard;
using ProbeFrame = ::collided_wire_v2_ProbeFrame;
using Status = ::collided_wire_v2_Status;
using Member = ::collided_wire_v2_Member;
using Change = ::collided_wire_v2_Change;

}  // namespace collided::wire

namespace collided::dds {

/// An error of DDS with the failed call: "collided/query: create writer: Out Of Resources".
struct DdsError : std::runtime_error {
  using std::runtime_error::runtime_error;
};

/// The keys of this participant do not grant the required right.
struct NotAllowedError : DdsError {
  using DdsError::DdsError;
};

/// A folder of keys is unusable.
struct KeysError : DdsError {
  using DdsError::DdsError;
};

/// Returns `code`, or throws DdsError with `what` if it is an error.
dds_return_t check(dds_return_t code, std::string_view what);

// ---- types

/// A wire type's descriptor and its row in the topic table.
template <class T>
struct WireType;
template <>
struct WireType<wire::Definition> {
  static constexpr const dds_topic_descriptor_t* descriptor = &collided_wire_v2_Definition_desc;
  static constexpr const wire_contract::TopicQos& row = wire_contract::kObjectTopic;
};
template <>
struct WireType<wire::PoseBatch> {
  static constexpr const dds_topic_descriptor_t* descriptor = &collided_wire_v2_PoseBatch_desc;
  static constexpr const wire_contract::TopicQos& row = wire_contract::kPoseTopic;
};
template <>
struct WireType<wire::Query> {
  static constexpr const dds_topic_descriptor_t* descriptor = &collided_wire_v2_Query_desc;
  static constexpr const wire_contract::TopicQos& row = wire_contract::kQueryTopic;
};
template <>
struct WireType<wire::Reply> {
  static constexpr const dds_topic_descriptor_t* descriptor = &collided_wire_v2_Reply_desc;
  static constexpr const wire_contract::TopicQos& row = wire_contract::kReplyTopic;
};
template <>
struct WireType<wire::EventFrame> {
  static constexpr const dds_topic_descriptor_t* descriptor = &collided_wire_v2_EventFrame_desc;
  static constexpr const wire_contract::TopicQos& row = wire_contract::kEventTopic;
};
template <>
struct WireType<wire::ContactShard> {
  static constexpr const dds_topic_descriptor_t* descriptor = &collided_wire_v2_ContactShard_desc;
  static constexpr const wire_contract::TopicQos& row = wire_contract::kContactTopic;
};
template <>
struct WireType<wire::StandingFrame> {
  static constexpr const dds_topic_descriptor_t* descriptor = &collided_wire_v2_StandingFrame_desc;
  static constexpr const wire_contract::TopicQos& row = wire_contract::kStandingEventTopic;
};
template <>
struct WireType<wire::StandingShard> {
  static constexpr const dds_topic_descriptor_t* descriptor = &collided_wire_v2_StandingShard_desc;
  static constexpr const wire_contract::TopicQos& row = wire_contract::kStandingStateTopic;
};
template <>
struct WireType<wire::ProbeFrame> {
  static constexpr const dds_topic_descriptor_t* descriptor = &collided_wire_v2_ProbeFrame_desc;
  static constexpr const wire_contract::TopicQos& row = wire_contract::kProbeTopic;
};
template <>
struct WireType<wire::Status> {
  static constexpr const dds_topic_descriptor_t* descriptor = &collided_wire_v2_Status_desc;
  static constexpr const wire_contract::TopicQos& row = wire_contract::kStatusTopic;
};
template <>
struct WireType<wire::Change> {
  static constexpr const dds_topic_descriptor_t* descriptor = &collided_wire_v2_Change_desc;
  static constexpr const wire_contract::TopicQos& row = wire_contract::kChangeTopic;
};
template <>
struct WireType<wire::Member> {
  static constexpr const dds_topic_descriptor_t* descriptor = &collided_wire_v2_Member_desc;
  static constexpr const wire_contract::TopicQos& row = wire_contract::kMemberTopic;
};

/// A message with reusable memory: a later take() into it keeps its sequences' buffers. It owns what take() filled;
/// borrow() may point its sequences elsewhere during a write().
template <class T>
class Sample {
 public:
  Sample() { std::memset(&value_, 0, sizeof value_); }
  ~Sample() { dds_sample_free(&value_, WireType<T>::descriptor, DDS_FREE_CONTENTS); }
  Sample(Sample&& other) noexcept : value_(other.value_), info_(other.info_) {
    std::memset(&other.value_, 0, sizeof value_);
  }
  Sample& operator=(Sample&& other) noexcept {
    std::swap(value_, other.value_);
    std::swap(info_, other.info_);
    return *this;
  }
  T& operator*() { return value_; }
  const T& operator*() const { return value_; }
  T* operator->() { return &value_; }
  const T* operator->() const { return &value_; }

  /// Information about the last take. valid_data false: only the instance's state changed (info().instance_state), and
  /// only the key is set.
  const dds_sample_info_t& info() const { return info_; }

 private:
  template <class U>
  friend class Taker;
  T value_;
  dds_sample_info_t info_{};
};

template <class Sequence>
using ElementOf = std::remove_pointer_t<decltype(Sequence::_buffer)>;

/// The elements of a sequence; valid while it is unchanged.
template <class Sequence>
std::span<const ElementOf<Sequence>> view(const Sequence& sequence) {
  return {sequence._buffer, sequence._length};
}

/// Points a sequence to memory of the caller. DDS reads it only during write() and never frees it.
template <class Sequence, class Range>
void borrow(Sequence& sequence, const Range& range) {
  const std::span<const ElementOf<Sequence>> elements(range);
  if (sequence._release) { dds_free(sequence._buffer); }
  sequence._buffer = const_cast<ElementOf<Sequence>*>(elements.data());
  sequence._length = sequence._maximum = static_cast<std::uint32_t>(elements.size());
  sequence._release = false;
}

/// Fills a bounded string. If the text is longer than the field, empties it and returns false.
template <std::size_t kRoom>
[[nodiscard]] bool set_text(char (&field)[kRoom], std::string_view text) {
  const bool fits = text.size() < kRoom;
  const std::size_t length = fits ? text.size() : 0;
  std::memcpy(field, text.data(), length);
  field[length] = 0;
  return fits;
}

// ---- entities

/// Owns a DDS entity and deletes it once.
class Entity {
 public:
  Entity() = default;
  explicit Entity(dds_entity_t handle) : handle_(handle) {}
  ~Entity() { reset(); }
  Entity(Entity&& other) noexcept : handle_(std::exchange(other.handle_, 0)) {}
  Entity& operator=(Entity&& other) noexcept {
    std::swap(handle_, other.handle_);
    return *this;
  }
  dds_entity_t get() const { return handle_; }
  /// Deletes the entity after waiting for its running callbacks.
  void reset();

 private:
  dds_entity_t handle_ = 0;
};

/// A server takes a participant index, and thereby a fixed port where others find it. A client takes none: clients
/// discover servers but not each other, so their number is unlimited.
enum class Role { server, client };

/// interface       "lo": this machine only; "auto": the network, by multicast discovery; else an interface's name
/// peers           additional addresses at which to look for participants
/// keys            folder of keys (idl/keys): only participants with keys of the same authority are accepted; empty:
///                 all are
/// handshake       library that wraps Cyclone's authentication plugin, if there are keys; empty: none
/// process_domain  Cyclone's number for this domain within this process, for tests in which two participants of one
///                 process communicate over the network stack; none: `domain`
struct ParticipantOptions {
  int domain = 0;  // 0 to kLastDomain
  Role role = Role::client;
  std::string interface = "lo";
  std::vector<std::string> peers = {};
  std::string keys = {};
  std::string handshake = {};
  std::optional<int> process_domain = {};
};

/// Cyclone's configuration for these options. Throws DdsError for a character that is invalid in an address or
/// interface.
std::string domain_config(const ParticipantOptions& options);

/// A process's membership in a domain, one per process and domain. Deleting it deletes the entities made from it.
class Participant {
 public:
  /// A CYCLONEDDS_URI in the environment replaces interface and peers; configured_by_environment() is then true. Throws
  /// DdsError, also for faulty keys, or std::invalid_argument for a domain out of range.
  explicit Participant(const ParticipantOptions& options);

  dds_entity_t get() const { return participant_.get(); }
  bool configured_by_environment() const { return configured_by_environment_; }
  /// Number of other participants, of any program, now known.
  std::size_t others_seen() const;
  /// For tests: receives nothing (deaf) or sends nothing (mute) for `nanoseconds`, or until called with false, false.
  void set_deaf_mute(bool deaf, bool mute, std::int64_t nanoseconds);

 private:
  Entity domain_;
  Entity participant_;
  bool configured_by_environment_ = false;
};

/// The part of a topic that does not depend on its type.
class TopicBase {
 public:
  dds_entity_t get() const { return topic_.get(); }
  dds_entity_t participant() const { return participant_; }
  const std::string& name() const { return name_; }
  const wire_contract::TopicQos& row() const { return row_; }

 protected:
  TopicBase(const Participant& participant, std::string_view name_space, const wire_contract::TopicQos& row,
            const dds_topic_descriptor_t* descriptor);

 private:
  dds_entity_t participant_;
  std::string name_;
  const wire_contract::TopicQos& row_;
  Entity topic_;
};

/// A topic of the table in topics.hpp; its readers and writers share it.
template <class T>
class Topic : public TopicBase {
 public:
  /// row  of topics.hpp; required if a type travels on more than one topic
  Topic(const Participant& participant, std::string_view name_space,
        const wire_contract::TopicQos& row = WireType<T>::row)
      : TopicBase(participant, name_space, row, WireType<T>::descriptor) {}
};

/// Liveliness of the writers that a reader has matched.
struct Liveliness {
  std::uint32_t alive = 0;
  std::uint32_t not_alive = 0;            // matched, but their lease has run out
  dds_instance_handle_t last_writer = 0;  // writer with the last change of state: publication_handle in the info of its
                                          // samples
};

/// Callbacks on DDS's receive thread, for taking samples and passing them on. They must not block, throw, or make or
/// delete entities. They may run before the constructor of their reader or writer has returned.
struct EntityCallbacks {
  std::function<void(dds_entity_t)> data = {};
  std::function<void(std::uint32_t current)> matched = {};
  std::function<void(const Liveliness&)> liveliness = {};
};

/// partition        of the publisher made for it; empty: the default one
/// lease_ns         > 0: the writer counts as alive while it writes or asserts at least this often (MANUAL_BY_TOPIC)
/// lifespan_ns      > 0: samples that are not taken within this time are dropped
/// max_blocking_ns  maximum time that a write waits for a full reader
/// matched          called with the number of matched readers whenever that changes
struct WriterOptions {
  std::string partition = {};
  std::int64_t lease_ns = 0;
  std::int64_t lifespan_ns = 0;
  std::int64_t max_blocking_ns = 100'000'000;
  std::function<void(std::uint32_t readers)> matched = {};
};

/// The part of a writer that does not depend on its type.
class WriterBase {
 public:
  dds_entity_t get() const { return writer_.get(); }
  std::uint32_t matched_readers() const;
  /// Renews a writer's lease. After it has run out, only a write revives the writer.
  void assert_liveliness();
  /// Waits until every matched reader has acknowledged all writes; false if that takes longer than `nanoseconds`.
  bool wait_for_acknowledgements(std::int64_t nanoseconds);

 protected:
  WriterBase(const TopicBase& topic, const wire_contract::TopicQos& row, WriterOptions options);
  [[nodiscard]] bool write_sample(const void* sample);
  void dispose_sample(const void* sample);

 private:
  std::string topic_name_;
  std::unique_ptr<EntityCallbacks> callbacks_;
  Entity publisher_;
  Entity writer_;
};

/// Writes samples of one type. Any thread may write.
template <class T>
class Writer : public WriterBase {
 public:
  explicit Writer(const Topic<T>& topic, WriterOptions options = {})
      : WriterBase(topic, topic.row(), std::move(options)) {}
  /// False: a reader was full for max_blocking_ns. Throws DdsError.
  [[nodiscard]] bool write(const T& sample) { return write_sample(&sample); }
  /// Disposes the instance of the sample's key; readers are notified.
  void dispose(const T& sample) { dispose_sample(&sample); }
};

/// Samples lent by a reader without a copy, returned by the destructor. The reader must outlive them.
template <class T>
class Loans {
 public:
  explicit Loans(dds_entity_t reader) : reader_(reader) {}
  ~Loans() {
    if (count_ > 0) { dds_return_loan(reader_, samples_, count_); }
  }
  Loans(Loans&& other) noexcept : reader_(other.reader_), count_(std::exchange(other.count_, 0)) {
    std::copy_n(other.samples_, kMost, samples_);
    std::copy_n(other.infos_, kMost, infos_);
  }
  Loans& operator=(Loans&&) = delete;

  std::size_t size() const { return static_cast<std::size_t>(count_); }
  /// If !info(i).valid_data, only the key is set.
  const T& operator[](std::size_t i) const { return *static_cast<const T*>(samples_[i]); }
  const dds_sample_info_t& info(std::size_t i) const { return infos_[i]; }

 private:
  template <class U>
  friend class Taker;
  static constexpr std::size_t kMost = 32;
  dds_entity_t reader_;
  std::int32_t count_ = 0;
  void* samples_[kMost] = {};
  dds_sample_info_t infos_[kMost];
};

/// The number of samples that a take returned; throws DdsError. 0 if the reader is being deleted while its callback
/// runs.
inline std::size_t taken_count(dds_return_t code) {
  if (code == DDS_RETCODE_BAD_PARAMETER || code == DDS_RETCODE_ALREADY_DELETED) { return 0; }
  return static_cast<std::size_t>(check(code, "take"));
}

/// Takes samples from a reader; cheap to copy, valid as long as the reader.
template <class T>
class Taker {
 public:
  explicit Taker(dds_entity_t reader) : reader_(reader) {}
  dds_entity_t reader() const { return reader_; }

  /// Takes the next sample into reused memory; false if there is none.
  [[nodiscard]] bool take(Sample<T>& sample) const {
    void* buffer = &sample.value_;
    return taken_count(dds_take(reader_, &buffer, &sample.info_, 1, 1)) > 0;
  }
  /// Takes the waiting samples in one call, at most samples.size() and at most 16; returns their number. A smaller
  /// number means that none is left.
  [[nodiscard]] std::size_t take(std::span<Sample<T>* const> samples) const {
    constexpr std::size_t kMost = 16;
    void* buffers[kMost];
    dds_sample_info_t infos[kMost];
    const std::size_t most = std::min(samples.size(), kMost);
    for (std::size_t i = 0; i < most; ++i) { buffers[i] = &samples[i]->value_; }
    const std::size_t count = taken_count(dds_take(reader_, buffers, infos, most, static_cast<std::uint32_t>(most)));
    for (std::size_t i = 0; i < count; ++i) { samples[i]->info_ = infos[i]; }
    return count;
  }
  /// Borrows up to 32 samples; call it until it returns none.
  Loans<T> take_loans() const {
    Loans<T> loans(reader_);
    loans.count_ = static_cast<std::int32_t>(
        taken_count(dds_take(reader_, loans.samples_, loans.infos_, Loans<T>::kMost, Loans<T>::kMost)));
    return loans;
  }

 private:
  dds_entity_t reader_;
};

/// data       called when samples wait; its taker is valid even before the reader's constructor has returned
/// matched    called with the number of matched writers whenever that changes
/// partition  of the subscriber made for it; empty: the default one
template <class T>
struct ReaderOptions {
  std::function<void(Taker<T>)> data = {};
  std::function<void(std::uint32_t writers)> matched = {};
  std::function<void(const Liveliness&)> liveliness = {};
  std::string partition = {};
};

/// The part of a reader that does not depend on its type.
class ReaderBase {
 public:
  dds_entity_t get() const { return reader_.get(); }
  std::uint32_t matched_writers() const;
  /// Handles of the matched writers: publication_handle in the info of their samples.
  std::vector<dds_instance_handle_t> matched_writer_handles() const;

 protected:
  ReaderBase(const TopicBase& topic, const wire_contract::TopicQos& row, const std::string& partition,
             EntityCallbacks callbacks);

 private:
  std::unique_ptr<EntityCallbacks> callbacks_;
  Entity subscriber_;
  Entity reader_;
};

template <class T>
class Reader : public ReaderBase {
 public:
  explicit Reader(const Topic<T>& topic, ReaderOptions<T> options = {})
      : ReaderBase(topic, topic.row(), options.partition,
                   {.data = on_data(std::move(options.data)),
                    .matched = std::move(options.matched),
                    .liveliness = std::move(options.liveliness)}) {}
  Taker<T> taker() const { return Taker<T>(get()); }
  [[nodiscard]] bool take(Sample<T>& sample) { return taker().take(sample); }
  Loans<T> take_loans() { return taker().take_loans(); }

 private:
  static std::function<void(dds_entity_t)> on_data(std::function<void(Taker<T>)> callback) {
    if (!callback) { return {}; }
    return [callback = std::move(callback)](dds_entity_t reader) { callback(Taker<T>(reader)); };
  }
};

/// Waits for samples of readers without callbacks. One thread waits; any thread may wake() it.
class WaitSet {
 public:
  explicit WaitSet(const Participant& participant);
  /// Makes wait() return `token` while samples wait in the reader. The token must not be -1.
  void attach(const ReaderBase& reader, std::intptr_t token);
  /// Makes the current or next wait() return at once.
  void wake();
  /// Returns the tokens of readers with samples; empty after `nanoseconds`, or after wake() without samples.
  std::vector<std::intptr_t> wait(std::int64_t nanoseconds);

 private:
  static constexpr std::intptr_t kWakeToken = -1;
  Entity wake_condition_;
  std::vector<Entity> conditions_;
  Entity waitset_;
  std::size_t attached_ = 1;
};

}  // namespace collided::dds
