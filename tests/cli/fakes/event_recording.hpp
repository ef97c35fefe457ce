#pragma once

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/columns.hpp"
#include "idl/mcap/output.hpp"
#include "idl/recording/recorded_topics.hpp"
#include "idl/topics.hpp"
#include "tests/service/wire/standing_messages.hpp"

namespace collided::test {

/// Writes what a server reported, as `collide record` would have it: times in seconds since 1970, a sample a chunk.
class EventRecording {
 public:
  using Kind = wire_contract::EventKind;
  using Reason = wire_contract::EndReason;
  struct Change {
    Kind kind;
    std::uint64_t a, b;
    std::uint64_t episode;
    double low_s = 0, high_s = 0;  // before the frame's time
    Reason reason = Reason::none;
  };
  struct Contact {
    std::uint64_t a, b;
    std::uint64_t episode;
    double began_s;
  };

  /// opening  samples from before the recording
  explicit EventRecording(const std::string& path, std::uint64_t opening = 0)
      : output_(path), writer_(output_, recording::library_name(), recording::channels_of("collided")) {
    writer_.metadata("recording", {{"opening_messages", std::to_string(opening)}});
  }
  ~EventRecording() { static_cast<void>(writer_.close()); }
  EventRecording(const EventRecording&) = delete;
  EventRecording& operator=(const EventRecording&) = delete;

  void begin_life(std::uint64_t epoch) { server_.epoch = epoch; }
  void name(std::uint64_t id, const std::string& name) { server_.names[id] = name; }

  void frame(double time_s, std::uint64_t first_sequence, const std::vector<Change>& changes) {
    Columns columns;
    std::vector<std::uint8_t> kinds, reasons, shards;
    for (const Change& change : changes) {
      columns.add(change.a, change.b, change.episode);
      columns.numbers.insert(columns.numbers.end(), {change.low_s, change.high_s, -1, 0, 0, 1e-9});
      kinds.push_back(static_cast<std::uint8_t>(change.kind));
      reasons.push_back(static_cast<std::uint8_t>(change.reason));
      shards.push_back(wire_contract::contact_shard(change.a, change.b));
    }
    dds::Sample<wire::EventFrame> frame;
    frame->first_sequence = first_sequence;
    frame->world_time_ns = ns(time_s);
    dds::borrow(frame->kinds, kinds);
    dds::borrow(frame->reasons, reasons);
    dds::borrow(frame->shards, shards);
    put<wire::EventFrame>(recording::Recorded::event, time_s, frame, columns, wire::kEventColumns);
  }

  /// The contacts of one shard.
  void shard(double time_s, std::uint64_t as_of, const std::vector<Contact>& contacts) {
    shard(time_s, as_of, contacts, wire_contract::contact_shard(contacts.front().a, contacts.front().b));
  }
  /// As a server does that has just started.
  void empty_shards(double time_s) {
    for (std::uint32_t number = 0; number < wire_contract::kContactShards; ++number)
      shard(time_s, 0, {}, static_cast<std::uint8_t>(number));
  }
  void shard(double time_s, std::uint64_t as_of, const std::vector<Contact>& contacts, std::uint8_t number) {
    Columns columns;
    std::vector<std::int64_t> began;
    for (const Contact& contact : contacts) {
      columns.add(contact.a, contact.b, contact.episode);
      began.push_back(ns(contact.began_s));
    }
    dds::Sample<wire::ContactShard> shard;
    shard->shard = number;
    shard->as_of_sequence = as_of;
    dds::borrow(shard->began_ns, began);
    put<wire::ContactShard>(recording::Recorded::contact, time_s, shard, columns, wire::kContactColumns);
  }

  void status(double time_s, std::uint64_t last_sequence, const std::vector<Contact>& contacts = {}) {
    dds::Sample<wire::Status> status;
    status->server = server_.server;
    status->epoch = server_.epoch;
    status->world_time_ns = ns(time_s);
    status->last_event_sequence = last_sequence;
    status->state = static_cast<std::uint8_t>(wire_contract::ServerState::ready);
    for (const Contact& contact : contacts)
      status->contact_hash += wire_contract::contact_hash(contact.a, contact.b, contact.episode);
    status->contact_count = static_cast<std::uint32_t>(contacts.size());
    write(recording::Recorded::status, time_s, *status);
  }

  void standing_frame(double time_s, std::uint64_t first_sequence, const std::vector<StandingRow>& rows) {
    auto frame = server_.frame(ns(time_s), first_sequence, rows);
    write(recording::Recorded::standing_event, time_s, frame.message());
  }
  /// What holds, of one shard.
  void standing_shard(double time_s, std::uint64_t as_of, const std::vector<StandingStay>& stays) {
    const std::uint8_t number = wire_contract::contact_shard(stays.front().object, stays.front().standing);
    auto shard = server_.shard(ns(time_s), number, as_of, stays);
    write(recording::Recorded::standing_state, time_s, shard.message());
  }
  /// How much holds, of all shards.
  void standing_sum(double time_s, std::uint64_t as_of, const std::vector<StandingStay>& stays) {
    auto sum = server_.sum(ns(time_s), as_of, stays);
    write(recording::Recorded::standing_state, time_s, sum.message());
  }

 private:
  struct Columns {
    std::vector<std::uint64_t> a, b, episodes, ids;
    std::vector<std::uint32_t> triangles;
    std::vector<double> numbers;
    void add(std::uint64_t first, std::uint64_t second, std::uint64_t episode) {
      a.push_back(first);
      b.push_back(second);
      ids.insert(ids.end(), {first, second});
      episodes.push_back(episode);
      triangles.push_back(wire_contract::kNoTriangle);
      numbers.insert(numbers.end(), {1, 2, 0.5, 0, 0, 1, 0.004, 1e-15, 0, 0, 1, 0.004, 1e-15});
    }
  };

  static std::int64_t ns(double time_s) { return std::llround(time_s * 1e9); }

  template <class T>
  void put(recording::Recorded topic, double time_s, dds::Sample<T>& sample, Columns& columns, wire::Columns<T> named) {
    sample->server = server_.server;
    sample->epoch = server_.epoch;
    dds::borrow(sample->a, columns.a);
    dds::borrow(sample->b, columns.b);
    dds::borrow(sample->a_triangles, columns.triangles);
    dds::borrow(sample->b_triangles, columns.triangles);
    dds::borrow(sample->episodes, columns.episodes);
    const std::vector<std::uint8_t> doubts(columns.a.size(), 0);
    dds::borrow(sample->doubts, doubts);
    std::vector<double> memory;
    wire::lend_columns(columns.numbers, named, memory, *sample);
    std::vector<std::uint64_t> ids;
    std::vector<std::string> names;
    for (const std::uint64_t id : columns.ids) {
      if (!server_.names.contains(id)) continue;
      ids.push_back(id);
      names.push_back(server_.names.at(id));
    }
    const std::vector<std::uint8_t> packed = wire_contract::pack_names(names);
    dds::borrow(sample->named_ids, ids);
    dds::borrow(sample->names, packed);
    write(topic, time_s, *sample);
  }

  template <class T>
  void write(recording::Recorded topic, double time_s, const T& sample) {
    std::vector<std::byte> bytes(wire::cdr_size(sample));
    wire::write_cdr(sample, bytes);
    const auto time = static_cast<std::uint64_t>(ns(time_s));
    writer_.write(static_cast<std::uint16_t>(topic), time, time, bytes);
    writer_.flush();
  }

  mcap::FileOutput output_;
  mcap::FileWriter writer_;
  StandingServer server_;
};

}  // namespace collided::test
