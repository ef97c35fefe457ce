#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <unordered_map>
#include <vector>

#include "idl/cdr.hpp"
#include "idl/recording/opening_commands.hpp"
#include "idl/recording/recorded_topics.hpp"
#include "server/service/durability/inventory.hpp"

namespace collided::engine::service {

/// The channel of the inventory's changes by commands: records of the window that only openings read. A file left by a
/// crash contains them too, and readers ignore them; other files leave them out, since they have the commands.
inline constexpr std::uint16_t kInventoryChannel = static_cast<std::uint16_t>(recording::kRecordedTopics.size() + 1);

/// Calls put() with queries of no topic that hold these changes, each small enough for a record.
///
/// own_commands  how many commands the server had issued itself by then: the changes include theirs
void write_changes(const Inventory::Changes& changes, std::uint64_t own_commands,
                   const std::function<void(const wire::Query&)>& put);

/// The state at the beginning of a window of records: the newest definition and pose of every earlier object, the
/// inventory of commands, the open contacts, and the state of standing questions. It is folded from the records that
/// leave the window.
///
/// limits   kMostBytes of definitions, kMostKeptBytes of the inventory, kMostHeldBytes of contacts and standing state;
///          what does not fit is left out and counted
/// threads  one
class FlightOpening {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{32} << 20;
  static constexpr std::size_t kMostKeptBytes = std::size_t{64} << 20;
  static constexpr std::size_t kMostHeldBytes = std::size_t{16} << 20;
  static constexpr std::size_t kMostObjects = 200'000;
  static constexpr std::size_t kMostUnanswered = 64;
  static constexpr std::size_t kMostNoted = 4'096;
  /// Up to this many standing questions are written as one command each, so that a refused one affects no other; beyond
  /// it, many per command.
  static constexpr std::size_t kMostSingleFences = 100;

  /// forget_after_ns  how long a lost publisher's objects stay, before their lost policies apply
  explicit FlightOpening(std::int64_t forget_after_ns = 0) : forget_after_ns_(forget_after_ns) {}

  /// Folds whole MCAP message records, oldest first, in the format of flight_ring.hpp.
  void fold(std::span<const std::byte> records);
  void fold(const wire::Definition& definition);
  void fold(const wire::PoseBatch& batch);
  /// A command counts from its changes on. A command with neither changes nor an answer yet is in flight.
  void fold(const wire::Query& query);
  void fold(const wire::Reply& reply);
  /// Takes one of the queries of write_changes().
  void fold_changes(const wire::Query& query);
  void fold(const wire::Status& status);
  void fold(const wire::ContactShard& shard);
  void fold(const wire::StandingShard& shard);

  /// Calls put(channel, CDR bytes) with samples that restore the same state: all definitions, then for each publisher
  /// its poses with the number of its newest sample, then the commands, those in flight last, then the contacts, then
  /// the state of standing questions. The client of a standing question's command is the one with which it is removed;
  /// 0: none.
  void write(const std::function<void(recording::Recorded, std::span<const std::byte>)>& put) const;
  /// Numbers of the newest kMostNoted commands of clients that are included, oldest first.
  std::vector<recording::CommandNumber> noted_commands() const { return {noted_.begin(), noted_.end()}; }
  /// Samples that had no room; the restored state lacks them.
  std::uint64_t left_out() const { return left_out_; }

 private:
  /// The newest definition of an object; `bytes` is its Definition in CDR.
  struct Defined {
    std::uint64_t sequence = 0;
    std::uint8_t lost_policy = 0;
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
    std::vector<std::byte> itself;  // the publisher's own Definition, in CDR; empty: there is none
    bool was_listed = false;        // a status has named it
    bool lost = false;
    std::int64_t lost_ns = 0;                            // world time of the first status that reports it
    std::unordered_map<std::uint32_t, Defined> objects;  // by object number
    std::unordered_map<std::uint32_t, Posed> poses;      // by object number; may exist before the definition
  };
  struct Unanswered {
    recording::CommandNumber number;
    std::vector<std::byte> bytes;  // its Query in CDR
  };
  using Shards = std::map<std::uint8_t, std::vector<std::byte>>;  // the newest of each that is not empty
  template <class Shard>
  void hold(const Shard& shard, std::size_t row_count, Shards& shards);
  Publisher* meet(std::uint64_t id, std::uint64_t incarnation);
  void forget(Publisher& publisher);
  void drop(Publisher& publisher, std::uint32_t number, const Defined& defined);
  bool is_there(const Publisher& publisher, const Defined& defined) const;
  void take_published(const std::string& name);
  void keep(KeptCommand command);
  void write_kept(const std::function<void(recording::Recorded, std::span<const std::byte>)>& put) const;

  std::int64_t forget_after_ns_;
  std::int64_t newest_status_ns_ = 0;  // world time
  std::map<std::uint64_t, Publisher> publishers_;
  KeptCommands kept_;
  std::deque<Unanswered> unanswered_;
  std::deque<recording::CommandNumber> noted_;
  Shards contacts_;
  Shards standing_;
  std::size_t held_bytes_ = 0;  // of both
  std::size_t bytes_ = 0;       // of definitions
  std::size_t objects_ = 0;
  std::size_t poses_ = 0;
  std::uint64_t left_out_ = 0;
  std::vector<double> rows_;  // poses of the current batch
};

}  // namespace collided::engine::service
