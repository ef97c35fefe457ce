#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "idl/answers/measured.hpp"
#include "server/world/query/query.hpp"

namespace collided::engine {

struct MenuOptions {
  std::uint32_t questions = 1'000;  // of each kind; fewer of pairs where they are rare in the world or take long
  std::uint64_t seed = 1;
  /// Where there are any: these instead of random ones, of this kind only, their numbers as Questions::numbers, checked.
  QuestionKind own_kind = QuestionKind::ray;
  std::vector<double> own_numbers = {};
  /// The rationals ask every part of the world: so long they may take for each kind, the first question apart.
  std::int64_t judging_ns = 2'000'000'000;
  /// FCL is asked about pairs too, each time in a new process: for so long, the first pair of each kind apart. 0: not at all.
  std::int64_t opinion_ns = 0;
  std::function<bool()> cancelled = {};  // asked between questions; true ends with what there is
};

/// The price list of a world: the same random questions about a place a little larger than it, answered in every way
/// that there is, the ways in turn question by question, and judged by rationals over every part (exact_answer.hpp):
/// an index that has lost a triangle is found out. Empty for an empty world.
/// threads  any, for as long as it takes: some microseconds a question and method
std::vector<MenuRow> menu_of(const Snapshot& snapshot, const MenuOptions& options);

}  // namespace collided::engine
