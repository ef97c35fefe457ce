#pragma once

#include <array>
#include <chrono>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <collided/geometry.hpp>

/// What commands take and give: they change the world, or say what is in it.
#pragma GCC visibility push(default)

namespace collided {

struct Added {
  std::uint64_t id = 0;
  std::uint64_t version = 0;  // of the world that holds it
};

struct Moved {
  double distance_m = 0;
  std::vector<std::string> began;  // names of what it touches now and did not before
  std::vector<std::string> ended;
  std::uint64_t version = 0;
};

struct Removed {
  std::vector<std::string> names;
  std::uint64_t contacts_ended = 0;
  std::uint64_t version = 0;
};

/// scene   only this one; empty: all of them
/// moving  what moves too; without a scene only what moves
struct ClearOptions {
  std::string scene = {};
  bool moving = false;
};
struct Cleared {
  std::uint64_t removed = 0;  // objects
  std::uint64_t kept = 0;     // that belong to living publishers
  std::uint64_t contacts_ended = 0;
  std::uint64_t version = 0;
};

/// low <= high in every coordinate; infinity is allowed.
struct CoveredBox {
  Vec3 low = Vec3::Zero();
  Vec3 high = Vec3::Zero();
};

struct LoadOptions {
  std::string name = {};  // of the scene; empty: the file's stem
  double unit_m = 1;      // metres of one unit of the file
  std::string up = {};    // axis of the file that points up, "y" or "z"; empty: as its format says, else z
  double radius_m = 0;    // of the balls about the points of a cloud
  bool strict = false;    // refuse what would be mended
  bool mend = false;      // cut edges at T-vertices and close cracks
  double crack_m = 0;     // widest of them; 0: a ten-thousandth of the diagonal
  std::string srdf = {};  // of a robot: the file, on the server, that says which links may touch
  bool replace = false;   // the scene of that name
  std::vector<CoveredBox> covers = {};  // where its geometry is complete: outside of all such nothing is called free
  std::chrono::nanoseconds timeout{600'000'000'000};
};
/// Sentences for people: what was placed where and mended, which parts were refused, what looks odd, and which of the
/// server's structures this world does without.
struct Loaded {
  std::string scene;
  std::uint64_t triangles = 0;
  std::uint64_t parts = 0;
  std::uint64_t objects = 0;
  double seconds = 0;
  std::vector<std::string> placed, notes, mended, refused, warnings, left_out;
  std::vector<CoveredBox> covers;
  std::uint64_t version = 0;
};

struct ListOptions {
  std::string name = {};            // or glob; empty: all
  std::optional<bool> moving = {};  // only what moves, or only what does not
  std::uint64_t limit = 10'000;
};
struct ListedObject {
  std::string name;
  std::uint64_t id = 0;
  std::string kind;  // sphere, box, ..., mesh, compound (of several), part (of a scene)
  bool moving = false;
  std::string scene;             // that it is of; empty: none
  std::string publisher;         // empty: none
  std::optional<Vec3> position;  // none of a scene's part
  std::uint64_t triangles = 0;
  std::uint32_t layers = 0;
  bool stale = false;  // its publisher is lost
};
struct ObjectList {
  std::vector<ListedObject> objects;
  std::uint64_t count = 0;  // all that there are, more than listed where the limit cut
  std::uint64_t version = 0;
};

struct ObjectDetails : ListedObject {
  std::uint32_t mask = 0;
  std::uint32_t group = 0;
  std::optional<Pose> pose;                                // none of a scene's part
  std::array<Vec3, 2> bounds{Vec3::Zero(), Vec3::Zero()};  // low and high corner, in the world
  std::optional<std::chrono::nanoseconds> age;             // of the pose, of what moves
  std::vector<std::string> contacts;                       // names of what it touches
};

struct PlannedStructure {
  std::string structure;
  bool built = false;
  std::string reason;
  std::string saves;
};
struct PlannedPair {
  std::string a, b;  // kinds of shapes
  std::string how;   // they are decided, or that the pair is not offered
};
struct Plan {
  std::vector<PlannedStructure> structures;
  std::vector<PlannedPair> pairs;
  std::uint64_t bytes = 0;  // of all scenes
};

}  // namespace collided

#pragma GCC visibility pop
