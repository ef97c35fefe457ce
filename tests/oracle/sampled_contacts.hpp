#pragma once

#include <vector>

#include "server/geometry/shapes.hpp"
#include "tests/oracle/exact_oracle.hpp"

namespace collided::oracle {

/// Two bodies of spheres, boxes, capsules and triangles that go straight: where they are relative to each other at a
/// fraction of the way, tested in rationals. Knows nothing of intervals, first contacts or brackets.
class SampledContacts {
 public:
  /// The parts are where the way begins; from there b goes by `displacement` relative to a.
  SampledContacts(std::vector<Figure> a, std::vector<Figure> b, const Vec3& displacement);

  /// Whether any part of one touches any part of the other when they have come `ticks` of `of` ticks.
  bool touch_at(long ticks, long of) const;

 private:
  std::vector<Figure> a_;
  std::vector<Figure> b_;
  Point displacement_;
};

}  // namespace collided::oracle
