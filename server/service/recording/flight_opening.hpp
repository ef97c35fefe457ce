#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/recording/opening_commands.hpp"
#include "idl/recording/recorded_topics.hpp"
#include "server/service/recording/flight_commands.hpp"

namespace collided::engine::service {

/// The state that a window of records begins with: the newest definition and pose of every object sent before it, the
/// commands that brought in the others and the fences, the contacts that held, and who was in which fence. It is folded
/// from the records that leave the window.
///
/// limits   kMostBytes of definitions, kMostContactBytes of contacts and fences; what does not fit is left out and counted
/// threads  one
class FlightOpening {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{32} << 20;
  static constexpr std::size_t kMostContactBytes = std::size_t{16} << 20;
  static constexpr std::size_t kMostObjects = 200'000;

  /// forget_after_ns  for so long a lost publisher's objects stay, before their lost policies apply
  explicit FlightOpening(std::int64_t forget_after_ns = 0) : forget_after_ns_(forget_after_ns) {}

  /// Folds whole MCAP message records, oldest first, as flight_ring.hpp makes them.
  void fold(std::span<const std::byte> records);
  void fold(const wire::Definition& definition);
  void fold(const wire::PoseBatch& batch);
  void fold(const wire::Query& query) { commands_.asked(query); }
  void fold(const wire::Reply& reply);
  void fold(const wire::Status& status);
  void fold(const wire::ContactShard& shard) { hold(shard, contacts_); }
  void fold_fences(const wire::ContactShard& shard) { hold(shard, in_fences_); }

  /// Calls put(channel, CDR bytes) with what makes the same state again: all definitions, then for each publisher its
  /// poses with the number of its newest sample, then the commands, then the contacts, then who is in fences.
  void write(const std::function<void(recording::Recorded, std::span<const std::byte>)>& put) const;
  /// Numbers of the commands that it has taken into account, the newest ones.
  std::vector<recording::CommandNumber> noted_commands() const { return commands_.noted(); }
  /// Samples that had no room; the state that is made again lacks them.
  std::uint64_t left_out() const { return left_out_ + commands_.left_out(); }

 private:
  /// An object as defined last; `bytes` is its Definition in CDR.
  struct Defined {
    std::uint64_t sequence = 0;
    std::uint8_t lost_policy = 0;
    bool moving = false;
    std::string name;
    std::vector<std::byte> bytes;
  };
  struct Posed {
    std::uint64_t sequence = 0;
    std::array<double, 7> pose{};  // m; then w x y z
  };
  struct Publisher {
    std::uint64_t incarnation = 0;
    std::uint64_t last_sequence = 0;
    std::uint64_t definitions_through = 0;
    std::int64_t source_time_ns = 0;
    std::vector<std::byte> itself;  // its Definition of the publisher itself, in CDR; empty: there is none
    bool was_listed = false;        // a status has named it
    bool lost = false;
    std::int64_t lost_ns = 0;                            // world time of the first status that says so
    std::unordered_map<std::uint32_t, Defined> objects;  // by object number
    std::unordered_map<std::uint32_t, Posed> poses;      // by object number; may be there before the definition
  };
  using Shards = std::map<std::uint8_t, std::vector<std::byte>>;  // the newest of each that holds any
  void fold_state(std::span<const std::byte> data);
  void hold(const wire::ContactShard& shard, Shards& shards);
  Publisher* meet(std::uint64_t id, std::uint64_t incarnation);
  void forget(Publisher& publisher);
  void drop(Publisher& publisher, std::uint32_t number, const Defined& defined);
  bool is_there(const Publisher& publisher, const Defined& defined) const;
  bool take_published(const std::string* name, bool moving_only);

  std::int64_t forget_after_ns_;
  std::int64_t newest_status_ns_ = 0;  // world time
  std::map<std::uint64_t, Publisher> publishers_;
  FlightCommands commands_;
  Shards contacts_;
  Shards in_fences_;
  std::size_t contact_bytes_ = 0;  // of both
  std::size_t bytes_ = 0;          // of definitions
  std::size_t objects_ = 0;
  std::size_t poses_ = 0;
  std::uint64_t left_out_ = 0;
  std::vector<double> rows_;  // poses of the batch at work
};

}  // namespace collided::engine::service
