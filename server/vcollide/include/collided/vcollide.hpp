#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

/// The calls of V-COLLIDE on Collided's engine, in the caller's own process: no server, no topics. A program written
/// for V-COLLIDE 2 includes this header, says `using namespace collided::vcollide;` and links Collided::vcollide. Names
/// and values are those of the original (Hudson, Lin, Cohen, Gottschalk, Manocha, "V-COLLIDE: Accelerated Collision
/// Detection for VRML", 1997); answers are exact for the given doubles, and touching counts as overlap.
#pragma GCC visibility push(default)

namespace collided::vcollide {

inline constexpr int VC_ERR_INVALID_ID = -4;
inline constexpr int VC_ERR_EMPTY_OBJECT = -3;  // EndObject without a triangle
inline constexpr int VC_ERR_CALL_OUT_OF_SEQUENCE = -2;
inline constexpr int VC_ERR = -1;  // an argument that is not allowed
inline constexpr int VC_OK = 1;

inline constexpr int VC_ALL_CONTACTS = 1;   // every pair of triangles that meet, of each two objects
inline constexpr int VC_FIRST_CONTACT = 2;  // one of them: shows which objects meet, at less cost

/// The object pairs of one Collide, ordered by (obj1ID, obj2ID) with obj1ID < obj2ID, each with its triangle pairs by
/// the ids given to AddTri, in ascending order and each once. Numbers of pairs count from 0; one out of range throws
/// std::out_of_range.
class VCReport {
 public:
  int numObjPairs() const { return static_cast<int>(pairs_.size()); }
  int obj1ID(int pair) const { return at(pair).object[0]; }
  int obj2ID(int pair) const { return at(pair).object[1]; }
  int numTriPairs(int pair) const { return static_cast<int>(at(pair).triangles.size()); }
  int tri1ID(int pair, int number) const { return at(pair).triangles.at(static_cast<std::size_t>(number))[0]; }
  int tri2ID(int pair, int number) const { return at(pair).triangles.at(static_cast<std::size_t>(number))[1]; }

 private:
  friend class VCollide;
  struct ObjectPair {
    std::array<int, 2> object;
    std::vector<std::array<int, 2>> triangles;
  };
  const ObjectPair& at(int pair) const { return pairs_.at(static_cast<std::size_t>(pair)); }
  std::vector<ObjectPair> pairs_;
};

/// Objects made of triangles, and which of them meet at their present places.
/// Every call returns VC_OK or an error; a call that fails changes nothing, and LastError() describes it.
/// threads  one at a time
class VCollide {
 public:
  VCollide();
  ~VCollide();
  VCollide(const VCollide&) = delete;
  VCollide& operator=(const VCollide&) = delete;

  /// Opens an object for AddTri; ids count up from 0 and are never reused.
  int NewObject(int* id);
  /// Adds a triangle to the open object, in its own frame, metres; every number must be finite. Reports name it by
  /// `id`.
  int AddTri(const double v1[3], const double v2[3], const double v3[3], int id);
  /// Closes and indexes the open object, which must have a triangle; it is then active, with the identity for its
  /// transform.
  int EndObject();

  /// Moves an object: a rotation in the upper left 3 by 3, a translation in metres in the last column; the last row
  /// must be 0 0 0 1. Products of the rotation's columns may be off by 1e-6; the nearest rotation is then used.
  int UpdateTrans(int id, const double trans[4][4]);

  /// An inactive object meets no other.
  int ActivateObject(int id);
  int DeactivateObject(int id);
  /// Whether the two objects are tested against each other while both are active; they are at first.
  int ActivatePair(int id1, int id2);
  int DeactivatePair(int id1, int id2);
  /// Deletes an object.
  int DeleteObject(int id);

  /// Reports surfaces that share a point; a triangle mesh has no inside.
  /// cost  grows with the objects whose bounding boxes overlap, and with their triangles near each other
  int Collide(VCReport* report, int flag = VC_FIRST_CONTACT);

  /// Describes the last call that failed: what was wrong, the value and the limit. Empty until one fails.
  const std::string& LastError() const;
  /// Counts of the last Collide: active pairs of objects whose boxes overlapped, and pairs of triangles tested exactly.
  std::size_t ObjectCandidates() const;
  std::size_t TriangleCandidates() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace collided::vcollide

#pragma GCC visibility pop
