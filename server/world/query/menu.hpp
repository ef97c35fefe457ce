#pragma once

#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "server/world/query/query.hpp"

namespace collided::engine {

/// What one way of answering one kind of question costs in this world, and how far off it is.
struct MenuRow {
  QuestionKind kind = QuestionKind::ray;
  std::string method;
  std::uint32_t asked = 0;
  std::uint32_t undecided = 0;
  std::uint32_t wrong = 0;   // yes for no, no for yes, or another set of objects
  double worst_error_m = 0;  // observed: against rationals for distances, against the sharpest depth for overlaps
  double worst_bound_m = 0;  // the largest that came with a number; infinite where none comes
  std::int64_t p50_ns = 0;
  std::int64_t p99_ns = 0;
};

struct MenuOptions {
  std::uint32_t questions = 1'000;  // of each kind
  std::uint64_t seed = 1;
  std::function<bool()> cancelled;  // asked between questions; true ends with what there is
};

/// The price list of a world: the same random questions about a place a little larger than it, answered in every way
/// that there is, the ways in turn question by question. Empty for an empty world.
/// threads  any, for as long as it takes: some microseconds a question and method
std::vector<MenuRow> menu_of(const Snapshot& snapshot, const MenuOptions& options);

}  // namespace collided::engine
