#pragma once

#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>

#include <collided/codes.hpp>
#include <collided/events.hpp>
#include <collided/geometry.hpp>
#include <collided/subscription.hpp>

/// Questions that stay for the nearest object: the server says when another one is nearest.
#pragma GCC visibility push(default)

namespace collided {

/// Which object of a group is nearest to another object, or to a point. The server follows all of them along their whole
/// ways, as it does for contacts, and decides once all their publishers have said where they are. Objects that stand
/// still count, parts of loaded scenes do not; masks, groups and rules that let two pass do not matter.
struct NearestQuestion {
  std::string name;                 // unique among questions for the nearest, fences and margins
  std::string only;                 // name glob of the objects of which one is nearest
  std::string to = {};              // name of the object that the distances are to, which need not be there yet
  std::optional<Vec3> point = {};   // in place of it, in the world
  double within_m = 0;              // what is farther away does not count
  double hysteresis_m = 0;          // another one must be nearer by more than this; the last one may be so much farther
  std::string skip = {};            // name glob of objects that do not count; empty: none
  std::uint32_t mask = 0xffffffff;  // objects of which a layer is in it count
  /// It stays until it is removed or the server stops, and comes back after a crash. Else it goes with the client.
  bool keep = false;
};

using codes::NearestEventKind;

/// News of a question for the nearest. Another one is told once it is surely nearer; of two as near the one before stays.
struct NearestEvent {
  NearestEventKind kind = NearestEventKind::changed;
  /// Why `from` is not nearest any more: separated, where another is nearer or it is too far away; or as of fences.
  EndReason reason = EndReason::none;
  /// Other than none: `to` or what it is nearest to is where a lost publisher said last, and there is no distance.
  Doubt doubt = Doubt::none;
  /// As of contacts: the server replaced poses of `to` or what it is nearest to by newer ones (Event).
  bool poses_merged = false;
  bool resync = false;                     // inferred from the state: after a gap, or from a new server
  std::string nearest;                     // name of the question
  std::string from;                        // the object that was nearest; empty: none, or that is not known
  std::string to;                          // the object that is; empty: nothing is near enough
  std::uint64_t to_id = 0;                 // the server's number for it
  std::uint64_t epoch = 0;                 // grows with each start of a server
  std::uint64_t sequence = 0;              // of the event within the epoch; those of fences and margins count with it
  std::chrono::nanoseconds world_time{0};  // of the step that told it, since 1970, by the publishers' clocks
  double bracket_low_s = 0;                // the change happened between these two, in seconds before world_time
  double bracket_high_s = 0;
  // Of `to`, at the end of the bracket; of `is`, when it became nearest.
  double distance_m = 0;  // |truth - distance_m| <= distance_error_m; 0: they touch
  double distance_error_m = 0;
  Vec3 point = Vec3::Zero();   // of it, in the world; zero where they touch
  Vec3 normal = Vec3::Zero();  // unit, from there to what it is nearest to; zero where they touch
};

/// A question for the nearest in the server, and the answer.
struct ListedNearest {
  NearestQuestion question;
  std::string object;                             // empty: nothing is near enough
  bool is_in_doubt = false;                       // as of an event
  std::optional<std::chrono::nanoseconds> since;  // world time by which it was nearest
  /// Searches that ended at their limit of looks, so far: who came and went in such a piece of the way may not be told.
  std::uint64_t cut_short = 0;
};

/// Which news of questions for the nearest a watch reports.
struct NearestWatchOptions {
  std::string only = {};          // name glob that the question or one of the two objects must match; empty: everything
  std::string skip = {};          // name glob that none of them may match; empty: nothing
  std::size_t capacity = 65'536;  // as in WatchOptions
};

/// A subscription to all questions for the nearest, as FenceWatch is one to all fences.
using NearestWatch = Subscription<NearestEvent>;

}  // namespace collided

#pragma GCC visibility pop
