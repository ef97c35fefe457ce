#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <utility>
#include <vector>

#include "idl/topics.hpp"
#include "server/service/ingest/object_numbers.hpp"
#include "server/service/ingest/samples.hpp"
#include "server/service/ingest/sequence_watermark.hpp"
#include "server/service/ingest/source_clock.hpp"
#include "server/world/world.hpp"

namespace collided::engine::service {

/// Limits on the resources of publishers, and the times after which a publisher counts as silent or is forgotten.
struct PublisherLimits {
  std::uint32_t publishers = 1'000;       // live ones
  std::uint32_t lost_publishers = 1'000;  // beyond it, the one lost first is forgotten; its objects stay in the world
  // of all publishers together, those of removed objects included; beyond it, lost publishers are forgotten first
  std::uint32_t object_numbers = 200'000;
  std::uint32_t parked_batches = wire_contract::kPoseTopic.keep_last;  // of one publisher, waiting for its definitions
  std::size_t parked_bytes = std::size_t{64} << 20;                    // of all publishers together
  std::int64_t asked_after_ns = 1'000'000'000;   // definitions are requested again after poses wait this long
  std::int64_t silent_after_ns = 2'000'000'000;  // a live publisher without a sample for this long is shown as silent
  // A lost publisher's objects stay this long, stale unless their policy is hold; then their lost policies apply.
  std::int64_t forget_after_ns = 5'000'000'000;
  std::int64_t forgotten_after_ns = 60'000'000'000;  // a lost publisher without an object in the world
};

/// Counts of incoming samples by outcome; they only grow.
struct PublisherCounts {
  std::uint64_t definitions_applied = 0;
  std::uint64_t definitions_late = 0;  // older than what is known, or a repetition
  std::uint64_t definitions_refused = 0;
  std::uint64_t name_conflicts = 0;  // definitions that wait until their name is free, or exists for a claim
  std::uint64_t batches_applied = 0;
  std::uint64_t batches_parked = 0;   // waited, or still wait, for definitions
  std::uint64_t batches_dropped = 0;  // the oldest parked ones, beyond the limit
  std::uint64_t batches_malformed = 0;
  std::uint64_t poses_applied = 0;
  std::uint64_t poses_late = 0;     // older than the known one
  std::uint64_t poses_unknown = 0;  // of an object not in the world
  std::uint64_t poses_refused = 0;
  std::uint64_t stamps_late = 0;     // batches stamped before an earlier one: they get their publisher's next instant
  std::uint64_t stamps_jumped = 0;   // a clock jumped by more than a lease, back or ahead: its objects are placed
  std::uint64_t stamps_missing = 0;  // batches without one: the time of reception is used
  std::uint64_t publishers_refused = 0;  // samples of publishers beyond the limit
};

/// Which of a publisher's two writers a sign of life is about.
enum class WriterKind : std::uint8_t { object, pose };

/// Whether a sample is processed, or the world must step first. Each step examines every accepted pose, so an object
/// never moves twice within one step.
enum class Applied : std::uint8_t { done, step_first };

/// One publisher as the status shows it. The name is valid until the next change of the Publishers.
struct PublisherView {
  std::uint64_t publisher = 0;
  std::string_view name;
  std::int64_t silent_ns = 0;  // since its last sample
  wire_contract::PublisherState state = wire_contract::PublisherState::alive;
  std::optional<std::int64_t> behind_ns{};  // SourceClock::behind_ns()
};

/// Turns samples of publishers into changes of the world. Finds objects by (publisher, object number), orders samples
/// by (incarnation, sequence), settles which object gets a disputed name, and follows publishers that die and return. A
/// definition without a shape claims an object that is in the world without a publisher: the publisher moves it, and
/// releases it where it stands instead of removing it. Independent of DDS.
///
/// threads    the one that writes the world
/// invariant  a record is `in_world` while its object is in the world, and stays so if a command removes that object
class Publishers {
 public:
  Publishers(World& world, const PublisherLimits& limits) : world_(world), limits_(limits) {}

  /// Applies a definition. step_first leaves the sample unchanged: step, then offer it again.
  Applied define(DefinitionSample& sample, std::int64_t now_ns);
  /// Applies a batch of poses, or parks it until its definitions have come; parking takes the sample's vectors.
  /// step_first leaves the sample unchanged.
  Applied move(PoseSample& sample, std::int64_t now_ns);
  /// Applies parked batches whose definitions have since come. done: none is left that could be applied now.
  Applied release_parked(std::int64_t now_ns);
  /// One of the publisher's two writers is gone. Without either the publisher is lost: its objects are stale, unless
  /// their policy is hold, and their lost policies apply after PublisherLimits::forget_after_ns.
  Applied writer_lost(std::uint64_t publisher, WriterKind kind, std::int64_t now_ns);
  /// Restores a lost publisher with the objects that left with it.
  void writer_alive(std::uint64_t publisher, WriterKind kind, std::int64_t now_ns);
  /// Call this after each step: objects may move again.
  void stepped() { ++step_; }
  /// Call this regularly: retries names that may be free, gives up old gaps in sequences, applies the policies of lost
  /// publishers, and forgets them.
  void settle(std::int64_t now_ns);

  /// How many batches and definitions changed the world since the last call: the changes that the next step represents.
  std::uint64_t take_changes();
  bool has_changes() const { return changes_ > 0; }
  /// Sentences for the log since the last call: eight at most, then one with the number of the rest.
  std::vector<std::string> take_notices();
  const PublisherCounts& counts() const { return counts_; }

  std::size_t size() const { return publishers_.size(); }
  /// Whether the publisher is known and not lost.
  bool is_live(std::uint64_t publisher) const;
  /// Whether it lives and has sent all its definitions to this server (kPosesAllSaid). The samples that DDS kept of a
  /// publisher have only the poses of its first definitions, so being known is not enough.
  bool is_complete(std::uint64_t publisher) const;
  /// Whether its objects come from other shards and leave for them (kPosesBringsObjects).
  bool is_in_several_shards(std::uint64_t publisher) const;
  /// SequenceWatermark::through() of the publisher; 0: unknown.
  std::uint64_t applied_through(std::uint64_t publisher) const;
  /// Poses of the publisher replaced by newer ones since the server had too many; 0: none, or unknown.
  std::uint64_t merged_poses(std::uint64_t publisher) const;
  /// Whether newer poses have replaced some of the object's on the path that the newest step decided, so that the path
  /// differs from the published one.
  ///
  /// settled_before_ns  world time up to which everything was decided before that step
  bool is_merged(ObjectId id, std::int64_t settled_before_ns) const {
    const std::size_t slot = slot_of(id);
    if (slot >= merged_.size()) return false;
    return merged_[slot].step + 1 == step_ || merged_[slot].until_ns > settled_before_ns;
  }
  /// The object's velocity as last sent: linear in m/s, then angular in rad/s. Nothing if its last pose had none. Costs
  /// a walk over the publisher's objects.
  std::optional<std::array<double, 6>> velocity(ObjectId id) const;
  /// The publishers whose object of this name waits because another object has the name.
  std::vector<std::uint64_t> waiting_for(std::string_view name) const;
  /// An object of a publisher that is not in the world as it was defined last, and why.
  struct LeftOut {
    std::string name;
    std::string why;
  };
  /// Those of a publisher, at most `most`, in the order of arrival of their object numbers.
  std::vector<LeftOut> left_out(std::uint64_t publisher, std::size_t most) const;
  std::size_t left_out_count(std::uint64_t publisher) const;

  /// Visits every publisher, ascending by number, except those that removed all their objects before they left.
  template <class Visit>
  void for_each(std::int64_t now_ns, Visit&& visit) const {
    for (const auto& [id, publisher] : publishers_) {
      if (!(publisher->lost && publisher->took_leave)) visit(view(*publisher, now_ns));
    }
  }
  /// Lists (publisher, applied_through) of all, ascending by publisher.
  void list_applied(std::vector<std::pair<std::uint64_t, std::uint64_t>>& applied) const;

 private:
  /// Where a record's object is. gone: removed, or never accepted. waits_for_name: another object has its name, or none
  /// exists that could be claimed. taken_away: it left the world with its lost publisher and returns with it.
  /// waits_for_instant: it enters with the next instant (kPolicyEntersWithInstant).
  enum class Place : std::uint8_t { gone, in_world, waits_for_name, taken_away, waits_for_instant };
  /// The part that a pose without a velocity does not touch; separate, so that a Record stays small.
  struct Described {
    ObjectDefinition definition;  // its pose is outdated: see the record's
    std::array<double, 6> velocity{};
    std::string why_left_out;  // of the newest definition; empty: it is in the world
  };
  /// One object of a publisher. Two cache lines, which is all that a pose touches here.
  struct alignas(64) Record {
    Place place = Place::gone;
    bool has_velocity = false;
    bool moving = false;
    bool is_claim = false;  // of an object that the world had; it is released there instead of removed
    std::uint32_t number = 0;
    std::uint64_t definition_sequence = 0;
    std::uint64_t pose_sequence = 0;
    std::uint64_t touched_step = 0;  // the step in which it was defined or moved last
    std::uint64_t batch = 0;         // the last batch with a pose of it
    ObjectId id = 0;
    std::unique_ptr<Described> described = std::make_unique<Described>();
    Pose pose;  // the newest accepted; also the pose at which it returns after its publisher was lost
  };
  /// A repeated definition of an existing object: it only has a new pose, and may have overtaken batches.
  struct SaidAgain {
    std::uint32_t number = 0;
    std::uint64_t sequence = 0;
    Pose pose;
  };
  struct Publisher {
    std::uint64_t id = 0;
    std::string name;
    std::uint64_t incarnation = 0;
    std::uint64_t definitions_seen = 0;  // greatest sequence number of its definitions
    std::int64_t gap_ns = wire_contract::kDefaultGapNs;
    std::int64_t instant_ns = 0;     // world time of its newest batch with poses
    std::uint32_t long_periods = 0;  // between such batches, longer than the gap, in a row
    bool was_warned_of_gap = false;
    bool was_lost_before = false;
    SequenceWatermark watermark;
    SourceClock clock;
    ObjectNumbers<Record> objects;
    // While it is lost and others take its names: its objects in the world at the time of the first one.
    std::unordered_map<ObjectId, std::uint32_t> numbers_while_lost;
    std::deque<PoseSample> parked;  // wait for definitions, oldest first
    std::size_t parked_bytes = 0;
    std::vector<PoseSample> parts;        // batches of an instant whose last batch has not come
    std::vector<std::uint32_t> entering;  // numbers of objects that wait for an instant, and of some that no longer do
    std::vector<SaidAgain> said_again;    // wait for earlier batches, oldest first
    std::uint64_t merged_poses = 0;       // replaced by newer ones before they were applied
    std::int64_t heard_ns = 0;            // time of its last sample, server's clock
    std::int64_t lost_ns = 0;
    bool object_writer = false;  // its writer of definitions lives
    bool pose_writer = false;
    bool brings_objects = false;  // an instant with kPosesBringsObjects was applied
    bool said_all = false;        // a batch with kPosesAllSaid was applied
    bool lost = false;            // both writers are gone
    bool took_leave = false;      // lost, but it had removed all its objects before
    bool is_frozen = false;       // lost, and its objects' policies have not been applied
  };

  PublisherView view(const Publisher& publisher, std::int64_t now_ns) const;
  Publisher* find(std::uint64_t id) const;
  Publisher* add(std::uint64_t id);
  bool has_room() const { return publishers_.size() - lost_count_ < limits_.publishers; }
  Applied meet(std::uint64_t id, std::uint64_t incarnation, Publisher*& met);
  void heard(Publisher& publisher, WriterKind kind, std::int64_t now_ns);
  bool any_touched(const Publisher& publisher) const;
  void retire(Publisher& publisher);
  void back_alive(Publisher& publisher);

  std::optional<std::string> why_bad(const DefinitionSample& sample) const;
  bool is_posed_at(const Record& record, const Pose& pose) const;
  bool is_said_again(const Record& record, const DefinitionSample& sample) const;
  bool is_there_already(const Record& record, const DefinitionSample& sample) const;
  void wait_for_batches(Publisher& publisher, const DefinitionSample& sample);
  Applied take_said_again(Publisher& publisher, std::uint64_t before);
  void place_again(Publisher& publisher, Record& record, const SaidAgain& said);
  void apply_definition(Publisher& publisher, Record& record, DefinitionSample& sample);
  void enter(Publisher& publisher, Record& record);
  void enter_with_instant(Publisher& publisher, std::uint64_t definitions_through);
  void make_lost_give_way(std::string_view name);
  /// Makes room if the batches parked by all publishers would take too much memory with this many more bytes.
  void make_room_to_park(std::size_t bytes);
  /// Removes a publisher's oldest parked batch, which has this many bytes.
  void pop_parked(Publisher& publisher, std::size_t bytes);
  std::string why_waits(const Record& record) const;
  void wait(const Publisher& publisher, Record& record, std::string why);
  std::variant<ObjectId, Refusal> take_over(ObjectId there, ObjectDefinition& definition);
  void give_back(const Record& record, EndReason reason);
  void find_lost_claims();
  void leave(Record& record, EndReason reason);
  void retry_names();
  void apply_lost_policies(Publisher& publisher);
  void apply_lost_policies(std::int64_t now_ns);
  Publisher* first_lost(bool is_frozen) const;
  void make_room_for_object();
  void make_room_for_number();
  void forget_lost(std::int64_t now_ns);
  void forget_first_lost();
  void note_lost(Publisher& publisher, bool is_lost);
  void notice_loss(Publisher& publisher);
  void park(Publisher& publisher, const PoseSample& sample);
  Applied take_batch(Publisher& publisher, PoseSample& sample, std::int64_t now_ns);
  Applied apply_instant(Publisher& publisher, const PoseSample& last, std::int64_t now_ns);
  void apply_batch(Publisher& publisher, const PoseSample& sample, const WorldStamp& stamp, std::int64_t now_ns);
  bool find_all(Publisher& publisher, const PoseSample& sample);
  void note_merged(ObjectId id, std::int64_t until_ns);
  void note_alive(Publisher& publisher, const PoseSample& sample);
  void note_period(Publisher& publisher, std::int64_t time_ns);
  void take_gap(Publisher& publisher, const DefinitionSample& sample);
  bool accept(const Publisher& publisher, const PoseSample& sample, std::size_t index, Record* record);
  void refuse(const Publisher& publisher, const Record* record, const std::string& reason);
  std::optional<std::string> why_malformed(const PoseSample& sample) const;
  void notice(std::string sentence);

  World& world_;
  PublisherLimits limits_;
  std::map<std::uint64_t, std::unique_ptr<Publisher>> publishers_;
  PublisherCounts counts_;
  std::uint64_t step_ = 1;        // number of the next step
  std::uint64_t batch_ = 0;       // number of the current batch
  std::uint64_t changes_ = 0;     // since take_changes()
  std::size_t record_count_ = 0;  // of all publishers, removed objects included
  std::size_t parked_count_ = 0;
  std::size_t parked_bytes_ = 0;
  std::size_t lost_count_ = 0;                                    // of publishers_
  std::vector<std::pair<std::uint64_t, std::uint32_t>> waiting_;  // for a name: publisher, object number
  std::vector<std::pair<std::uint64_t, std::uint32_t>> claims_;   // the same, for claimed objects
  /// The newest merged pose of an object: the step that took it, and its world time, for which another publisher may
  /// wait.
  struct MergedWay {
    std::uint64_t step = 0;
    std::int64_t until_ns = 0;
  };
  std::vector<MergedWay> merged_;  // by slot; empty until there is one
  std::vector<std::string> notices_;
  std::uint64_t unsaid_ = 0;  // notices beyond the limit

  // These belong to the current batch; they are members so that applying it allocates nothing.
  std::array<Record*, wire_contract::kMaxPosesPerBatch> records_;  // by index in the batch; null: unknown number
  std::array<Record*, wire_contract::kMaxPosesPerBatch> accepted_;
  std::array<ObjectId, wire_contract::kMaxPosesPerBatch> ids_;  // of the accepted
  std::array<Pose, wire_contract::kMaxPosesPerBatch> poses_;
  std::array<bool, wire_contract::kMaxPosesPerBatch> moved_;  // by index among the accepted: the world took the pose
  std::size_t accepted_count_ = 0;
};

}  // namespace collided::engine::service
