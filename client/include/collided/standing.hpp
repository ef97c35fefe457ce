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

/// Standing questions: the server keeps them and reports each change of their answers. Metres, seconds, world coordinates.
#pragma GCC visibility push(default)

namespace collided {

/// An upright prism over a simple polygon, which need not be convex.
struct Prism {
  std::vector<std::array<double, 2>> corners;  // x and y, in either direction around it; at most 100 or so
  double low_m = 0;
  double high_m = 0;
};

/// Which moving objects are in a region, which stands in the world or moves along with an object.
struct Region {
  /// Solid shapes and closed meshes; more than one form one region. In the world, or in the frame of the object `to`.
  Shape shape = {};
  std::optional<Prism> prism = {};  // in place of the shape
  std::string to = {};              // name of the object that it moves along with, which need not be there yet
  // What it reports. Without `cross` an object that was in and out again between two poses is reported as both others.
  bool enter = true;
  bool exit = true;
  bool cross = true;
};

/// Which pairs of an object `around` and another one, at least one of which moves, are within bands of distance. Parts of
/// loaded scenes have no bands: give what stands still a shape of its own (Client::add).
struct Bands {
  std::string around;                 // name glob of the objects that have the bands; those of `only` may be among them
  std::vector<double> bands_m = {};   // the widest first; at most seven besides contact, which is always one
  double hysteresis_m = 0;            // a pair within a band leaves it beyond the band plus this
  std::chrono::nanoseconds dwell{0};  // a change is reported once it has lasted so long, up to an hour; contact at once
};

/// Which object is nearest to another one, or to a point. Objects that stand still count, parts of loaded scenes do not. It
/// is decided once the publishers of all of them have said where they are.
struct Nearest {
  std::string to = {};             // name of the object that the distances are to, which need not be there yet
  std::optional<Vec3> point = {};  // in place of it
  double within_m = 0;             // objects farther away do not count
  double hysteresis_m = 0;         // another one must be nearer by more than this; the last one may be so much farther
};

/// A standing question. The server follows every object that it looks at along its whole way, as it does for contacts, so
/// that no change between two poses is missed. A region touches nothing and no question meets it; groups, allowed pairs and
/// the objects' own masks do not matter to a standing question.
struct Standing {
  std::string name;                 // unique among standing questions
  std::string only = {};            // name glob of the objects that it looks at; empty, of a region: all that move
  std::string skip = {};            // name glob of objects that it leaves out; empty: none
  std::uint32_t mask = 0xffffffff;  // of the objects of `only` it looks at those of which a layer is in it
  /// It stays until it is removed, and outlives a stop and a crash of the server. Else it goes with the client.
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
  /// Why what held is over, of exit, leave and changed: separated, where the two moved apart or another object is nearer;
  /// fence_removed, where the question was removed; else as of contacts.
  EndReason reason = EndReason::none;
  /// Other than none: it is not known whether it holds, or whether a change lasted long enough, and it is reported as if so.
  Doubt doubt = Doubt::none;
  /// As of contacts: the server replaced poses of one of the two by newer ones (Event).
  bool poses_merged = false;
  bool resync = false;   // inferred from what holds: after a gap, or from a new server
  std::string standing;  // name of the question
  std::string object;  // in the region, or within the band; of the nearest the one that is, empty: none is near enough
  std::string other;   // of bands: the object that has them; of the nearest: the one before; empty: none, or not known
  double band_m = 0;   // of bands; 0: contact
  std::uint64_t object_id = 0;             // the server's number for the object
  std::uint64_t epoch = 0;                 // grows with each start of a server
  std::uint64_t sequence = 0;              // number of the event within the epoch, of all standing questions
  std::uint64_t episode = 0;               // that of the event with which it began to hold
  std::chrono::nanoseconds world_time{0};  // of the step that found it, since 1970, by the publishers' clocks
  std::chrono::nanoseconds entered{0};     // world time by which it held
  /// The change, of cross the coming in, happened between these two, in seconds before world_time.
  double bracket_low_s = 0;
  double bracket_high_s = 0;
  double left_low_s = 0;  // of cross: the same of the going out
  double left_high_s = 0;
  // Of bands and the nearest, at the end of the bracket, where two came nearer; 0 where there is a doubt.
  double distance_m = 0;  // |truth - distance_m| <= distance_error_m
  double distance_error_m = 0;
  /// Of a region: where the object's surface first met the region's. Else the object's point that is nearest to the other
  /// one. In the world; zero: not known, or they touch.
  Vec3 point = Vec3::Zero();
  Vec3 normal = Vec3::Zero();  // unit, from there to the other one; zero: not known, or they touch
  /// Of bands: how fast the distance shrinks, m/s; negative: it grows. 0 for an object that is new or was put there.
  double closing_mps = 0;
  double closing_error_mps = 0;  // |truth - closing_mps| at most
  /// After how many seconds from the end of the bracket the two would touch if both went on as they moved then: not before
  /// the first, and by the second.
  struct Forecast {
    double low_s = 0;
    double high_s = 0;
  };
  /// Of bands; nothing: not within a minute.
  std::optional<Forecast> contact_in = {};
};

/// What was found in the world when a standing question was added.
struct AddedStanding {
  /// Of bands: parts of loaded scenes that one of the globs matches, which have none.
  std::uint64_t parts = 0;
};

/// Which events a watch reports.
struct StandingWatchOptions {
  std::string only = {};  // name glob that the question or one of the two objects must match; empty: everything
  std::string skip = {};  // name glob that none of them may match; empty: nothing
  std::optional<StandingForm> form = {};  // of this form alone
  std::size_t capacity = 65'536;          // as in WatchOptions
};

/// A subscription to standing questions. Like a Watch it reports every event once and in order, makes up for what was missed
/// from what holds, marked `resync`, and begins with what holds already, as `inside`, `within` and `is`.
using StandingWatch = Subscription<StandingEvent>;

}  // namespace collided

#pragma GCC visibility pop
