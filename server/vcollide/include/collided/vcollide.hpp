#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

/// The calls of V-COLLIDE over Collided's engine, in the caller's own process: no server, no topics. A program written
/// for V-COLLIDE 2 includes this header, says `using namespace collided::vcollide;` and links Collided::vcollide.
/// Names and values are those it knows (Hudson, Lin, Cohen, Gottschalk, Manocha, "V-COLLIDE: Accelerated Collision
/// Detection for VRML", 1997); the answers are exact for the given doubles, and touching is overlap.
#pragma GCC visibility push(default)

namespace collided::vcollide {

inline constexpr int VC_ERR_INVALID_ID = -4;
inline constexpr int VC_ERR_EMPTY_OBJECT = -3;  // EndObject without a triangle
inline constexpr int VC_ERR_CALL_OUT_OF_SEQUENCE = -2;
inline constexpr int VC_ERR = -1;  // a number that is not allowed
inline constexpr int VC_OK = 1;

inline constexpr int VC_ALL_CONTACTS = 1;   // every pair of triangles of two objects that meet
inline constexpr int VC_FIRST_CONTACT = 2;  // one of them: says which objects meet, for less

/// The object pairs of one Collide, ordered by (obj1ID, obj2ID) with obj1ID < obj2ID; the triangle pairs of each, by
/// the ids given to AddTri, in ascending order and each once.
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

/// Objects of triangles, and which of them meet where they are now. One thread at a time.
/// Every call returns VC_OK or an error, which changes nothing; LastError() says it in words.
class VCollide {
 public:
  VCollide();
  ~VCollide();
  VCollide(const VCollide&) = delete;
  VCollide& operator=(const VCollide&) = delete;

  /// Opens an object for AddTri; ids count up from 0 and are not used again.
  int NewObject(int* id);
  /// A triangle of the open object, in its own frame, metres, every number finite. `id` is what reports call it.
  int AddTri(const double v1[3], const double v2[3], const double v3[3], int id);
  /// Closes and indexes the open object; it is active and at its own frame's place.
  int EndObject();

  /// Where the object is: a rotation in the upper left 3 by 3, a translation in the last column, metres; the last row
  /// is 0 0 0 1. Rows may differ from a rotation's by 1e-6; then the rotation nearby is meant.
  int UpdateTrans(int id, const double trans[4][4]);

  /// An inactive object meets nothing.
  int ActivateObject(int id);
  int DeactivateObject(int id);
  /// Whether two objects are looked at together, while both are active.
  int ActivatePair(int id1, int id2);
  int DeactivatePair(int id1, int id2);
  int DeleteObject(int id);

  /// Surfaces that share a point: a triangle mesh has no inside.
  /// cost  follows the objects whose bounding boxes overlap, and their triangles near each other
  int Collide(VCReport* report, int flag = VC_FIRST_CONTACT);

  /// Of the last call that failed: what, the value and the limit.
  const std::string& LastError() const;
  /// Of the last Collide: pairs of objects whose boxes overlapped, and pairs of triangles put to the exact test.
  std::size_t ObjectCandidates() const;
  std::size_t TriangleCandidates() const;

 private:
  struct State;
  std::unique_ptr<State> state_;
};

}  // namespace collided::vcollide

#pragma GCC visibility pop
