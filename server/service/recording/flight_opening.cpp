#include "server/service/recording/flight_opening.hpp"

#include <algorithm>
#include <cstring>
#include <nlohmann/json.hpp>

#include "idl/columns.hpp"
#include "idl/command_table.hpp"
#include "idl/mcap/format.hpp"
#include "idl/packed_fences.hpp"

namespace collided::engine::service {
namespace {

using nlohmann::json;
using recording::Recorded;
using wire_contract::kPoseNumbers;
namespace names = wire_contract::command;

/// Packed bytes in one query; DDS delivers no message above kMaxMessageBytes.
constexpr std::size_t kMostPacked = wire_contract::kMaxMessageBytes - std::size_t{64} * 1024;
constexpr const char* kManyFences = R"({"command":"fence","many":true})";

template <class T>
void fold_as(FlightOpening& opening, std::span<const std::byte> data) {
  dds::Sample<T> sample;
  if (wire::read_cdr(data, sample)) opening.fold(*sample);
}

/// A query that borrows the blob and holds as much of the text as fits: longer texts are only packed.
dds::Sample<wire::Query> query_of(std::uint64_t client, std::string_view text, std::span<const std::uint8_t> blob) {
  dds::Sample<wire::Query> query;
  query->client = client;
  query->kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::command);
  query->chunk_count = 1;
  static_cast<void>(dds::set_text(query->text, text));
  dds::borrow(query->blob, blob);
  return query;
}

std::span<const std::uint8_t> octets_of(std::span<const std::byte> bytes) {
  return {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()};
}

bool is_recorded_command(const wire::Query& query) {
  if (query.kind != static_cast<std::uint8_t>(wire_contract::QuestionKind::command)) return false;
  const json arguments = json::parse(query.text, nullptr, false);
  const auto what = arguments.is_object() ? arguments.find("command") : arguments.end();
  if (!arguments.is_object() || what == arguments.end() || !what->is_string()) return false;
  const names::CommandSpec* const spec = names::find_command(what->get_ref<const std::string&>());
  return spec != nullptr && spec->is_recorded_change();
}

}  // namespace

void write_changes(const Inventory::Changes& changes, std::uint64_t own_commands,
                   const std::function<void(const wire::Query&)>& put) {
  std::vector<std::uint8_t> packed;
  const auto send = [&] {
    dds::Sample<wire::Query> query = query_of(changes.client, "", packed);
    query->request = changes.request;
    query->barrier_sequence = own_commands;
    put(*query);
    packed.clear();
  };
  const auto add = [&](const json& change, std::span<const std::byte> blob) {
    const std::string text = change.dump(-1, ' ', false, json::error_handler_t::replace);
    if (!packed.empty() && packed.size() + text.size() + blob.size() > kMostPacked) send();
    wire_contract::pack_fence(packed, text, octets_of(blob));
  };
  for (const KeptKey& key : changes.erased) add({{"erase", key.text()}}, {});
  for (const KeptCommand& command : changes.put)
    add({{"put", command.key.text()}, {"text", command.text}, {"owner", command.owner}}, command.blob);
  send();
}

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
      case Recorded::reply:
        if (!unanswered_.empty()) fold_as<wire::Reply>(*this, data);
        break;
      case Recorded::contact: fold_as<wire::ContactShard>(*this, data); break;
      case Recorded::standing_state: fold_as<wire::StandingShard>(*this, data); break;
      case Recorded::status: fold_as<wire::Status>(*this, data); break;
      default:
        if (dds::Sample<wire::Query> query; channel == kInventoryChannel && wire::read_cdr(data, query))
          fold_changes(*query);
    }
    records = records.subspan(whole);
  }
}

/// The publisher in its newest run; null for a sample of an earlier one, or if there are too many publishers.
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

/// Subtracts an object that is about to be erased from the sums.
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
  publisher->objects[definition.object_number] = {definition.sequence_number, policy, definition.name,
                                                  std::move(bytes)};
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

void FlightOpening::fold(const wire::Query& query) {
  if (!is_recorded_command(query)) return;
  const recording::CommandNumber number{query.client, query.request};
  if (query.client != 0) noted_.push_back(number);
  if (noted_.size() > kMostNoted) noted_.pop_front();
  unanswered_.push_back({number, wire::cdr_bytes(query)});
  if (unanswered_.size() <= kMostUnanswered) return;
  unanswered_.pop_front();
  ++left_out_;
}

void FlightOpening::fold(const wire::Reply& reply) {
  if (reply.request == 0 || reply.status == static_cast<std::uint8_t>(wire_contract::ReplyStatus::progress)) return;
  std::erase_if(unanswered_, [&](const Unanswered& command) {
    return command.number == recording::CommandNumber{reply.client, reply.request};
  });
}

void FlightOpening::fold_changes(const wire::Query& query) {
  std::erase_if(unanswered_, [&](const Unanswered& command) {
    const auto& [client, request] = command.number;
    return client == 0 ? request <= query.barrier_sequence : client == query.client && request == query.request;
  });
  const auto packed = wire_contract::unpack_fences(std::as_bytes(dds::view(query.blob)));
  if (!packed) return;
  for (const wire_contract::PackedFence& one : *packed) {
    const json change = json::parse(one.arguments, nullptr, false);
    if (!change.is_object()) continue;
    if (const auto key = KeptKey::parse(change.value("erase", ""))) {
      kept_.erase(*key);
      if (key->kind == KeptKind::published) take_published(key->name);
    }
    if (const auto key = KeptKey::parse(change.value("put", ""))) {
      keep({.key = *key,
            .text = change.value("text", ""),
            .blob = {one.shape.begin(), one.shape.end()},
            .owner = change.value("owner", std::uint64_t{0})});
    }
  }
}

/// Changes of the shards are not part of the world.
void FlightOpening::keep(KeptCommand command) {
  if (command.key.kind == KeptKind::succession) return;
  const bool has_room = command.text.size() < sizeof(wire::Query::text) || command.key.kind == KeptKind::fence;
  const KeptKey key = command.key;
  kept_.put(std::move(command));
  if (has_room && kept_.bytes() <= kMostKeptBytes) return;
  kept_.erase(key);
  ++left_out_;
}

/// Commands remove objects of lost publishers, never those of a live one.
void FlightOpening::take_published(const std::string& name) {
  for (auto& [id, publisher] : publishers_) {
    if (!publisher.lost) continue;
    std::erase_if(publisher.objects, [&](const auto& object) {
      const bool is_gone = object.second.name == name;
      if (is_gone) drop(publisher, object.first, object.second);
      return is_gone;
    });
  }
}

/// A status lists the lost publishers. One that it no longer lists has left, or was lost long ago and has nothing in
/// the world: it is forgotten.
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

void FlightOpening::fold(const wire::ContactShard& shard) { hold(shard, shard.a._length, contacts_); }
void FlightOpening::fold(const wire::StandingShard& shard) { hold(shard, shard.objects._length, standing_); }

template <class Shard>
void FlightOpening::hold(const Shard& shard, std::size_t row_count, Shards& shards) {
  // The sum of standing questions is left out. The window has sums of its own, and a reader counts missing events from
  // the first one.
  if (shard.shard >= wire_contract::kContactShards) return;
  const auto known = shards.find(shard.shard);
  if (known != shards.end()) {
    held_bytes_ -= known->second.size();
    shards.erase(known);
  }
  if (row_count == 0) return;
  std::vector<std::byte> bytes = wire::cdr_bytes(shard);
  // A reader can detect the missing shard: the status, or the sum, then counts more.
  if (held_bytes_ + bytes.size() > kMostHeldBytes) {
    ++left_out_;
    return;
  }
  held_bytes_ += bytes.size();
  shards[shard.shard] = std::move(bytes);
}

/// Whether the object is in the world. An object that left with its lost publisher is not, but stays known: the
/// publisher may return with it.
bool FlightOpening::is_there(const Publisher& publisher, const Defined& defined) const {
  return !publisher.lost || newest_status_ns_ - publisher.lost_ns < forget_after_ns_ ||
         defined.lost_policy != static_cast<std::uint8_t>(wire_contract::LostPolicy::remove);
}

void FlightOpening::write(const std::function<void(Recorded, std::span<const std::byte>)>& put) const {
  for (const auto& [id, publisher] : publishers_) {
    if (!publisher.itself.empty()) put(Recorded::object, publisher.itself);
    // In the order of their definitions, since ties between objects are broken by their age.
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
    send();  // even an empty one: it carries the newest sample's number
  }
  write_kept(put);
  for (const Unanswered& command : unanswered_) put(Recorded::query, command.bytes);
  for (const auto& [shard, bytes] : contacts_) put(Recorded::contact, bytes);
  for (const auto& [shard, bytes] : standing_) put(Recorded::standing_state, bytes);
}

void FlightOpening::write_kept(const std::function<void(Recorded, std::span<const std::byte>)>& put) const {
  std::size_t fence_count = 0;
  kept_.for_each([&](const KeptCommand& command) { fence_count += command.key.kind == KeptKind::fence ? 1 : 0; });
  const auto send = [&](std::uint64_t client, std::string_view text, std::span<const std::uint8_t> blob) {
    put(Recorded::query, wire::cdr_bytes(*query_of(client, text, blob)));
  };
  std::uint64_t owner = 0;
  std::vector<std::uint8_t> packed;
  const auto send_packed = [&] {
    if (!packed.empty()) send(owner, kManyFences, packed);
    packed.clear();
  };
  kept_.for_each([&](const KeptCommand& command) {
    const bool is_fence = command.key.kind == KeptKind::fence;
    // A long polygon may have more corners than fit into a text; the bytes of several commands have room.
    const bool is_single =
        !is_fence || (fence_count <= kMostSingleFences && command.text.size() < sizeof(wire::Query::text));
    const bool is_full = packed.size() + command.text.size() + command.blob.size() > kMostPacked;
    if (is_single || is_full || command.owner != owner) send_packed();
    owner = is_fence ? command.owner : 0;
    if (is_single) send(owner, command.text, octets_of(command.blob));
    else wire_contract::pack_fence(packed, command.text, octets_of(command.blob));
  });
  send_packed();
}

}  // namespace collided::engine::service
