#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "idl/topics.hpp"
#include "server/service/ingest/object_numbers.hpp"
#include "server/service/ingest/samples.hpp"
#include "server/service/ingest/sequence_watermark.hpp"
#include "server/service/ingest/source_clock.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

struct PublisherLimits {
  std::uint32_t publishers = 1'000;
  std::uint32_t object_numbers = 200'000;  // of all publishers together, removed ones included
  std::uint32_t parked_batches = wire_contract::kPoseTopic.keep_last;  // a publisher, waiting for its definitions
  std::int64_t silent_after_ns = 2'000'000'000;                        // alive, but nothing new: shown as silent
  std::int64_t forgotten_after_ns = 60'000'000'000;                    // lost and without an object in the world
};

/// What became of what came in; only grows.
struct PublisherCounts {
  std::uint64_t definitions_applied = 0;
  std::uint64_t definitions_late = 0;  // older than what is known, or the same again
  std::uint64_t definitions_refused = 0;
  std::uint64_t name_conflicts = 0;  // wait until the name is free
  std::uint64_t batches_applied = 0;
  std::uint64_t batches_parked = 0;
  std::uint64_t batches_dropped = 0;  // parked beyond the limit, oldest first
  std::uint64_t batches_malformed = 0;
  std::uint64_t poses_applied = 0;
  std::uint64_t poses_late = 0;
  std::uint64_t poses_unknown = 0;  // of an object that is not in the world
  std::uint64_t poses_refused = 0;
  std::uint64_t stamps_late = 0;     // batches before what their publisher had said: they count as its next instant
  std::uint64_t stamps_jumped = 0;   // its clock went back or ahead by more than a lease: its objects are placed anew
  std::uint64_t stamps_missing = 0;  // the reception counts
  std::uint64_t publishers_refused = 0;
};

/// Which of a publisher's two writers a sign of life is about.
enum class WriterKind : std::uint8_t { object, pose };

/// Whether a sample is done with, or the world must step before it: every accepted pose is to be examined, so an
/// object does not move twice within a step.
enum class Applied : std::uint8_t { done, step_first };

struct PublisherView {
  std::uint64_t publisher = 0;
  std::string_view name;
  std::int64_t silent_ns = 0;
  wire_contract::PublisherState state = wire_contract::PublisherState::alive;
  std::optional<std::int64_t> behind_ns{};  // as in SourceClock
};

/// Turns what publishers send into calls of the world: objects by (publisher, object number), order by (incarnation,
/// sequence), names that two want, publishers that die and come back. Knows nothing of DDS.
///
/// threads  the one that writes the world
/// Always: a record says `in_world` exactly while its object is in the world or somebody else has removed it.
class Publishers {
 public:
  Publishers(World& world, const PublisherLimits& limits) : world_(world), limits_(limits) {}

  /// step_first leaves the sample as it was: step, then offer it again.
  Applied define(DefinitionSample& sample, std::int64_t now_ns);
  /// Takes the sample's vectors where it must wait for definitions.
  Applied move(PoseSample& sample, std::int64_t now_ns);
  /// Batches whose definitions have come meanwhile. done: none is left that could be applied now.
  Applied release_parked(std::int64_t now_ns);
  Applied writer_lost(std::uint64_t publisher, WriterKind kind, std::int64_t now_ns);
  void writer_alive(std::uint64_t publisher, WriterKind kind, std::int64_t now_ns);
  /// After a step: objects may move again.
  void stepped() { ++step_; }
  /// Now and then: names that have become free, gaps that waited too long, publishers to forget.
  void settle(std::int64_t now_ns);

  /// Batches and definitions that changed the world since the last call: what a step stands for.
  std::uint64_t take_changes();
  /// Sentences for the log, a few at most; the rest is only counted.
  std::vector<std::string> take_notices();
  const PublisherCounts& counts() const { return counts_; }

  std::size_t size() const { return publishers_.size(); }
  bool is_live(std::uint64_t publisher) const;
  /// It lives and has said all that it has to this server: what DDS kept of it has the poses of its first definitions.
  bool is_complete(std::uint64_t publisher) const;
  std::uint64_t applied_through(std::uint64_t publisher) const;
  /// Linear then angular, as last sent for this object; nothing where it came without.
  std::optional<std::array<double, 6>> velocity(ObjectId id) const;
  /// Publishers that wait for a name that another object has.
  std::vector<std::uint64_t> waiting_for(std::string_view name) const;

  /// Those worth showing, by number.
  template <class Visit>
  void for_each(std::int64_t now_ns, Visit&& visit) const {
    for (const auto& [id, publisher] : publishers_) {
      if (!(publisher->lost && publisher->took_leave)) visit(view(*publisher, now_ns));
    }
  }
  /// (publisher, applied_through) of all, by number.
  void list_applied(std::vector<std::pair<std::uint64_t, std::uint64_t>>& applied) const;

 private:
  enum class Place : std::uint8_t { gone, in_world, waits_for_name, taken_away };
  /// What a pose has nothing to do with.
  struct Described {
    ObjectDefinition definition;  // its pose: the record's, once it has one
    std::array<double, 6> velocity{};
  };
  /// An object of a publisher: two cache lines, which is what a pose takes of it.
  struct alignas(64) Record {
    Place place = Place::gone;
    bool has_velocity = false;
    bool moving = false;
    std::uint32_t number = 0;
    std::uint64_t definition_sequence = 0;
    std::uint64_t pose_sequence = 0;
    std::uint64_t touched_step = 0;  // defined or moved in this step
    std::uint64_t batch = 0;         // that named it last
    ObjectId id = 0;
    std::unique_ptr<Described> described = std::make_unique<Described>();
    Pose pose;  // the newest, so that it can come back there
  };
  struct Publisher {
    std::uint64_t id = 0;
    std::string name;
    std::uint64_t incarnation = 0;
    std::uint64_t definitions_seen = 0;
    SequenceWatermark watermark;
    SourceClock clock;
    ObjectNumbers<Record> objects;
    std::deque<PoseSample> parked;
    std::vector<PoseSample> parts;  // of an instant whose last batch has not come
    std::int64_t heard_ns = 0;
    std::int64_t lost_ns = 0;
    bool object_writer = false;  // lives
    bool pose_writer = false;
    bool said_all = false;  // kAllSaid has come, and what it followed
    bool lost = false;
    bool took_leave = false;  // lost, but nothing of it was left
  };

  PublisherView view(const Publisher& publisher, std::int64_t now_ns) const;
  Publisher* find(std::uint64_t id) const;
  Publisher* add(std::uint64_t id);
  bool make_room(std::int64_t now_ns);
  Applied meet(std::uint64_t id, std::uint64_t incarnation, std::int64_t now_ns, Publisher*& met);
  void heard(Publisher& publisher, WriterKind kind, std::int64_t now_ns);
  bool any_touched(const Publisher& publisher) const;
  void retire(Publisher& publisher);
  void back_alive(Publisher& publisher);

  std::optional<std::string> why_bad(const DefinitionSample& sample) const;
  void apply_definition(Publisher& publisher, Record& record, DefinitionSample& sample);
  void enter(Publisher& publisher, Record& record);
  bool give_way(ObjectId owner);
  void leave(Record& record, EndReason reason);
  void retry_names();
  void forget_lost(std::int64_t now_ns);
  void park(Publisher& publisher, PoseSample& sample);
  Applied take_batch(Publisher& publisher, PoseSample& sample, std::int64_t now_ns);
  Applied apply_instant(Publisher& publisher, const PoseSample& last, std::int64_t now_ns);
  void apply_batch(Publisher& publisher, const PoseSample& sample, const WorldStamp& stamp, std::int64_t now_ns);
  bool find_all(Publisher& publisher, const PoseSample& sample);
  bool accept(const Publisher& publisher, const PoseSample& sample, std::size_t index, Record* record);
  void refuse(const Publisher& publisher, const Record* record, const std::string& reason);
  std::optional<std::string> why_malformed(const PoseSample& sample) const;
  void notice(std::string sentence);

  World& world_;
  PublisherLimits limits_;
  std::map<std::uint64_t, std::unique_ptr<Publisher>> publishers_;
  PublisherCounts counts_;
  std::uint64_t step_ = 1;
  std::uint64_t batch_ = 0;
  std::uint64_t changes_ = 0;
  std::size_t record_count_ = 0;
  std::size_t parked_count_ = 0;
  std::vector<std::pair<std::uint64_t, std::uint32_t>> waiting_;  // for a name: publisher, object number
  std::vector<std::string> notices_;
  std::uint64_t unsaid_ = 0;

  // Of the batch at work.
  std::array<Record*, wire_contract::kMaxPosesPerBatch> records_;  // by index in the batch; null: none
  std::array<Record*, wire_contract::kMaxPosesPerBatch> accepted_;
  std::array<ObjectId, wire_contract::kMaxPosesPerBatch> ids_;  // of those accepted
  std::array<Pose, wire_contract::kMaxPosesPerBatch> poses_;
  std::array<bool, wire_contract::kMaxPosesPerBatch> moved_;
  std::size_t accepted_count_ = 0;
};

}  // namespace collided::engine::service
