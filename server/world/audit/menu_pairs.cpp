#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <limits>
#include <optional>
#include <random>

#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/exact_phase/exactly.hpp"
#include "server/exact_phase/given/given_overlap.hpp"
#include "server/geometry/guess_tolerance.hpp"
#include "server/world/audit/exact_answer.hpp"
#include "server/world/audit/fcl_opinion.hpp"
#include "server/world/audit/menu_table.hpp"
#include "server/world/query/object_parts.hpp"
#include "server/world/query/pair_report.hpp"

namespace collided::engine {
namespace {

/// Objects of more pairs of parts than this are timed only: judging compares every part of one with every part of the
/// other.
constexpr std::size_t kMostJudgedPairs = 4'000'000;
/// A report on large parts of a scene builds their index first: no more pairs are started after this time.
constexpr std::chrono::seconds kAskingTime{10};
/// An object of more triangles is left out: each report would build an index of them.
constexpr std::size_t kMostParts = 50'000;

struct MenuObject {
  ObjectId id = 0;
  Aabb bounds;
  std::size_t part_count = 0;
  bool is_mesh = false;
};

struct PartWithBounds {
  ConvexPart part;
  GivenPart given;
  Aabb bounds;
};

std::vector<PartWithBounds> parts_with_bounds(const Snapshot& snapshot, ObjectId object) {
  std::vector<PartWithBounds> parts;
  std::vector<ConvexPart> placed = parts_of_object(snapshot, object);
  const std::vector<GivenPart> given = given_parts_of_object(snapshot, object);
  for (std::size_t i = 0; i < placed.size(); ++i) {
    const Aabb box = bounds_of_part(placed[i]);
    parts.push_back({std::move(placed[i]), given[i], box});
  }
  return parts;
}

double gap_between(const Aabb& a, const Aabb& b) {
  return (b.low - a.high).cwiseMax(a.low - b.high).cwiseMax(Vec3::Zero()).norm();
}

Decision exactly_overlaps(const ConvexPart& a, const ConvexPart& b) {
  if (const auto* first = std::get_if<Primitive>(&a)) {
    return std::visit([&](const auto& other) { return exactly::overlaps(*first, other); }, b);
  }
  if (std::holds_alternative<Primitive>(b)) return exactly_overlaps(b, a);
  return exactly::overlaps(std::get<Triangle>(a), std::get<Triangle>(b));
}

/// Decides for the numbers as given.
Decision decided_by_rationals(const PartWithBounds& a, const PartWithBounds& b) {
  const GivenPair given{a.given, b.given};
  const Decision as_given = given.is_exact() ? Decision::undecided : overlaps_as_given(a.part, b.part, given);
  return as_given == Decision::undecided ? exactly_overlaps(a.part, b.part) : as_given;
}

/// A gap of this many roundings, relative to the distance from the origin, is also one for the numbers as given.
constexpr double kRoundings = 1e-12;

/// The relation of two objects: yes or no by rationals, every part against every part, without an index; if apart, the
/// least distance of any two parts.
struct ExactPair {
  Decision touches = Decision::no;
  double distance_m = std::numeric_limits<double>::infinity();
  double error_m = 0;

  ExactPair(const std::vector<PartWithBounds>& a, const std::vector<PartWithBounds>& b) {
    for (const PartWithBounds& x : a) {
      for (const PartWithBounds& y : b) look(x, y);
      if (touches == Decision::yes) return;
    }
  }

 private:
  void look(const PartWithBounds& a, const PartWithBounds& b) {
    if (touches == Decision::yes) return;
    const double gap_m = gap_between(a.bounds, b.bounds) * (1 - kSearchMargin);
    if (gap_m > distance_m + error_m) return;
    const double size_m = a.bounds.low.cwiseAbs().cwiseMax(a.bounds.high.cwiseAbs()).maxCoeff();
    const Decision here = gap_m > kRoundings * size_m ? Decision::no : decided_by_rationals(a, b);
    if (here != Decision::no) touches = here;
    if (here != Decision::no) return;
    const Separation apart = separation(a.part, b.part);
    if (apart.distance_m >= distance_m) return;
    distance_m = apart.distance_m;
    error_m = apart.error_m;
  }
};

/// The objects to choose from, and random pairs of them: every second time with the nearest one, so that some touch.
class RandomPairs {
 public:
  RandomPairs(const Snapshot& snapshot, std::uint64_t seed) : random_(seed) {
    for (const auto& info : snapshot.objects) {
      if (!info) continue;
      MenuObject candidate;
      candidate.id = info->id;
      candidate.part_count = part_count_of(snapshot, info->id);
      if (candidate.part_count == 0 || candidate.part_count > kMostParts) continue;
      for (const ConvexPart& part : parts_of_object(snapshot, info->id)) candidate.bounds.extend(bounds_of_part(part));
      candidate.is_mesh = candidate.part_count > info->primitives.size();
      if (!candidate.bounds.low.allFinite() || !candidate.bounds.high.allFinite())
        continue;  // half-spaces: no place of their own
      candidates_.push_back(candidate);
    }
  }
  bool has_pairs() const { return candidates_.size() > 1; }
  std::pair<const MenuObject*, const MenuObject*> next() {
    const MenuObject& a = candidates_[random_() % candidates_.size()];
    const MenuObject* b = &a;
    while (b == &a) b = &candidates_[random_() % candidates_.size()];
    return {&a, random_() % 2 == 0 ? b : &nearest_to(a)};
  }

 private:
  const MenuObject& nearest_to(const MenuObject& a) const {
    const MenuObject* nearest = nullptr;
    double least = std::numeric_limits<double>::infinity();
    for (const MenuObject& b : candidates_) {
      const double gap_m = gap_between(a.bounds, b.bounds);
      if (&b == &a || gap_m >= least) continue;
      least = gap_m;
      nearest = &b;
    }
    return nearest != nullptr ? *nearest : candidates_[&a == &candidates_[0] ? 1 : 0];
  }

  std::mt19937_64 random_;
  std::vector<MenuObject> candidates_;
};

/// Pairs of one kind, reported by every method.
class PairQuestions {
 public:
  PairQuestions(const Snapshot& snapshot, const std::string& asked_of, const MenuOptions& options)
      : snapshot_(snapshot),
        table_(asked_of, {{.name = "exact on doubt"},
                          {.name = "double, bounded", .highest = Level::filter},
                          {.name = "boxes only", .boxes = true}}),
        judging_(options.judging_ns),
        fcl_(options.opinion_ns),
        is_fcl_asked_(options.opinion_ns > 0),
        cancelled_(options.cancelled) {}

  std::uint32_t asked() { return table_.row(0).asked; }
  void ask(const MenuObject& a, const MenuObject& b) {
    for (std::size_t m = 0; m < kMethods; ++m) {
      const MenuMethod& method = table_.methods()[m];
      const PrecisionScope precision({.highest = method.highest});
      if (method.boxes) table_.timed(m, [&] { box_gap_m_ = gap_between(a.bounds, b.bounds); });
      else table_.timed(m, [&] { given_[m] = report_pair(snapshot_, a.id, b.id, {}); });
      if (!method.boxes && given_[m].touches == Decision::undecided) ++table_.row(m).undecided;
    }
    if (judging_.is_left() && a.part_count * b.part_count <= kMostJudgedPairs) judging_.spend([&] { judge(a, b); });
    if (is_fcl_asked_ && fcl_.is_left()) {
      fcl_.spend(
          [&] { count(fcl_opinion(snapshot_, a.id, b.id, given_[0], cancelled_).verdict, table_.row(0).opinion); });
    }
  }
  void finish(std::vector<MenuRow>& menu) { table_.finish(menu); }

 private:
  static constexpr std::size_t kMethods = 3;

  void judge(const MenuObject& a, const MenuObject& b) {
    const ExactPair exact(parts_with_bounds(snapshot_, a.id), parts_with_bounds(snapshot_, b.id));
    for (std::size_t m = 0; m < kMethods; ++m) {
      MenuRow& row = table_.row(m);
      ++row.judged;
      if (exact.touches == Decision::undecided) continue;
      if (table_.methods()[m].boxes) judge_boxes(exact, row);
      else judge_report(exact, given_[m], row);
    }
  }
  static void judge_report(const ExactPair& exact, const PairReport& given, MenuRow& row) {
    if (given.touches == Decision::undecided) return;
    if (given.touches != exact.touches) {
      ++row.wrong;
      return;
    }
    const bool is_apart = given.touches == Decision::no;
    row.worst_bound_m = std::max(row.worst_bound_m, is_apart ? given.separation.error_m : given.contact.depth_error_m);
    if (!is_apart) return;
    const Separation& told = given.separation;
    if (!may_be_equal(Interval(told.distance_m, told.error_m), Interval(exact.distance_m, exact.error_m))) ++row.wrong;
    else row.worst_error_m = std::max(row.worst_error_m, std::abs(told.distance_m - exact.distance_m));
  }
  void judge_boxes(const ExactPair& exact, MenuRow& row) const {
    row.worst_bound_m = std::numeric_limits<double>::infinity();
    if ((box_gap_m_ == 0) != (exact.touches == Decision::yes)) ++row.wrong;
    else if (exact.touches == Decision::no)
      row.worst_error_m = std::max(row.worst_error_m, std::abs(box_gap_m_ - exact.distance_m));
  }

  const Snapshot& snapshot_;
  MenuTable table_;
  JudgingTime judging_;
  JudgingTime fcl_;
  bool is_fcl_asked_;
  const std::function<bool()>& cancelled_;
  std::array<PairReport, kMethods> given_;
  double box_gap_m_ = 0;
};

}  // namespace

void add_pair_rows(const Snapshot& snapshot, const MenuOptions& options, std::vector<MenuRow>& menu) {
  RandomPairs random(snapshot, options.seed);
  if (!random.has_pairs()) return;
  PairQuestions pairs(snapshot, "pair", options);
  PairQuestions mesh_pairs(snapshot, "mesh pair", options);
  const auto end = std::chrono::steady_clock::now() + kAskingTime;
  const auto is_over = [&] {
    return std::chrono::steady_clock::now() > end || (options.cancelled && options.cancelled());
  };
  // A world may have pairs of one kind only.
  for (std::uint64_t i = 0; i < 4 * std::uint64_t{options.questions} && !is_over(); ++i) {
    const auto [a, b] = random.next();
    PairQuestions& kind = a->is_mesh || b->is_mesh ? mesh_pairs : pairs;
    if (kind.asked() < options.questions) kind.ask(*a, *b);
  }
  pairs.finish(menu);
  mesh_pairs.finish(menu);
}

}  // namespace collided::engine
