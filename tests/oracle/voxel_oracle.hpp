#pragma once

#include <array>
#include <boost/multiprecision/cpp_int.hpp>
#include <cstdint>
#include <set>

namespace collided::oracle {

using CellNumbers = std::array<std::int32_t, 3>;

/// The cells of a grid whose inside a segment meets, by trying each of those in its bounding box: slow and in rationals.
/// Cell n reaches from n to n + 1 along each axis.
inline std::set<CellNumbers> cells_met(const std::array<boost::multiprecision::cpp_rational, 3>& from,
                                       const std::array<boost::multiprecision::cpp_rational, 3>& to) {
  using Rational = boost::multiprecision::cpp_rational;
  const auto floor_of = [](const Rational& x) {
    boost::multiprecision::cpp_int whole = numerator(x) / denominator(x);
    if (Rational(whole) > x) --whole;
    return static_cast<std::int32_t>(whole);
  };
  CellNumbers low{}, high{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    low[axis] = floor_of(from[axis] < to[axis] ? from[axis] : to[axis]) - 1;
    high[axis] = floor_of(from[axis] < to[axis] ? to[axis] : from[axis]) + 1;
  }
  std::set<CellNumbers> met;
  for (std::int32_t x = low[0]; x <= high[0]; ++x) {
    for (std::int32_t y = low[1]; y <= high[1]; ++y) {
      for (std::int32_t z = low[2]; z <= high[2]; ++z) {
        const CellNumbers cell{x, y, z};
        Rational begin = 0, end = 1;  // the open stretch that is inside
        bool is_met = true;
        for (std::size_t axis = 0; axis < 3; ++axis) {
          const Rational along = to[axis] - from[axis];
          if (along == 0) {
            is_met = is_met && from[axis] > cell[axis] && from[axis] < cell[axis] + 1;
            continue;
          }
          Rational first = (cell[axis] - from[axis]) / along, second = (cell[axis] + 1 - from[axis]) / along;
          if (first > second) std::swap(first, second);
          if (first > begin) begin = first;
          if (second < end) end = second;
        }
        if (is_met && begin < end) met.insert(cell);
      }
    }
  }
  return met;
}

}  // namespace collided::oracle
