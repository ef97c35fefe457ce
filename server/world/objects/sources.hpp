#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

#include "collided/codes.hpp"

namespace collided::engine {

/// The instant up to which an object that never moves is known.
inline constexpr std::int64_t kForEver = std::numeric_limits<std::int64_t>::max();

using codes::kDefaultGapNs;

/// One publisher's time: the instant up to which its objects' poses are known.
struct Source {
  std::uint64_t publisher = 0;
  // The counts and flags below describe the objects that move.
  std::uint32_t object_count = 0;  // moving objects
  std::uint32_t posed_count = 0;   // poses since the last step
  // since the last step an object moved over an interval of its own: it teleported or was new
  bool has_own_motions = false;
  bool has_spoken = false;   // the publisher gave an instant since the last step
  bool is_timed = false;     // the publisher gives instants; else its objects are known up to the step's own time
  bool may_bring = false;    // objects of the publisher may arrive from another shard, with its next instant
  bool is_streamed = false;  // some of its objects are known only up to their own newest pose
  /// Two poses of an object farther apart than this do not connect: it rested until this long before the later one.
  std::int64_t gap_ns = kDefaultGapNs;
  std::int64_t known_ns = 0;     // world time up to which its objects are known
  std::int64_t before_ns = 0;    // the instant before known_ns
  std::int64_t settled_ns = 0;   // known_ns when the last step ended; never decreases
  std::int64_t streamed_ns = 0;  // settled_ns when its objects began to be streamed
  /// Ascending, from the oldest that another source still waits for; common time is divided at these instants.
  std::vector<std::int64_t> instants;

  /// True if time waits for this source.
  bool is_used() const { return object_count > 0 || may_bring; }
  /// The time to use for a pose or instant: time that is decided stays decided, so a repeated or late time moves to the
  /// next nanosecond.
  std::int64_t admitted(std::int64_t time_ns) const {
    const bool has_instants = publisher != 0 && !is_streamed;  // the server's own objects move at the step's time
    return has_instants && time_ns <= settled_ns ? settled_ns + 1 : time_ns;
  }
  /// The instant up to which objects with a pose of that time had rested.
  std::int64_t rested_until(std::int64_t time_ns) const {
    const std::int64_t instant_before_ns = time_ns > known_ns ? known_ns : before_ns;
    return is_streamed ? time_ns - gap_ns : std::max(instant_before_ns, time_ns - gap_ns);
  }
  /// The instant up to which one of its objects is known; posed_ns: world time of that object's newest pose.
  std::int64_t known_of(std::int64_t posed_ns) const {
    return is_streamed ? std::max({posed_ns, known_ns - gap_ns, streamed_ns}) : known_ns;
  }
  /// known_of() as it was when the last step ended; posed_ns: the object's newest pose at that time.
  std::int64_t settled_of(std::int64_t posed_ns) const {
    return is_streamed ? std::max({posed_ns, settled_ns - gap_ns, streamed_ns}) : settled_ns;
  }
};

/// The publishers that have objects in the world, each with its time.
/// threads  the writer only
/// Always: a source keeps its number while it has an object or gives instants; settled_ns and floor_ns() never
/// decrease.
class Sources {
 public:
  /// Once a publisher is this far behind the newest source, its pairs are no longer decided for the older time.
  static constexpr std::int64_t kLongestMemoryNs = 10'000'000'000;
  /// Source number of an object that does not move.
  static constexpr std::uint32_t kResting = 0xffffffff;

  /// Counts one more moving object of the publisher; returns the source's number.
  std::uint32_t add_object(std::uint64_t publisher);
  /// Counts one object less.
  void remove_object(std::uint32_t source);
  /// The publisher may bring objects that are elsewhere now: until it is lost, time waits for its instants as if it had
  /// objects here.
  void expect_objects(std::uint64_t publisher);

  /// Sets the publisher's gap. Has an effect only before the publisher's first instant, since settled time stays
  /// settled.
  void set_gap(std::uint64_t publisher, std::int64_t gap_ns);

  /// The publisher has reported everything up to this instant; a past instant changes nothing. Returns the source's
  /// number if this is its first instant, ever or since it was lost: objects defined before then begin at it.
  ///
  /// is_only_alive  the publisher reports nothing about its objects: those without a report are known up to one gap
  ///                before
  std::optional<std::uint32_t> advance(std::uint64_t publisher, std::int64_t time_ns, bool is_only_alive = false);
  /// The publisher gives no more instants; from now on its objects are known up to the step's own time.
  void lose(std::uint64_t publisher);
  /// Counts a pose. has_own_motion: the pose's motion covers an interval that others of its instant may not share.
  void note_posed(std::uint32_t source, bool has_own_motion) {
    ++sources_[source].posed_count;
    sources_[source].has_own_motions = sources_[source].has_own_motions || has_own_motion;
  }
  /// The source's objects are streamed from now on.
  void note_streamed(std::uint32_t source);

  /// Fixes what the step may decide. is_any_open: a motion of an earlier step is not yet decided against every source.
  void begin_step(std::int64_t world_time_ns, bool is_any_open);
  /// Settles what is known now; raises the floor and drops the instants below it.
  void end_step();

  const Source& operator[](std::uint32_t source) const { return sources_[source]; }
  /// Every number is below this; some may be free.
  std::uint32_t size() const { return static_cast<std::uint32_t>(sources_.size()); }
  /// Null if the publisher has no source.
  const Source* find(std::uint64_t publisher) const;
  /// True if pairs must be decided on common time: objects are not all known up to one instant, or did not all move at
  /// one in this step, or an older time is still undecided.
  bool need_common_time() const { return needs_common_time_; }
  /// No source needs older times: motions that end by then are forgotten, and no pair is decided for them.
  std::int64_t floor_ns() const { return floor_ns_; }
  /// True if the floor passed the source while it was silent and the source now continues beyond: its pairs begin again
  /// at the floor.
  bool is_over_floor_again(const Source& source) const;
  bool is_any_over_floor_again() const { return is_any_over_floor_again_; }
  /// True if the floor passed a source that is silent: its pairs may begin again without a pose.
  bool is_any_behind_floor() const;
  /// The newest instant at which all objects are known.
  std::int64_t settled_ns(std::int64_t world_time_ns) const;
  /// settled_ns() if nothing has changed since the last step: a source that gives no instants is known up to now_ns.
  std::int64_t settled_at_rest_ns(std::int64_t now_ns) const;
  /// True if pairs of another publisher may wait for this one's next instant.
  bool are_several() const { return used_count_ > 1; }

 private:
  std::uint32_t take_number(std::uint64_t publisher);
  void begin_use(Source& source);
  void release(std::uint32_t source);

  std::vector<Source> sources_;  // entries of free numbers are empty
  std::vector<std::uint32_t> free_;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;  // by publisher
  std::unordered_map<std::uint64_t, std::int64_t> gaps_;      // by publisher; only values other than the default
  std::size_t used_count_ = 0;                                // sources for which time waits
  bool needs_common_time_ = false;
  bool is_any_over_floor_again_ = false;
  std::int64_t floor_ns_ = 0;
};

}  // namespace collided::engine
