#pragma once

#include <array>

#include "server/exact_phase/arithmetic/polynomial.hpp"
#include "server/exact_phase/motion/moving_features.hpp"

namespace collided::engine::kernel {

/// A moving point relative to another: a vector of polynomials in time.
template <class N>
using Path = Vector<Polynomial<N>>;

/// `to` relative to `from`. Forms differences of the ends first: two points that move together at 1e9 with 1e-9 between
/// them keep the digits of their distance.
template <class N>
Path<N> path_between(const MovingPoint& from, const MovingPoint& to) {
  const auto component = [&](int k) {
    const N at_start = N(to.start[k]) - N(from.start[k]);
    return Polynomial<N>(at_start, (N(to.end[k]) - N(from.end[k])) - at_start);
  };
  return {component(0), component(1), component(2)};
}

/// Four moving points: a point and the corners of a face, or the ends of two segments.
struct Quartet {
  enum class Kind { point_face, edge_edge };

  std::array<MovingPoint, 4> point;
  Kind kind;
};

template <class N>
const Polynomial<N>& component(const Path<N>& v, int axis) {
  return axis == 0 ? v.x : axis == 1 ? v.y : v.z;
}

/// The three other points relative to the first. While the four lie in one plane, the signs of Sides and Gaps decide
/// contact.
template <class N>
struct MovingQuartet {
  std::array<Path<N>, 3> to;
  Quartet::Kind kind;

  explicit MovingQuartet(const Quartet& q) : kind(q.kind) {
    for (int i = 0; i < 3; ++i) to[i] = path_between<N>(q.point[0], q.point[i + 1]);
  }

  Polynomial<N> coplanarity() const { return dot(to[0], cross(to[1], to[2])); }
};

/// Vectors of degree 2, in groups. If two of a group have opposite signs on any axis, there is no contact. If the
/// points lie in one plane and, on one axis, no group has opposite signs and not all are zero, there is contact.
/// point and face: the turns of the point around the three edges, one group;
/// two segments: the turns of the other's ends around each, one group each, the second negated.
template <class N>
struct Sides {
  std::array<Path<N>, 4> turn;
  int group_count;
  int group_size;

  explicit Sides(const MovingQuartet<N>& q) {
    if (q.kind == Quartet::Kind::point_face) {
      turn = {cross(q.to[0], q.to[1]), cross(q.to[1], q.to[2]), cross(q.to[2], q.to[0]), {}};
      group_count = 1;
      group_size = 3;
      return;
    }
    const Path<N> left = cross(q.to[0], q.to[1]);
    const Path<N> right = cross(q.to[0], q.to[2]);
    const Path<N> start = cross(q.to[1], q.to[2]);
    turn = {left, -right, start, right - left - start};
    group_count = 2;
    group_size = 2;
  }
};

/// Vectors of degree 1. If all have one strict sign on an axis, the features' boxes are separate.
template <class N>
struct Gaps {
  std::array<Path<N>, 4> gap;
  int count;

  explicit Gaps(const MovingQuartet<N>& q) {
    if (q.kind == Quartet::Kind::point_face) {
      gap = {q.to[0], q.to[1], q.to[2], {}};
      count = 3;
      return;
    }
    gap = {q.to[1], q.to[2], q.to[1] - q.to[0], q.to[2] - q.to[0]};
    count = 4;
  }
};

/// Decides contact at a time at which the four points lie in one plane, from the signs of turns and gaps at that time,
/// given by sign_of; or on a span of such times, if sign_of gives the signs on all of it.
template <class N, class SignOf>
Decision meets_in_plane(const Sides<N>& sides, const Gaps<N>& gaps, const SignOf& sign_of) {
  bool all_flat = true;
  for (int axis = 0; axis < 3; ++axis) {
    bool unsure = false;
    bool flat = true;
    for (int group = 0; group < sides.group_count; ++group) {
      bool negative = false;
      bool positive = false;
      for (int i = 0; i < sides.group_size; ++i) {
        const Sign s = sign_of(component(sides.turn[group * sides.group_size + i], axis));
        negative = negative || s == Sign::negative;
        positive = positive || s == Sign::positive;
        unsure = unsure || s == Sign::unsure;
      }
      if (negative && positive) return Decision::no;
      flat = flat && !negative && !positive;
    }
    if (!flat && !unsure) return Decision::yes;
    all_flat = all_flat && flat && !unsure;
  }
  for (int axis = 0; axis < 3; ++axis) {
    const Sign first = sign_of(component(gaps.gap[0], axis));
    bool apart = first == Sign::negative || first == Sign::positive;
    for (int i = 0; i < gaps.count && (apart || all_flat); ++i) {
      const Sign s = sign_of(component(gaps.gap[i], axis));
      apart = apart && s == first;
      all_flat = all_flat && s != Sign::unsure;
    }
    if (apart) return Decision::no;
  }
  // All points are on one line, where overlapping boxes mean contact.
  return all_flat ? Decision::yes : Decision::undecided;
}

}  // namespace collided::engine::kernel
