#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/service/ingest/publishers.hpp"

namespace collided::model {
using namespace engine;

/// What Publishers promises, kept plainly: maps by publisher, number and name, and a list of all sequence numbers that came.
/// Nothing here is called twice for a sample that had to wait for a step: how often the world steps changes nothing.
class PlainPublishers {
 public:
  struct Object {
    enum class Place { gone, in_world, waits, taken_away } place = Place::gone;
    std::string name;
    LostPolicy policy = LostPolicy::remove;
    bool moving = true;
    std::uint32_t layers = 1;
    std::array<double, 7> pose{};
    std::optional<std::array<double, 6>> velocity;
    std::uint64_t defined_by = 0, posed_by = 0;  // sequences
    bool is_stale = false;
  };
  /// A definition of what is there, said again: it may have come before batches that were sent before it.
  struct SaidAgain {
    std::uint32_t number = 0;
    std::uint64_t sequence = 0;
    std::array<double, 7> pose{};
  };
  struct Party {
    std::uint64_t incarnation = 0, definitions_seen = 0;
    bool object_writer = false, pose_writer = false, lost = false, said_all = false;
    bool is_frozen = false;  // lost, and what is to be removed is still there
    std::int64_t lost_ns = 0;
    std::map<std::uint32_t, Object> objects;
    std::vector<std::uint32_t> numbers;  // in the order of their first definitions, which is that of coming back
    std::deque<service::PoseSample> parked;
    std::vector<SaidAgain> said_again;  // wait for the batches before them
    std::set<std::uint64_t> heard;      // sequences
    std::uint64_t through = 0, newest_definition = 0, newest_pose = 0;
    std::int64_t gap_since_ns = 0;
    bool says_no_times = false;  // its batches come without stamps: an empty one says that it rests
  };

  explicit PlainPublishers(const service::PublisherLimits& limits) : limits_(limits) {}

  void define(const service::DefinitionSample& sample, std::int64_t now_ns);
  void move(const service::PoseSample& sample, std::int64_t now_ns);
  void writer_lost(std::uint64_t publisher, service::WriterKind kind, std::int64_t now_ns);
  void writer_alive(std::uint64_t publisher, service::WriterKind kind);
  void settle(std::int64_t now_ns);
  /// Somebody else: a command of a user's.
  void add_other(const std::string& name) { owners_[name] = {0, 0}; }
  void remove_by_name(const std::string& name) { owners_.erase(name); }

  const Party* party(std::uint64_t id) const { return parties_.contains(id) ? &parties_.at(id) : nullptr; }
  std::size_t size() const { return parties_.size(); }
  /// (publisher, number) of who has the name in the world; publisher 0: somebody else.
  std::optional<std::pair<std::uint64_t, std::uint32_t>> owner(const std::string& name) const;
  const Object& object(const std::pair<std::uint64_t, std::uint32_t>& owner) const {
    return parties_.at(owner.first).objects.at(owner.second);
  }
  std::set<std::uint64_t> waiting_for(const std::string& name) const;
  service::PublisherCounts counts;
  std::uint64_t changes = 0;

 private:
  using Key = std::pair<std::uint64_t, std::uint32_t>;
  Party* meet(std::uint64_t id, std::uint64_t incarnation);
  void heard(std::uint64_t id, Party& party, service::WriterKind kind);
  void back_alive(std::uint64_t id, Party& party);
  void note(Party& party, std::uint64_t sequence, std::uint64_t& newest, std::int64_t now_ns);
  static void go_on(Party& party);
  bool is_in_world(const Key& key, const Object& object) const;
  void enter(const Key& key, Object& object);
  void leave(const Key& key, Object& object);
  void take_said_again(std::uint64_t id, Party& party, std::uint64_t before);
  void release_parked(std::uint64_t id, Party& party, std::int64_t now_ns);
  void apply(std::uint64_t id, Party& party, const service::PoseSample& sample, std::int64_t now_ns);
  bool accept(Party& party, const service::PoseSample& sample, std::size_t index, std::set<std::uint32_t>& named);

  service::PublisherLimits limits_;
  std::map<std::uint64_t, Party> parties_;
  std::map<std::string, Key> owners_;
  std::vector<Key> waiting_;
};

}  // namespace collided::model
