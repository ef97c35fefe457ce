#pragma once

#include <algorithm>
#include <cstdint>
#include <limits>
#include <optional>
#include <unordered_map>
#include <vector>

namespace collided::engine {

/// What never moves is known for ever.
inline constexpr std::int64_t kForEver = std::numeric_limits<std::int64_t>::max();

/// A streamed object whose poses lie farther apart rested until so long before the later one.
inline constexpr std::int64_t kStreamGapNs = 250'000'000;

/// One publisher's time: up to which instant it has said where its objects are.
struct Source {
  std::uint64_t publisher = 0;
  std::uint32_t object_count = 0;  // that move
  std::uint32_t posed_count = 0;   // since the last step
  bool has_own_motions = false;       // since the last step, of objects that jumped or were new
  bool has_spoken = false;         // an instant, since the last step
  bool is_timed = false;           // else its objects are known up to the step's own time
  bool is_streamed = false;        // some of its objects are known up to their own newest pose only
  std::int64_t known_ns = 0;
  std::int64_t before_ns = 0;      // the instant before known_ns
  std::int64_t settled_ns = 0;     // what was known when the last step ended; never goes back
  std::int64_t streamed_ns = 0;    // what was settled when its objects began to be streamed
  /// Since the oldest that somebody still waits for, ascending: pieces of time end at these, whoever moved.
  std::vector<std::int64_t> instants;

  /// What is decided stays: an instant that comes once more, or late, is the next nanosecond.
  std::int64_t admitted(std::int64_t time_ns) const {
    const bool has_instants = publisher != 0 && !is_streamed;  // the server's own objects move at the step's time
    return has_instants && time_ns <= settled_ns ? settled_ns + 1 : time_ns;
  }
  /// Up to where those rested that it names at that time.
  std::int64_t instant_before(std::int64_t time_ns) const { return time_ns > known_ns ? known_ns : before_ns; }
  /// Up to where one of its objects is known whose newest pose was at posed_ns.
  std::int64_t known_of(std::int64_t posed_ns) const {
    return is_streamed ? std::max({posed_ns, known_ns - kStreamGapNs, streamed_ns}) : known_ns;
  }
  /// The same when the last step ended; posed_ns: its newest pose then.
  std::int64_t settled_of(std::int64_t posed_ns) const {
    return is_streamed ? std::max({posed_ns, settled_ns - kStreamGapNs, streamed_ns}) : settled_ns;
  }
};

/// The publishers that have objects in the world, each with its time. Writer's thread only.
/// Always: a source's number stays while it has an object or says instants; settled_ns and floor_ns() never go back.
class Sources {
 public:
  /// Farther behind the newest than this, a publisher's pairs are no longer decided for what lies before.
  static constexpr std::int64_t kLongestMemoryNs = 10'000'000'000;
  /// Of what does not move.
  static constexpr std::uint32_t kResting = 0xffffffff;

  /// One object more, or one less; the source's number.
  std::uint32_t add_object(std::uint64_t publisher);
  void remove_object(std::uint32_t source);

  /// All that the publisher has to say of the time up to there is said. Nothing for an instant that is past.
  /// Its number where this is the first instant, at all or since it was lost: who was defined before it begins there.
  std::optional<std::uint32_t> advance(std::uint64_t publisher, std::int64_t time_ns);
  /// It says no more instants: from now on its objects are known up to the step's own time.
  void lose(std::uint64_t publisher);
  /// has_own_way: one that others of its instant may not share.
  void note_posed(std::uint32_t source, bool has_own_motion) {
    ++sources_[source].posed_count;
    sources_[source].has_own_motions = sources_[source].has_own_motions || has_own_motion;
  }
  void note_streamed(std::uint32_t source);

  /// is_any_open: something that an earlier step saw is not decided with everybody yet.
  void begin_step(std::int64_t world_time_ns, bool is_any_open);
  void end_step();

  const Source& operator[](std::uint32_t source) const { return sources_[source]; }
  /// Numbers below this; some may be free.
  std::uint32_t size() const { return static_cast<std::uint32_t>(sources_.size()); }
  const Source* find(std::uint64_t publisher) const;
  /// Objects are not all known up to one instant, or did not all move at one in this step, or somebody still waits for what was
  /// before: pairs are decided on common time.
  bool need_common_time() const { return needs_common_time_; }
  /// Nobody asks for what was before: ways that end up to then are forgotten, and no pair is decided for it.
  std::int64_t floor_ns() const { return floor_ns_; }
  /// The floor has passed it while it was silent, and now it goes on beyond: its pairs begin anew at the floor.
  bool is_over_floor_again(const Source& source) const;
  bool is_any_over_floor_again() const { return is_any_over_floor_again_; }
  /// The newest instant at which all are known.
  std::int64_t settled_ns(std::int64_t world_time_ns) const;
  /// Somebody may wait for this publisher's next instant.
  bool are_several() const { return used_count_ > 1; }

 private:
  void release(std::uint32_t source);

  std::vector<Source> sources_;  // with holes
  std::vector<std::uint32_t> free_;
  std::unordered_map<std::uint64_t, std::uint32_t> numbers_;  // by publisher
  std::size_t used_count_ = 0;  // that have objects
  bool needs_common_time_ = false;
  bool is_any_over_floor_again_ = false;
  std::int64_t floor_ns_ = 0;
};

}  // namespace collided::engine
