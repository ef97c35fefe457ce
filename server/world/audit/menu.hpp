#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "idl/answers/measured.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine {

struct MenuOptions {
  std::uint32_t questions = 1'000;  // of each kind; fewer of pairs if they are rare in the world or take long
  std::uint64_t seed = 1;
  /// If there are any, these instead of random ones, of this kind only; numbers as Questions::numbers, checked.
  QuestionKind own_kind = QuestionKind::ray;
  std::vector<double> own_numbers = {};
  /// Rationals test every part of the world; limit of their time for each kind, the first question apart.
  std::int64_t judging_ns = 2'000'000'000;
  /// FCL is also asked about pairs, each time in a new process; limit of its time, the first pair of each kind apart.
  /// 0: never.
  std::int64_t opinion_ns = 0;
  std::function<bool()> cancelled = {};  // checked between questions; true ends with the results so far
};

/// The price list of a world: the same random questions about a region slightly larger than it, answered by every
/// method, alternating question by question, and judged by rationals over every part (exact_answer.hpp). An index that
/// has lost a triangle is detected. Empty for an empty world.
/// threads  any, for as long as it takes: some microseconds a question and method
std::vector<MenuRow> menu_of(const Snapshot& snapshot, const MenuOptions& options);

}  // namespace collided::engine
