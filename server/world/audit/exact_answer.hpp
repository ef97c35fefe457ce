#pragma once

#include <limits>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/exact_phase/given/given_part.hpp"
#include "server/exact_phase/solid/surface_crossing.hpp"
#include "server/exact_phase/solid/winding_tree.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine {

/// A number and a bound on its error.
struct Interval {
  double low = 0;
  double high = 0;

  Interval(double value, double error) : low(value - error), high(value + error) {}
};

/// True if the two may be the same number, allowing for the rounding of the comparison itself.
bool may_be_equal(const Interval& a, const Interval& b);

/// The answer to one question about the world by rationals alone: every part of every object is tested, without index,
/// filter or float. Skips parts that a simple and generous comparison shows to be far off.
///
/// cost     some microseconds a part near the question, some nanoseconds each of the others; allocates
/// threads  any; what the question refers to must outlive it
class ExactAnswer {
 public:
  /// far_m  for near: objects farther than this need not be known, since the judged answers end before. Infinite: the
  ///        nearest is found, and of several as many as the question wants
  ExactAnswer(const Snapshot& snapshot, const Questions& question,
              double far_m = std::numeric_limits<double>::infinity());

  /// The difference of an answer to the question, as part of a sentence; empty if there is none.
  std::string difference(const Answers& given) const;
  /// For rays and near: the distance of the first; nothing if nothing is met.
  std::optional<Interval> first() const;
  /// For spheres, boxes and inside.
  const std::set<ObjectId>& touched() const { return touched_; }
  /// True if the objects are those touched. Round parts that nearly touch may be among them or not.
  bool are_touched(const std::set<ObjectId>& objects) const;

 private:
  using PartName = std::pair<ObjectId, std::uint32_t>;

  bool allowed(const Snapshot& snapshot, ObjectId id) const;
  void cast_ray(const Snapshot& snapshot);
  /// The meshes for which the point is on that side by winding number.
  std::vector<ObjectId> by_winding(const Snapshot& snapshot, WindingSide asked) const;
  /// The declared solids that contain the centre of the question's shape; with least `on`, also on their surface.
  std::vector<ObjectId> holders(const Snapshot& snapshot, SolidSide least) const;
  /// near: bounds of the question's shape as given
  void find_touched(const Snapshot& snapshot, const Primitive& asked, const GivenPart& given_asked, const Aabb& near);
  void find_nearest(const Snapshot& snapshot, double far_m);
  std::string difference_of_verdict(Verdict given) const;
  std::string difference_of_ray(const Answers& given) const;
  std::string difference_of_first(const AnswerHit& hit) const;
  std::string difference_of_overlaps(const Answers& given) const;
  std::string difference_of_near(const Answers& given) const;

  Questions question_;
  std::map<PartName, Interval> met_;
  std::set<ObjectId> touched_;
  std::set<ObjectId> doubtful_;  // round parts that nearly touch: rationals alone cannot decide
  std::map<ObjectId, Interval> distances_;
};

}  // namespace collided::engine
