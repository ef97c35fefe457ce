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

/// A number and how far the truth may be from it.
struct Interval {
  double low = 0;
  double high = 0;

  Interval(double value, double error) : low(value - error), high(value + error) {}
};

/// Whether the two may be the same number, but for the roundings of the comparison itself.
bool may_be_equal(const Interval& a, const Interval& b);

/// The answer to one question about the world by rationals alone: every part of every object is asked, without index,
/// filter or float. Parts that are far off by a plain and generous comparison are passed over.
///
/// cost     some microseconds a part near the question, some nanoseconds each of the others; allocates
/// threads  any; what the question refers to must outlive it
class ExactAnswer {
 public:
  /// far_m  of near: objects farther than this need not be known, since the answers to be judged end before. Infinite:
  ///        the nearest is known, and of several as many as were asked for
  ExactAnswer(const Snapshot& snapshot, const Questions& question,
              double far_m = std::numeric_limits<double>::infinity());

  /// What differs in an answer to the question, as part of a sentence; empty where nothing does.
  std::string difference(const Answers& given) const;
  /// Of rays and near: the distance of the first; nothing where nothing is met.
  std::optional<Interval> first() const;
  /// Of spheres, boxes and inside.
  const std::set<ObjectId>& touched() const { return touched_; }
  /// Whether the objects are those touched. Round parts that nearly touch may be among them or not.
  bool are_touched(const std::set<ObjectId>& objects) const;

 private:
  using PartName = std::pair<ObjectId, std::uint32_t>;

  bool allowed(const Snapshot& snapshot, ObjectId id) const;
  void cast_ray(const Snapshot& snapshot);
  /// The meshes that have the point on that side by their winding number.
  std::vector<ObjectId> by_winding(const Snapshot& snapshot, WindingSide asked) const;
  /// The declared solids in which the middle of what is asked about lies; least `on`: or on whose surface.
  std::vector<ObjectId> holders(const Snapshot& snapshot, SolidSide least) const;
  /// near: bounds of the asked shape as given
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
  std::set<ObjectId> doubtful_;  // round parts that nearly touch: rationals alone cannot say
  std::map<ObjectId, Interval> distances_;
};

}  // namespace collided::engine
