#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <collided/codes.hpp>
#include <collided/events.hpp>
#include <collided/geometry.hpp>
#include <collided/subscription.hpp>

/// Margins: distance bands between objects, of which the server says when two come nearer and when they part.
#pragma GCC visibility push(default)

namespace collided {

/// Bands of distance between any object of one group and any of another, at least one of which moves. The server follows
/// both along their whole ways, as it does for contacts, so none is missed between two poses. Every pair counts, also one
/// that masks, groups or rules let pass through each other.
struct Margin {
  std::string name;                   // unique among margins and fences
  std::string around;                 // name glob of the one group, which may be a single name
  std::string only;                   // name glob of the other; the two may have objects in common
  std::string skip = {};              // name glob of objects that have no part in it; empty: none
  std::uint32_t mask = 0xffffffff;    // of the moving objects of `only`: those of which a layer is in it
  std::vector<double> bands_m = {};   // metres, the widest first; at most seven besides contact, which is always one
  double hysteresis_m = 0;            // who is within a band leaves it beyond the band plus this
  std::chrono::nanoseconds dwell{0};  // a change is told once it has lasted so long, up to an hour; contact at once
  /// It stays until it is removed or the server stops, and comes back after a crash. Else it goes with the client.
  bool keep = false;
};

using codes::MarginEventKind;

/// News of two objects and a band between them.
struct MarginEvent {
  MarginEventKind kind = MarginEventKind::approach;
  /// Of `leave`: separated, or as of fences and contacts; fence_removed: the margin was.
  EndReason reason = EndReason::none;
  /// Other than none: it is not known whether the two are in the band, or whether a change lasted long enough, which is
  /// told as if so.
  Doubt doubt = Doubt::none;
  /// As of contacts: the server replaced poses of one of the two by newer ones (Event).
  bool poses_merged = false;
  bool resync = false;  // inferred from the state: after a gap, or from a new server
  std::string margin;
  std::string object;                      // the one that moved against the other's bands
  std::string around;                      // the one that has the bands
  double band_m = 0;                       // metres; 0: contact
  std::uint64_t object_id = 0;             // the server's number
  std::uint64_t epoch = 0;                 // grows with each start of a server
  std::uint64_t sequence = 0;              // number of the event within the epoch, of all fences and margins
  std::uint64_t episode = 0;               // that of the pair's coming into the band
  std::chrono::nanoseconds world_time{0};  // of the step that told it, since 1970, by the publishers' clocks
  std::chrono::nanoseconds entered{0};     // world time by which the two were in the band
  double bracket_low_s = 0;                // the change happened between these two, in seconds before world_time
  double bracket_high_s = 0;
  // Of approach, near and contact, at the end of the bracket; where there is a doubt all are 0.
  double distance_m = 0;  // |truth - distance_m| <= distance_error_m
  double distance_error_m = 0;
  Vec3 point = Vec3::Zero();   // of the object, nearest to the other; in the world
  Vec3 normal = Vec3::Zero();  // unit, from there to the other
  /// How fast the distance shrinks, m/s; negative: it grows. 0 for who is new or was put there.
  double closing_mps = 0;
  double closing_error_mps = 0;  // |truth - closing_mps| at most
  /// After how many seconds from the end of the bracket the two would touch if both went on as they moved then: not
  /// before the first, and by the second. Nothing: not within a minute.
  struct Forecast {
    double low_s = 0;
    double high_s = 0;
  };
  std::optional<Forecast> contact_in = {};
};

/// Two objects of a margin that are within one of its bands.
struct MarginPair {
  std::string object;
  std::string around;
  double within_m = 0;       // the narrowest band that the two are in
  bool is_in_doubt = false;  // that is not known
};

/// What was found in the world when a margin was added.
struct AddedMargin {
  /// Parts of loaded scenes that one of the globs matches. They have no bands: give what stands still a shape of its own
  /// (Client::add).
  std::uint64_t parts = 0;
};

/// A margin in the server, and who is within its bands.
struct ListedMargin {
  Margin margin;
  std::vector<MarginPair> pairs;
};

/// Which news of margins a watch reports.
struct MarginWatchOptions {
  std::string only = {};          // name glob that the margin or one of the two objects must match; empty: everything
  std::string skip = {};          // name glob that none of them may match; empty: nothing
  std::size_t capacity = 65'536;  // as in WatchOptions
};

/// A subscription to all margins, as FenceWatch is one to all fences.
using MarginWatch = Subscription<MarginEvent>;

}  // namespace collided

#pragma GCC visibility pop
