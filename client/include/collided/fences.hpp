#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <collided/codes.hpp>
#include <collided/events.hpp>
#include <collided/geometry.hpp>
#include <collided/shapes.hpp>
#include <collided/subscription.hpp>

/// Fences: regions of which the server says who comes in and who goes out.
#pragma GCC visibility push(default)

namespace collided {

/// An upright prism over a simple polygon, which need not be convex. Metres.
struct Prism {
  std::vector<std::array<double, 2>> corners;  // x and y, in either direction around it; at most 100 or so
  double low_m = 0;
  double high_m = 0;
};

/// A region that stands in the world, or moves along with an object. The server follows every moving object that it looks
/// at along its whole way, as it does for contacts, so none is missed between two poses; a fence touches nothing, and no
/// question meets it.
struct Fence {
  std::string name;  // unique among fences
  /// Solid shapes and closed meshes; more than one form one fence. In the world, or in the frame of the object `to`.
  Shape shape = {};
  std::optional<Prism> prism = {};  // in place of the shape
  std::string to = {};              // name of the object that it moves along with, which need not be there yet
  std::string only = {};            // name glob of the objects that it looks at; empty: all that move
  std::string skip = {};            // name glob of those that it leaves out; empty: none
  std::uint32_t mask = 0xffffffff;  // it looks at objects of which a layer is in it
  // What it tells. Without `cross` an object that was in and out again between two poses is told as both others.
  bool enter = true;
  bool exit = true;
  bool cross = true;
  /// It stays until it is removed or the server stops, and comes back after a crash. Else it goes with the client.
  bool keep = false;
};

using codes::FenceEventKind;

/// News of an object and a fence.
struct FenceEvent {
  FenceEventKind kind = FenceEventKind::enter;
  /// Of `exit`: separated where the object, or the fence with its carrier, moved away; removed and publisher_lost of the
  /// object or the carrier; fence_removed; and as of contacts.
  EndReason reason = EndReason::none;
  /// Other than none: it is not known whether the object is in the fence, which is told as if it were.
  Doubt doubt = Doubt::none;
  /// As of contacts: the server replaced poses of the object, or of what the fence moves with, by newer ones (Event).
  bool poses_merged = false;
  bool resync = false;  // inferred from who is in: after a gap, or from a new server
  std::string object;
  std::string fence;
  std::uint64_t object_id = 0;  // the server's numbers for them
  std::uint64_t fence_id = 0;
  std::uint64_t epoch = 0;                 // grows with each start of a server
  std::uint64_t sequence = 0;              // number of the event within the epoch, of all fences
  std::uint64_t episode = 0;               // that of the object's coming in
  std::chrono::nanoseconds world_time{0};  // of the step that found it, since 1970, by the publishers' clocks
  std::chrono::nanoseconds entered{0};     // world time by which the object was in
  /// The change, of `cross` the coming in, happened between these two, in seconds before world_time.
  double bracket_low_s = 0;
  double bracket_high_s = 0;
  double left_low_s = 0;  // of `cross`: the same of the going out
  double left_high_s = 0;
  Vec3 point = Vec3::Zero();  // where the object's surface first met the fence's, in the world; zero: not known
};

/// A fence in the server, and who is in it.
struct ListedFence {
  std::string name;
  std::string kind;  // sphere, box, ..., mesh, compound
  std::string to;
  std::string only;
  std::string skip;
  bool enter = false;
  bool exit = false;
  bool cross = false;
  bool keep = false;
  std::vector<std::string> inside;    // names of the objects in it
  std::vector<std::string> in_doubt;  // of those of which that is not known
};

/// Which news of fences a watch reports.
struct FenceWatchOptions {
  std::string only = {};          // name glob that the fence or the object must match; empty: everything
  std::string skip = {};          // name glob that neither may match; empty: nothing
  std::size_t capacity = 65'536;  // as in WatchOptions
};

/// A subscription to all fences. Like a Watch it reports every event once and in order, makes up for what was missed from
/// the state of who is in, marked `resync`, and begins with who is in already, as `inside`. Of each fence it reports what
/// that is to tell.
using FenceWatch = Subscription<FenceEvent>;

}  // namespace collided

#pragma GCC visibility pop
