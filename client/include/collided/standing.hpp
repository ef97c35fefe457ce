#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include <collided/codes.hpp>
#include <collided/events.hpp>
#include <collided/geometry.hpp>
#include <collided/listed_standing.hpp>
#include <collided/shapes.hpp>
#include <collided/subscription.hpp>

/// Standing questions: the server evaluates them continuously and reports each change of their answers. Metres,
/// seconds, world coordinates.
#pragma GCC visibility push(default)

namespace collided {

/// An upright prism over a simple polygon, which need not be convex.
struct Prism {
  std::vector<std::array<double, 2>> corners;  // x and y, in either direction around it; at most 100 or so
  double low_m = 0;
  double high_m = 0;
};

/// Which moving objects are in a region? The region is fixed in the world or moves along with an object.
struct Region {
  /// Solid shapes and closed meshes, which together form one region. In the world, or in the frame of the object `to`.
  Shape shape = {};
  std::optional<Prism> prism = {};  // in place of the shape
  std::string to = {};              // name of the object it moves along with, which need not exist yet
  // Which events it reports. Without `cross`, an object that was in and out again between two poses is reported as
  // `enter` and `exit`.
  bool enter = true;
  bool exit = true;
  bool cross = true;
};

/// Which pairs of an object `around` and another one are within bands of distance? At least one of the two moves. Parts
/// of loaded scenes have no bands; add static obstacles as separate objects (Client::add).
struct Bands {
  std::string around;                 // name glob of the objects that have the bands, maybe also in `only`
  std::vector<double> bands_m = {};   // the widest first; at most seven, in addition to contact, which is always a band
  double hysteresis_m = 0;            // a pair leaves a band beyond the band plus this
  std::chrono::nanoseconds dwell{0};  // a change must last this long, up to an hour, to be reported; contact at once
};

/// Which object is nearest to another one, or to a point? Static objects count, parts of loaded scenes do not. It is
/// decided when the publishers of all of them have reported their poses.
struct Nearest {
  std::string to = {};             // name of the object that the distances are to, which need not exist yet
  std::optional<Vec3> point = {};  // instead of `to`
  double within_m = 0;             // objects farther away do not count
  double hysteresis_m = 0;  // another one must be nearer by more than this; the last one may be this much farther
};

/// A standing question. The server follows each monitored object along its whole path, as for contacts, so that no
/// change between two poses is missed. A region touches nothing, and no question hits it. Groups, allowed pairs and the
/// objects' own masks do not affect a standing question.
struct Standing {
  std::string name;                 // unique among standing questions
  std::string only = {};            // name glob of the objects it monitors; empty, for a region: all moving ones
  std::string skip = {};            // name glob of objects to leave out; empty: none
  std::uint32_t mask = 0xffffffff;  // it monitors only objects that have one of these layers
  /// It stays until it is removed, and survives a stop or crash of the server. Otherwise it is removed when the client
  /// disconnects.
  bool keep = false;
  std::variant<Region, Bands, Nearest> of = {};

  StandingForm form() const { return static_cast<StandingForm>(of.index()); }
};

using codes::StandingEventKind;
using codes::StandingForm;

/// An event of a standing question.
struct StandingEvent {
  StandingEventKind kind = StandingEventKind::inside;
  StandingForm form = StandingForm::region;
  /// For exit, leave and changed, why the state ended: separated, if the two moved apart or another object is nearer;
  /// fence_removed, if the question was removed; otherwise as for contacts.
  EndReason reason = EndReason::none;
  /// Other than none: it is not known whether the state holds, or whether a change lasted long enough; it is reported
  /// as if it did.
  Doubt doubt = Doubt::none;
  /// As for contacts: newer poses replaced some poses of one of the two (Event).
  bool poses_merged = false;
  bool resync = false;   // inferred from the current state after a gap, or from a new server
  std::string standing;  // name of the question
  std::string object;    // in the region, within the band, or nearest; empty: none is near enough
  std::string other;  // for bands: the object that has them; for the nearest: the previous one; empty: none or unknown
  double band_m = 0;  // for bands; 0: contact
  std::uint64_t object_id = 0;             // the server's number for the object
  std::uint64_t epoch = 0;                 // grows with each start of a server
  std::uint64_t sequence = 0;              // number of the event within the epoch, over all standing questions
  std::uint64_t episode = 0;               // sequence of the event with which the state began
  std::chrono::nanoseconds world_time{0};  // of the step that detected it, since 1970, by the publishers' clocks
  std::chrono::nanoseconds entered{0};     // world time by which the state held
  /// The change (for cross: the entry) happened between these two, in seconds before world_time.
  double bracket_low_s = 0;
  double bracket_high_s = 0;
  double left_low_s = 0;  // for cross: the exit happened between these two
  double left_high_s = 0;
  // For bands and the nearest: the distance at the end of the bracket, for changes by which two came nearer; 0 if there
  // is a doubt.
  double distance_m = 0;  // |truth - distance_m| <= distance_error_m
  double distance_error_m = 0;
  /// For a region: where the object's surface first met the region's. Otherwise the object's point nearest to the other
  /// one. In the world; zero: unknown, or they touch.
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // unit, from there to the other one; zero: unknown, or they touch
  /// For bands: speed at which the distance shrinks, m/s; negative: it grows. 0 for an object that is new or was
  /// teleported.
  double closing_mps = 0;
  double closing_error_mps = 0;  // |truth - closing_mps| at most
  /// When the two would touch if both kept their motion, in seconds from the end of the bracket: not before the first,
  /// and by the second.
  struct Forecast {
    double low_s = 0;
    double high_s = 0;
  };
  /// For bands; nothing: not within a minute.
  std::optional<Forecast> contact_in = {};
};

/// The answer when a standing question was added.
struct AddedStanding {
  /// For bands: number of parts of loaded scenes that match one of the globs; they have no bands.
  std::uint64_t parts = 0;
};

/// Which events a watch reports.
struct StandingWatchOptions {
  std::string only = {};  // name glob that the question or one of the two objects must match; empty: everything
  std::string skip = {};  // name glob that none of them may match; empty: nothing
  std::optional<StandingForm> form = {};  // only this form; nothing: all
  std::size_t capacity = 65'536;          // as in WatchOptions
};

/// A subscription to standing questions. Like a Watch it reports every event exactly once and in order. It begins with
/// the current state, as `inside`, `within` and `is`. Missed events are reconstructed from the current state, marked
/// `resync`.
using StandingWatch = Subscription<StandingEvent>;

}  // namespace collided

#pragma GCC visibility pop
