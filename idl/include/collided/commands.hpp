#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <collided/geometry.hpp>

/// The options and answers of commands, which change or list the world. Metres, world coordinates. In every answer
/// `version` is that of the state that the answer is about; a command that changes the world creates that state.
#pragma GCC visibility push(default)

namespace collided {

/// The answer of Client::add.
struct Added {
  std::uint64_t id = 0;  // the server's number for the object
  std::uint64_t version = 0;
  std::string not_kept = {};  // why a crash of the server would undo it; empty: it is on disk
  std::string warning = {};   // why a mesh is more than the boundary of a solid; empty: it is not
};

/// The answer of Client::move.
struct Moved {
  double distance_m = 0;           // between the old and the new position
  std::vector<std::string> began;  // names of objects that it touches now and did not before
  std::vector<std::string> ended;  // names of objects that it no longer touches
  std::uint64_t version = 0;
  std::string not_kept = {};  // as in Added
};

/// The answer of Client::remove.
struct Removed {
  std::vector<std::string> names;  // of the objects removed
  std::uint64_t contacts_ended = 0;
  std::uint64_t version = 0;
  std::string not_kept = {};  // as in Added
};

/// The answer of Client::allow and Client::deny.
struct RuleChanged {
  std::uint64_t rules = 0;     // number of rules now, at most 64
  std::uint64_t a_count = 0;   // objects that match the first glob now
  std::uint64_t b_count = 0;   // and the second
  std::uint64_t contacts = 0;  // that ended (allow) or began (deny)
  std::uint64_t version = 0;
  std::string not_kept = {};  // as in Added
};
/// A rule about which pairs may touch.
struct ListedRule {
  std::string a, b;     // globs: each object of the first with each of the second
  std::string because;  // for people; may be empty
  bool allows = true;   // false: it revokes what earlier rules allow for such a pair
};

/// The answer of Client::attach and Client::detach.
struct Attached {
  std::string parent;  // that the object moves along with, or did before detach
  std::uint64_t version = 0;
  std::string not_kept = {};  // as in Added
};

/// Which objects Client::clear removes.
struct ClearOptions {
  std::string scene = {};  // only this scene; empty: all of them
  bool moving = false;     // also moving objects; without a scene only those
};
/// The answer of Client::clear.
struct Cleared {
  std::uint64_t removed = 0;  // number of objects
  std::uint64_t kept = 0;     // number of objects that stay, since they belong to living publishers
  std::uint64_t contacts_ended = 0;
  std::uint64_t version = 0;
  std::string not_kept = {};  // as in Added
};

/// A box along the world's axes in which a scene's geometry is complete. low <= high in every coordinate; infinity is
/// allowed.
struct CoveredBox {
  Vec3 low = Vec3::Zero();
  Vec3 high = Vec3::Zero();
};

/// How Client::load reads a file.
struct LoadOptions {
  std::string name = {};  // of the scene; empty: the file's name without its extension
  double unit_m = 1;      // length of the file's unit
  std::string up = {};    // the file's axis that points up, "y" or "z"; empty: that of the format, or z
  double radius_m = 0;    // of the balls about the points of a cloud
  bool strict = false;    // refuse faults that would otherwise be mended
  bool mend = false;      // cut edges at T-vertices and close cracks
  double crack_m = 0;     // the widest crack to close; 0: a ten-thousandth of the diagonal
  std::string srdf = {};  // for a robot: path, on the server, of the file that lists the links that may touch
  /// For a robot: entries "NAME=DIR", the folder on the server of a package that its file refers to
  /// (package://NAME/FILE).
  std::vector<std::string> packages = {};
  bool replace = false;  // replace the scene of that name, if it exists
  bool moving = false;   // its objects can be moved, by Client::move or by a publisher that claims them
  /// Name glob of the parts and objects whose meshes are solid ("*": all); empty: none. Those that do not close stay
  /// surfaces, and Loaded::refused says why.
  std::string solid = {};
  /// Then those that do not close are solid by their winding number for Client::inside and HitMode::signed_near; for
  /// all other questions, and for events, they are surfaces.
  bool solid_by_winding = false;
  std::vector<CoveredBox> covers = {};  // where the geometry is complete; outside these boxes nothing counts as free
  std::chrono::nanoseconds timeout{600'000'000'000};  // without a progress message
};
/// The answer of Client::load. The lists contain sentences for people.
struct Loaded {
  std::string scene;  // its name
  std::uint64_t triangles = 0;
  std::uint64_t parts = 0;            // of the scene's mesh
  std::uint64_t objects = 0;          // in addition to the parts
  double seconds = 0;                 // duration of loading
  std::vector<std::string> placed;    // objects placed, with their places
  std::vector<std::string> notes;     // other facts worth knowing
  std::vector<std::string> mended;    // faults that were mended
  std::vector<std::string> refused;   // parts that were refused, and why
  std::vector<std::string> warnings;  // suspicious facts
  std::vector<std::string> left_out;  // index structures that the server did not build for this world
  std::vector<CoveredBox> covers;     // as in LoadOptions
  std::uint64_t version = 0;
  std::string not_kept = {};  // as in Added
};

/// Which objects Client::list returns.
struct ListOptions {
  std::string name = {};            // name or glob; empty: all
  std::optional<bool> moving = {};  // true: only moving objects; false: only static ones
  std::uint64_t limit = 10'000;     // objects returned at most
};
/// An object in brief.
struct ListedObject {
  std::string name;
  std::uint64_t id = 0;  // the server's number for it
  std::string kind;      // sphere, box, ..., mesh, compound (of several shapes), part (of a scene's mesh)
  bool moving = false;
  std::string scene;             // the scene it was loaded with; empty: none
  std::string publisher;         // name of its publisher; empty: none
  std::optional<Vec3> position;  // none for a scene's part
  std::uint64_t triangles = 0;   // in its mesh
  std::uint32_t layers = 0;      // as in ObjectOptions
  bool stale = false;            // its publisher is lost (LostPolicy::freeze)
  std::string attached_to = {};  // the object it moves along with (Client::attach); empty: none
};
/// The answer of Client::list.
struct ObjectList {
  std::vector<ListedObject> objects;
  std::uint64_t count = 0;  // of all matches, which may exceed the limit
  std::uint64_t version = 0;
};

/// The answer of Client::get: an object in full.
struct ObjectDetails : ListedObject {
  std::uint32_t mask = 0;  // as in ObjectOptions
  std::uint32_t group = 0;
  std::optional<Pose> pose;                                // the newest; none for a scene's part
  std::array<Vec3, 2> bounds{Vec3::Zero(), Vec3::Zero()};  // low and high corner, in the world
  std::optional<std::chrono::nanoseconds> age;             // of the pose, if it moves
  std::vector<std::string> contacts;                       // names of objects that it touches
  bool solid = false;             // it contains points: Client::inside. False for a mesh that was not declared solid
  bool solid_by_winding = false;  // solid by its winding number, since its mesh does not close
};

/// An index structure that the server builds only if needed.
struct PlannedStructure {
  std::string structure;  // its name
  bool built = false;     // else left out
  std::string reason;     // why it is built or not
  std::string saves;      // what that decision saves
};
/// How the server decides whether shapes of two kinds touch.
struct PlannedPair {
  std::string a, b;  // kinds of shapes
  std::string how;   // the method, or that the pair is not supported
};
/// An optional part that this server was built with.
struct Wing {
  std::string name;     // fleet, authority, keys, flight recorder
  bool in_use = false;  // its options, or other servers, use it
};
/// The answer of Client::plan.
struct Plan {
  std::vector<PlannedStructure> structures;
  std::vector<PlannedPair> pairs;
  std::uint64_t bytes = 0;  // of memory for all scenes
  std::vector<Wing> wings;
};

}  // namespace collided

#pragma GCC visibility pop
