#include "server/service/recording/flight_opening.hpp"

#include <algorithm>
#include <cstring>

#include "idl/columns.hpp"
#include "idl/mcap/format.hpp"

namespace collided::engine::service {
namespace {

using recording::Recorded;
using wire_contract::kPoseNumbers;

template <class T>
void fold_as(FlightOpening& opening, std::span<const std::byte> data) {
  dds::Sample<T> sample;
  if (wire::read_cdr(data, sample)) opening.fold(*sample);
}

}  // namespace

void FlightOpening::fold(std::span<const std::byte> records) {
  while (records.size() >= mcap::kMessagePrefixBytes) {
    std::uint64_t length = 0;
    std::uint16_t channel = 0;
    std::memcpy(&length, records.data() + 1, sizeof length);
    std::memcpy(&channel, records.data() + mcap::kRecordPrefixBytes, sizeof channel);
    const std::size_t whole = mcap::kRecordPrefixBytes + length;
    const std::span<const std::byte> data = records.first(whole).subspan(mcap::kMessagePrefixBytes);
    switch (static_cast<Recorded>(channel)) {
      case Recorded::object: fold_as<wire::Definition>(*this, data); break;
      case Recorded::pose: fold_as<wire::PoseBatch>(*this, data); break;
      case Recorded::query: fold_as<wire::Query>(*this, data); break;
      case Recorded::reply: fold_as<wire::Reply>(*this, data); break;
      case Recorded::contact: fold_as<wire::ContactShard>(*this, data); break;
      case Recorded::fence_state: fold_state(data); break;
      case Recorded::status: fold_as<wire::Status>(*this, data); break;
      default: break;
    }
    records = records.subspan(whole);
  }
}

/// The publisher in its newest run; null for a sample of an earlier one, or where there are too many publishers.
FlightOpening::Publisher* FlightOpening::meet(std::uint64_t id, std::uint64_t incarnation) {
  constexpr std::size_t kMostPublishers = 1'000;
  const bool known = publishers_.count(id) > 0;
  if (!known && publishers_.size() >= kMostPublishers) {
    ++left_out_;
    return nullptr;
  }
  Publisher& publisher = publishers_[id];
  if (incarnation < publisher.incarnation) return nullptr;
  if (incarnation > publisher.incarnation) {
    forget(publisher);
    publisher = {};
    publisher.incarnation = incarnation;
  }
  return &publisher;
}

void FlightOpening::forget(Publisher& publisher) {
  for (const auto& [number, defined] : publisher.objects) bytes_ -= defined.bytes.size();
  objects_ -= publisher.objects.size();
  poses_ -= publisher.poses.size();
}

/// Takes an object that is about to be erased out of the sums.
void FlightOpening::drop(Publisher& publisher, std::uint32_t number, const Defined& defined) {
  bytes_ -= defined.bytes.size();
  --objects_;
  poses_ -= publisher.poses.erase(number);
}

void FlightOpening::fold(const wire::Definition& definition) {
  Publisher* publisher = meet(definition.publisher, definition.incarnation);
  if (publisher == nullptr) return;
  publisher->last_sequence = std::max<std::uint64_t>(publisher->last_sequence, definition.sequence_number);
  publisher->definitions_through = std::max<std::uint64_t>(publisher->definitions_through, definition.sequence_number);
  if (definition.object_number == wire_contract::kObjectPublisherItself) {
    if (definition.shape._length == 0) publisher->itself = wire::cdr_bytes(definition);
    return;
  }
  const auto found = publisher->objects.find(definition.object_number);
  if (found != publisher->objects.end()) {
    if (found->second.sequence > definition.sequence_number) return;
    bytes_ -= found->second.bytes.size();
    --objects_;
    publisher->objects.erase(found);
  }
  const auto posed = publisher->poses.find(definition.object_number);
  // The definition has a pose of its own, which replaces an older one.
  if (posed != publisher->poses.end() && posed->second.sequence < definition.sequence_number) {
    publisher->poses.erase(posed);
    --poses_;
  }
  if (definition.removed) return;
  std::vector<std::byte> bytes = wire::cdr_bytes(definition);
  if (objects_ >= kMostObjects || bytes_ + bytes.size() > kMostBytes) {
    ++left_out_;
    return;
  }
  bytes_ += bytes.size();
  ++objects_;
  const std::uint8_t policy =
      definition.lost_policy & static_cast<std::uint8_t>(~wire_contract::kPolicyEntersWithInstant);
  publisher->objects[definition.object_number] = {definition.sequence_number, policy, definition.moving,
                                                  definition.name, std::move(bytes)};
}

void FlightOpening::fold(const wire::PoseBatch& batch) {
  Publisher* publisher = meet(batch.publisher, batch.incarnation);
  const auto numbers = dds::view(batch.object_numbers);
  if (publisher == nullptr || wire::row_count<wire::PoseBatch>(batch, wire::kPoseColumns) != numbers.size()) return;
  wire::gather_rows<wire::PoseBatch>(batch, wire::kPoseColumns, rows_);
  publisher->last_sequence = std::max<std::uint64_t>(publisher->last_sequence, batch.sequence_number);
  const bool is_only_alive = numbers.empty() && (batch.flags & wire_contract::kPosesStreamed) != 0;
  if (!is_only_alive)
    publisher->source_time_ns = std::max<std::int64_t>(publisher->source_time_ns, batch.source_time_ns);
  for (std::size_t i = 0; i < numbers.size(); ++i) {
    // Poses may come before the definition of their object, which is on a topic of its own.
    const auto defined = publisher->objects.find(numbers[i]);
    if (defined != publisher->objects.end() && defined->second.sequence > batch.sequence_number) continue;
    if (poses_ >= 2 * kMostObjects && publisher->poses.count(numbers[i]) == 0) {
      ++left_out_;
      continue;
    }
    const auto [place, is_new] = publisher->poses.try_emplace(numbers[i]);
    Posed& posed = place->second;
    poses_ += is_new ? 1 : 0;
    if (posed.sequence > batch.sequence_number) continue;
    posed.sequence = batch.sequence_number;
    std::copy_n(rows_.begin() + static_cast<std::ptrdiff_t>(i * kPoseNumbers), kPoseNumbers, posed.pose.begin());
  }
}

void FlightOpening::fold(const wire::Reply& reply) {
  commands_.answered(reply,
                     [this](const std::string* name, bool moving_only) { return take_published(name, moving_only); });
}

/// Commands remove what lost publishers left, never what a living one has.
bool FlightOpening::take_published(const std::string* name, bool moving_only) {
  bool found = false;
  for (auto& entry : publishers_) {
    auto& publisher = entry.second;
    if (!publisher.lost) continue;
    std::erase_if(publisher.objects, [&](const auto& object) {
      const Defined& defined = object.second;
      const bool gone = (name == nullptr || defined.name == *name) && (defined.moving || !moving_only);
      if (gone) drop(publisher, object.first, defined);
      found = found || gone;
      return gone;
    });
  }
  return found;
}

/// A status says which publishers are lost. One that it no longer lists has left, or was lost long ago and has nothing
/// in the world: it is forgotten.
void FlightOpening::fold(const wire::Status& status) {
  const auto ids = dds::view(status.publishers);
  const auto states = dds::view(status.publisher_states);
  if (ids.size() != states.size()) return;
  newest_status_ns_ = std::max<std::int64_t>(newest_status_ns_, status.world_time_ns);
  std::map<std::uint64_t, std::uint8_t> listed;
  for (std::size_t i = 0; i < ids.size(); ++i) listed[ids[i]] = states[i];
  for (auto next = publishers_.begin(); next != publishers_.end();) {
    const auto here = next++;
    Publisher& publisher = here->second;
    const auto state = listed.find(here->first);
    if (state != listed.end()) {
      publisher.was_listed = true;
      const bool is_lost = state->second == static_cast<std::uint8_t>(wire_contract::PublisherState::lost);
      if (is_lost && !publisher.lost) publisher.lost_ns = status.world_time_ns;
      publisher.lost = is_lost;
    } else if (publisher.was_listed) {  // else its first samples are newer than the status
      forget(publisher);
      publishers_.erase(here);
    }
  }
}

void FlightOpening::fold_state(std::span<const std::byte> data) {
  dds::Sample<wire::ContactShard> shard;
  if (wire::read_cdr(data, shard)) fold_fences(*shard);
}

void FlightOpening::hold(const wire::ContactShard& shard, Shards& shards) {
  if (shard.shard >= wire_contract::kContactShards) return;
  const auto known = shards.find(shard.shard);
  if (known != shards.end()) {
    contact_bytes_ -= known->second.size();
    shards.erase(known);
  }
  if (shard.a._length == 0) return;
  std::vector<std::byte> bytes = wire::cdr_bytes(shard);
  // A reader can tell that the shard is missing: the status then counts more contacts.
  if (contact_bytes_ + bytes.size() > kMostContactBytes) {
    ++left_out_;
    return;
  }
  contact_bytes_ += bytes.size();
  shards[shard.shard] = std::move(bytes);
}

/// Whether the object is in the world. One that has left with its lost publisher is not, but stays known: the publisher
/// may come back with it.
bool FlightOpening::is_there(const Publisher& publisher, const Defined& defined) const {
  return !publisher.lost || newest_status_ns_ - publisher.lost_ns < forget_after_ns_ ||
         defined.lost_policy != static_cast<std::uint8_t>(wire_contract::LostPolicy::remove);
}

void FlightOpening::write(const std::function<void(Recorded, std::span<const std::byte>)>& put) const {
  for (const auto& [id, publisher] : publishers_) {
    if (!publisher.itself.empty()) put(Recorded::object, publisher.itself);
    // In the order in which they were defined, since ties between objects are broken by their age.
    std::map<std::uint64_t, const Defined*> by_age;
    for (const auto& [number, defined] : publisher.objects) {
      if (is_there(publisher, defined)) by_age[defined.sequence] = &defined;
    }
    for (const auto& [sequence, defined] : by_age) put(Recorded::object, defined->bytes);
  }
  for (const auto& [id, publisher] : publishers_) {
    if (publisher.objects.empty()) continue;
    dds::Sample<wire::PoseBatch> batch;
    batch->publisher = id;
    batch->incarnation = publisher.incarnation;
    batch->sequence_number = publisher.last_sequence;
    batch->definitions_through = publisher.definitions_through;
    batch->source_time_ns = publisher.source_time_ns;
    batch->flags = wire_contract::kPosesTeleported;
    std::vector<std::uint32_t> numbers;
    std::vector<double> poses, columns;
    const auto send = [&] {
      dds::borrow(batch->object_numbers, numbers);
      wire::lend_columns<wire::PoseBatch>(poses, wire::kPoseColumns, columns, *batch);
      put(Recorded::pose, wire::cdr_bytes(*batch));
      numbers.clear();
      poses.clear();
    };
    for (const auto& [number, posed] : publisher.poses) {
      const auto defined = publisher.objects.find(number);
      if (defined == publisher.objects.end() || !is_there(publisher, defined->second)) continue;
      numbers.push_back(number);
      poses.insert(poses.end(), posed.pose.begin(), posed.pose.end());
      if (numbers.size() == wire_contract::kMaxPosesPerBatch) send();
    }
    send();  // an empty one too: it carries the newest sample's number
  }
  commands_.write(put);
  for (const auto& [shard, bytes] : contacts_) put(Recorded::contact, bytes);
  for (const auto& [shard, bytes] : in_fences_) put(Recorded::fence_state, bytes);
}

}  // namespace collided::engine::service
