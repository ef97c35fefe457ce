#pragma once

#include <array>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "client/library/connection/server_pulse.hpp"
#include "collided/client.hpp"
#include "idl/topics.hpp"

namespace collided {

/// What a watch hears of: contacts, or who is in which fence, which travels in the same messages on topics of its own.
enum class WatchOf : std::uint8_t { contacts, fences };

}  // namespace collided

namespace collided::client {

/// One run of a server, from start to end. Ids and sequence numbers are valid within it.
struct ServerLife {
  std::uint64_t server = 0;
  std::uint64_t epoch = 0;
  bool operator==(const ServerLife&) const = default;
};

/// An event of a server, by its number.
struct EventPlace {
  std::uint64_t epoch = 0;
  std::uint64_t sequence = 0;
};

/// How one run of a server was heard to follow another.
struct LifeChange {
  std::uint64_t changes = 0;  // how many there were, this one included; 0: there was none
  ServerLife before;
  ServerLife now;
  /// The number of the first event of `now` that was heard or, where no event was, would have been, by the first bookmark.
  std::uint64_t heard_from = 0;
};

/// A frame of events, each of kind began or ended; on the topic of contacts that go on, persisted. Event i has the
/// sequence number first_sequence + i.
struct HeardFrame {
  ServerLife from;
  std::uint64_t first_sequence = 0;
  struct Entry {
    Event event;
    std::uint8_t shard = 0;
  };
  std::vector<Entry> entries;
  bool is_again = false;  // a server whose place the sender has taken may have told them
};

/// The contacts of one shard that held after event `as_of_sequence`, as events of kind `open`.
struct HeardShard {
  ServerLife from;
  std::uint8_t shard = 0;
  std::uint64_t as_of_sequence = 0;
  std::vector<Event> contacts;
};

/// The bookmark in a status: how many contacts hold after event `last_event_sequence`, and their hash.
struct HeardBookmark {
  ServerLife from;
  std::uint64_t last_event_sequence = 0;
  std::uint32_t contact_count = 0;
  std::uint64_t contact_hash = 0;
  std::chrono::nanoseconds world_time{0};
  bool settled = true;  // false while a restarted server waits for its publishers
};

/// Turns a server's messages (frames of events, shards of the contact state, bookmarks) into events, each once and in
/// order, whatever is lost on the way. It uses no DDS, threads or clocks; the caller passes the time.
///
/// While in step, each event's number is one more than the last. A gap, a bookmark that disagrees or a new life of the
/// server makes it doubtful. Then events are still emitted, with those that they imply were missed, until shards and
/// events together give a state whose count and hash match a bookmark; the differences to that state follow, marked
/// `resync`.
///
/// threads  one at a time
/// Always: for every pair of ids, and for every pair of names, it emits `began` (or `open`) and `ended` in turn, and
/// between them `contained` and `emerged` in turn; an `open` may begin contained.
class WatchState {
 public:
  using Emit = std::function<void(const Event&)>;
  explicit WatchState(Emit emit) : emit_(std::move(emit)) {}

  void hear(const HeardFrame& frame, Clock::time_point now);
  void hear(const HeardShard& shard, Clock::time_point now);
  void hear(const HeardBookmark& bookmark, Clock::time_point now);
  /// Takes contacts that go on, whose topic is not numbered. Those of contacts that were reported are emitted.
  void hear_persisted(const HeardFrame& frame);

  bool in_step() const { return mode_ == Mode::in_step; }
  /// Up to which event, of which epoch, everything has been emitted; nothing while it is not in step.
  std::optional<EventPlace> emitted_through() const {
    return in_step() ? std::optional(EventPlace{life_->epoch, applied_}) : std::nullopt;
  }
  std::uint64_t resyncs() const { return resyncs_; }
  /// How often something was missed within the life of a server, or was found to be missing in the next one's.
  std::uint64_t gaps() const { return gaps_; }
  /// The newest; heard_from may become less until all events of a bookmark have come.
  const LifeChange& life_change() const { return life_change_; }

 private:
  using Pair = std::pair<std::uint64_t, std::uint64_t>;
  using Contacts = std::map<Pair, Event>;
  using Names = std::pair<std::string, std::string>;
  enum class Mode { starting, in_step, doubtful };
  struct Shard {
    std::uint64_t as_of_sequence = 0;
    std::vector<Event> contacts;
  };

  bool is_current(const ServerLife& from, Clock::time_point now);
  void start_life(const ServerLife& life);
  void note_heard_from(std::uint64_t sequence);
  void note_gap();
  void doubt();

  /// What a server told last of a pair.
  struct Told {
    std::chrono::nanoseconds time{0};  // happened() of it
    unsigned kinds = 0;                // bit by EventKind, of what was told at that time
  };
  void note_told(const Event& event);
  /// Whether the event was told in the life before: a server that takes another one's place tells again what its
  /// predecessor may not have told any more.
  /// is_again  as of its frame; else only the very event is meant, which that server has worked out after it took the place
  bool was_told(const Event& event, bool is_again) const;
  bool has_ended_before(const Event& contact) const;

  void apply(const Event& event);
  void apply_began(const Event& event);
  void apply_ended(const Event& event);
  void apply_containment(const Event& event);
  Contacts::iterator begin_missed(const Event& event);
  void change_missed(Event& held, const Event& news, std::uint64_t sequence);
  void hold(const Event& contact);
  Contacts::iterator release(Contacts::iterator held);
  void end_namesake(const Event& event);
  /// Takes a contact from an earlier life of the server over into this one; false where none has these names.
  /// tells_containment  tells also what the event says of who lies within whom, as missed
  bool carry_over(const Event& event, bool tells_containment = true);
  void emit_missed(const Event& contact, EventKind what, EndReason why, std::uint64_t sequence);
  void note(const HeardFrame::Entry& entry);

  void try_adopt();
  bool may_adopt() const;
  bool bookmark_vouches() const;
  Contacts state_at(std::uint64_t sequence) const;
  void adopt_first();
  void adopt_differences();
  void end_carried();

  Emit emit_;
  Mode mode_ = Mode::starting;
  std::uint64_t resyncs_ = 0;
  std::uint64_t gaps_ = 0;
  bool has_gap_ = false;  // that is in gaps_, and not made up for yet
  LifeChange life_change_;
  std::optional<ServerLife> life_;
  Clock::time_point last_heard_;

  std::uint64_t applied_ = 0;    // number of the newest event heard
  std::uint64_t run_start_ = 0;  // events from here to applied_ came without a gap; 0: none has come yet
  Contacts held_;                // contacts that were reported and have not ended
  std::map<Names, Pair> held_by_names_;
  std::map<Names, Event> carried_;       // reported in an earlier life of the server, not yet seen in this one
  std::map<Names, Told> told_;           // in the life before; emptied once nothing of that time can come any more
  std::chrono::nanoseconds told_to_{0};  // the newest world time of that life; 0: there was none, or it is long over
  std::chrono::nanoseconds joined_{0};   // world time of the state that was adopted first

  std::array<Shard, wire_contract::kContactShards> shards_;
  std::deque<HeardFrame::Entry> recent_;
  std::optional<HeardBookmark> bookmark_;
  std::optional<std::uint64_t> behind_at_;  // applied_ when a bookmark was first ahead of it
  bool stuck_ = false;  // at the next bookmark applied_ was still the same: the missing events will not come
};

}  // namespace collided::client
