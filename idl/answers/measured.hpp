#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "idl/described.hpp"

/// The answers of the commands `menu` and `audit`.
namespace collided {

/// Counts of another library's answers by comparison with ours (OpinionVerdict).
struct OpinionCounts {
  std::uint64_t agree = 0;
  std::uint64_t differ = 0;
  std::uint64_t failed = 0;
  std::uint64_t unsupported = 0;

  bool operator==(const OpinionCounts&) const = default;
};
constexpr auto fields_of(const OpinionCounts*) {
  using T = OpinionCounts;
  return fields<&T::agree, &T::differ, &T::failed, &T::unsupported>();
}

/// The cost and error, in a world, of one method for one kind of question.
struct MenuRow {
  std::string asked_of;  // ray, sphere, box, near, sweep, pair, mesh pair
  std::string method;
  double worst_error_m = 0;  // observed: distances compared with rationals, depths with the sharpest method
  double worst_bound_m = 0;  // the largest bound of an answer; infinite if there are no bounds
  std::int64_t p50_ns = 0;
  std::int64_t p99_ns = 0;
  std::uint32_t asked = 0;
  std::uint32_t undecided = 0;
  std::uint32_t wrong = 0;     // judged answers that rationals contradict
  std::uint32_t judged = 0;    // answers compared with rationals; the others were only timed
  OpinionCounts opinion = {};  // FCL's, if requested: for pairs, compared with our exact answers
};
/// In the order of `collide menu --json`.
constexpr auto fields_of(const MenuRow*) {
  using T = MenuRow;
  return listed(field("kind", &T::asked_of),
                fields<&T::method, &T::worst_error_m, &T::worst_bound_m, &T::p50_ns, &T::p99_ns, &T::asked,
                       &T::undecided, &T::wrong, &T::judged>(),
                unless_default<&T::opinion>());
}
struct Menu {
  std::vector<MenuRow> rows;
  std::uint64_t seed = 0;
  std::uint64_t version = 0;
  bool late = false;  // the deadline passed before its last question
};
constexpr auto fields_of(const Menu*) {
  return listed(fields<&Menu::rows, &Menu::seed, &Menu::version>(), unless_default<&Menu::late>());
}

/// Answers of one kind, by the highest level of arithmetic used.
struct AuditedKind {
  std::string kind;
  std::uint64_t in_double = 0;
  std::uint64_t expansion = 0;
  std::uint64_t rational = 0;
};
constexpr auto fields_of(const AuditedKind*) {
  using T = AuditedKind;
  return listed(fields<&T::kind>(), field("double", &T::in_double), fields<&T::expansion, &T::rational>());
}
struct Audit {
  std::uint64_t every = 0;  // one answer in this many is recomputed; 0: none
  std::uint64_t chosen = 0;
  std::uint64_t audited = 0;
  std::uint64_t differing = 0;
  std::uint64_t skipped = 0;
  std::uint64_t float_repairs = 0;  // restorations of a thread's floating-point settings
  std::vector<AuditedKind> questions;
  std::vector<std::string> differences;  // the first ones
  std::optional<OpinionCounts> opinion;  // if the server was started with FCL
};
/// In the order of `collide audit --json`.
constexpr auto fields_of(const Audit*) {
  using T = Audit;
  return fields<&T::every, &T::chosen, &T::audited, &T::differing, &T::skipped, &T::float_repairs, &T::questions,
                &T::differences, &T::opinion>();
}

}  // namespace collided
