#include "server/world/query/query.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <optional>
#include <string_view>

#include "idl/clocks.hpp"
#include "idl/question_rules.hpp"
#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/geometry/tolerance.hpp"
#include "server/world/query/covered.hpp"
#include "server/world/query/plain_rays.hpp"
#include "server/world/query/question.hpp"
#include "server/world/query/stale_reach.hpp"
#include "server/world/query/unknown_space.hpp"

namespace collided::engine {

const char* name_of(QuestionKind kind) {
  switch (kind) {
    case QuestionKind::ray: return "ray";
    case QuestionKind::sphere: return "sphere";
    case QuestionKind::box: return "box";
    case QuestionKind::near: return "near";
    case QuestionKind::sweep: return "sweep";
    case QuestionKind::inside: return "inside";
    case QuestionKind::what_if: return "what-if";
  }
  return "";
}

namespace {

/// Most patterns are empty, and then no call is needed.
inline bool is_same_pattern(std::string_view a, std::string_view b) {
  return a.size() == b.size() && (a.empty() || a == b);
}

/// Whether the filter is the questions', as of the snapshot.
inline bool is_filter_taken(const AnswerFilter& filter, const Snapshot& snapshot, const Questions& asked) {
  return filter.table_version == snapshot.objects.version() && filter.mask == asked.mask &&
         is_same_pattern(filter.only, asked.only) && is_same_pattern(filter.skip, asked.skip);
}

/// Apart, since most questions have the filter of those before.
[[gnu::noinline]] void take_filter(const Snapshot& snapshot, const Questions& asked, QueryScratch& scratch) {
  scratch.filters.take(snapshot, asked);
}

void ask(Question& question, const double* numbers) {
  switch (question.asked.kind) {
    case QuestionKind::ray: return ask_ray(question, numbers);
    case QuestionKind::sphere: return ask_sphere(question, numbers);
    case QuestionKind::box: return ask_box(question, numbers);
    case QuestionKind::near: return ask_near(question, numbers);
    case QuestionKind::sweep: return ask_sweep(question, numbers);
    case QuestionKind::inside: return ask_inside(question, numbers);
    default: return;
  }
}

void write_plain(Answers& answers, std::size_t place, Verdict answer, UndecidedReason reason) {
  answers.answers[place] = answer;
  answers.reasons[place] = reason;
  answers.levels[place] = 0;
  answers.hit_counts[place] = 0;
  answers.nodes[place] = 0;
  answers.exact_tests[place] = 0;
}

/// The search ended at its deadline, and what it found does not answer alone.
bool is_cut_short(const Question& question) {
  if (!question.deadline.was_over()) return false;
  const QuestionKind kind = question.asked.kind;
  const bool one_is_enough =
      question.asked.mode == HitMode::any && kind != QuestionKind::near && kind != QuestionKind::sweep;
  return !one_is_enough || question.found.empty();
}

/// A miss needs every test to have said no. In mode `any` one certain hit is enough; in other modes a single undecided
/// test leaves the whole answer undecided.
void write_answer(Answers& answers, std::size_t place, Question& question) {
  const bool is_late = is_cut_short(question);
  if (is_late) {
    // What was found so far need not be the nearest or the deepest: its bounds would be wrong.
    question.found.clear();
    question.bracket.reset();
  }
  UndecidedReason reason = UndecidedReason::none;
  Verdict answer = question.found.empty() ? Verdict::miss : Verdict::hit;
  const bool one_is_enough = question.asked.mode == HitMode::any;
  if (is_late) {
    reason = UndecidedReason::deadline;
  } else if (question.undecided && (answer == Verdict::miss || !one_is_enough)) {
    reason = UndecidedReason::numeric;
  } else if (question.truncated) {
    reason = UndecidedReason::truncated;
  }
  if (reason != UndecidedReason::none) answer = Verdict::undecided;
  answers.answers[place] = answer;
  answers.reasons[place] = reason;
  answers.levels[place] = static_cast<std::uint8_t>(question.level);
  answers.hit_counts[place] = question.asked.with_hits ? static_cast<std::uint32_t>(question.found.size()) : 0;
  answers.nodes[place] = question.walk.nodes;
  answers.exact_tests[place] = question.exact_tests;
  if (question.bracket) answers.brackets.push_back(*question.bracket);
  if (&question.found == &answers.hits || !question.asked.with_hits) return;
  for (const AnswerHit& hit : question.found) answers.hits.push_back(hit);
}

/// Turns a miss or a hit into undecided where it claims something about space that is not covered. The hits found stay
/// in the answer.
void doubt_where_not_covered(Answers& answers, std::size_t place, const Question& question, const double* numbers) {
  const bool is_claim = answers.answers[place] == Verdict::miss || answers.answers[place] == Verdict::hit;
  if (!is_claim) return;
  const std::optional<Leaving> leaving = leaves_covered(question, numbers);
  if (!leaving) return;
  answers.answers[place] = Verdict::undecided;
  answers.reasons[place] = UndecidedReason::not_covered;
  answers.not_covered.push_back({.question = static_cast<std::uint32_t>(place), .leaving = *leaving});
}

/// The same where it claims something about unknown space.
void doubt_where_unknown(Answers& answers, std::size_t place, Question& question, const double* numbers,
                         UnknownSpace& unknown) {
  const bool is_claim = answers.answers[place] == Verdict::miss || answers.answers[place] == Verdict::hit;
  if (!is_claim) return;
  const std::optional<Leaving> leaving = reaches_unknown(question, numbers, unknown);
  answers.nodes[place] = question.walk.nodes;
  answers.exact_tests[place] = question.exact_tests;
  if (!leaving) return;
  answers.answers[place] = Verdict::undecided;
  answers.reasons[place] = UndecidedReason::not_covered;
  // What is nearest to a box's middle the box need not reach. In another shard's box it would be taken for something that
  // that one answers for: a shard says such a doubt without a place.
  if (question.snapshot.is_shard && question.asked.kind == QuestionKind::box) return;
  answers.not_covered.push_back({.question = static_cast<std::uint32_t>(place), .leaving = *leaving});
}

/// Keeps the oldest pose among the hits.
void note_age(Answers& answers, const Question& question) {
  for (const AnswerHit& hit : question.found) {
    const std::int64_t posed_ns = question.snapshot.posed_ns[slot_of(hit.object)];
    if (posed_ns == 0) continue;
    answers.oldest_pose_ns = answers.oldest_pose_ns < 0 ? posed_ns : std::min(answers.oldest_pose_ns, posed_ns);
  }
}

[[gnu::noinline]] bool keeps_rules_one_by_one(const double* ray) {
  return wire_contract::keeps_rules<wire_contract::kRayFields>(ray);
}

/// The rules number by number cost more than a node of the tree. Magnitudes whose sum is within the limit are within it,
/// and a larger sum says nothing yet.
[[gnu::always_inline]] inline bool keeps_ray_rules(const double* numbers) {
  const double direction = std::abs(numbers[3]) + std::abs(numbers[4]) + std::abs(numbers[5]);
  const double sum = std::abs(numbers[0]) + std::abs(numbers[1]) + std::abs(numbers[2]) + direction;
  const bool is_usual = direction > 0 && sum <= wire_contract::kMostCoordinate && numbers[6] >= 0;
  return is_usual || keeps_rules_one_by_one(numbers);
}

/// The answer that needs no search: the numbers are invalid, or the deadline has passed.
std::optional<Verdict> answer_at_once(const Questions& asked, const double* numbers) {
  if (!is_question(asked.kind, numbers)) return Verdict::invalid;
  if (asked.kind == QuestionKind::sweep && asked.mover == nullptr) return Verdict::invalid;
  if (asked.deadline_ns != 0 && wire_contract::steady_ns() > asked.deadline_ns) return Verdict::undecided;
  return std::nullopt;
}

void write_at_once(Answers& answers, std::size_t place, Verdict answer) {
  write_plain(answers, place, answer, answer == Verdict::invalid ? UndecidedReason::none : UndecidedReason::deadline);
}

/// Says when a batch is to make room for others. Reads the clock about once in 10 us of work.
class Pause {
 public:
  explicit Pause(std::int64_t at_ns) : at_ns_(at_ns) {}

  /// To be called after some questions, from `first` on, were answered.
  bool is_due(const Answers& answers, std::size_t first, std::size_t count) {
    if (at_ns_ == 0) return false;
    for (std::size_t i = first; i < first + count; ++i) work_ += kQuestion + answers.nodes[i] + answers.exact_tests[i];
    if (work_ < kWorkAReading) return false;
    work_ = 0;
    return wire_contract::steady_ns() > at_ns_;
  }

 private:
  static constexpr std::uint64_t kQuestion = 32;  // in nodes
  static constexpr std::uint64_t kWorkAReading = 1'024;

  std::int64_t at_ns_ = 0;
  std::uint64_t work_ = 0;
};

/// Answers questions one after the other, or rays in groups.
struct QuestionBatch {
  const Snapshot& snapshot;
  const Questions& asked;
  QueryScratch& scratch;
  Answers& answers;
  std::uint32_t stride;

  const double* numbers_of(std::size_t place) const { return asked.numbers.data() + place * stride; }
  void finish(Question& question, std::size_t place) const {
    write_answer(answers, place, question);
    note_age(answers, question);
    if (snapshot.covers && !snapshot.is_shard) doubt_where_not_covered(answers, place, question, numbers_of(place));
    UnknownSpace* const unknown = scratch.filter().unknown.get();
    if (unknown != nullptr && unknown->is_any)
      doubt_where_unknown(answers, place, question, numbers_of(place), *unknown);
    if (!asked.with_hits) question.found.clear();
  }
  /// returns  false: it was given up, and has no answer
  bool answer_one(std::size_t place) const {
    if (const std::optional<Verdict> at_once = answer_at_once(asked, numbers_of(place))) {
      write_at_once(answers, place, *at_once);
      return true;
    }
    return answer_by(place, [&](Question& question) { ask(question, numbers_of(place)); });
  }
  /// A question alone finds its hits where they are wanted.
  ///
  /// returns  false: it was given up, and has no answer
  template <class Ask>
  bool answer_by(std::size_t place, const Ask& ask_question) const {
    const SearchTime time{
        .deadline_ns = asked.deadline_ns, .give_up_ns = asked.give_up_ns, .called_off = asked.called_off};
    Question question{.snapshot = snapshot,
                      .asked = asked,
                      .allowed = scratch.filter().allowed.by_slot(),
                      .open_scenes = scratch.filter().open_scenes,
                      .found = asked.numbers.size() == stride ? answers.hits : scratch.found,
                      .deadline = time.end()};
    ask_question(question);
    if (is_cut_short(question) && time.is_given_up()) {
      question.found.clear();
      return false;
    }
    finish(question, place);
    return true;
  }
  void answer_rays(std::size_t place, std::size_t count) const;
  bool answer_plain_ray(std::size_t place) const {
    const double* numbers = numbers_of(place);
    if (!keeps_ray_rules(numbers)) return answer_one(place);
    PlainRay& ray = scratch.plain_rays.front();
    switch (
        engine::answer_plain_ray(snapshot, asked, numbers, scratch.filter().allowed.by_slot(), ray, place, answers)) {
      case PlainOutcome::not_plain: return answer_one(place);
      case PlainOutcome::answered: return true;
      case PlainOutcome::reaches_movers: return answer_with_movers(place, ray);
    }
    return false;
  }
  /// After the walk through the scenes.
  bool finish_plain_ray(std::size_t place, PlainRay& ray) const {
    if (reaches_movers(snapshot, scratch.filter().allowed.by_slot(), ray)) return answer_with_movers(place, ray);
    write_plain_ray(snapshot, asked, ray, place, answers);
    return true;
  }
  [[gnu::noinline]] bool answer_with_movers(std::size_t place, const PlainRay& ray) const {
    return answer_by(place, [&](Question& question) { ask_ray_of_movers(question, numbers_of(place), ray); });
  }
  // These three return how many were answered before the pause, or before one was given up.
  std::size_t answer_plain_rays(std::size_t first, std::size_t count, std::span<Bvh::RayTask> tasks) const;
  std::size_t answer_all_plain(std::size_t count, bool together) const;
  std::size_t answer_all(std::size_t count, bool together) const {
    const std::size_t step = together ? kRaysAtOnce : 1;
    Pause pause(asked.pause_ns);
    for (std::size_t i = 0; i < count; i += step) {
      const std::size_t size = std::min(step, count - i);
      if (together) answer_rays(i, size);
      else if (!answer_one(i)) return i;
      if (pause.is_due(answers, i, size)) return i + size;
    }
    return count;
  }
};

std::size_t QuestionBatch::answer_plain_rays(std::size_t first, std::size_t count,
                                             std::span<Bvh::RayTask> tasks) const {
  std::vector<PlainRay>& memory = scratch.plain_rays;
  std::array<PlainRay*, kPlainRaysAtOnce> walks;
  std::array<bool, kPlainRaysAtOnce> is_plain;
  std::size_t size = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double* numbers = numbers_of(first + i);
    is_plain[i] = keeps_ray_rules(numbers) && start_plain_ray(numbers, memory[i]);
    if (is_plain[i]) walks[size++] = &memory[i];
  }
  walk_plain_rays(snapshot, asked, std::span(walks).first(size), tasks);
  const bool has_movers = snapshot.grid && snapshot.grid->size() > 0;
  for (std::size_t i = 0; i < count; ++i) {
    if (is_plain[i] && !has_movers) {
      write_plain_ray(snapshot, asked, memory[i], first + i, answers);
      continue;
    }
    const bool is_answered = is_plain[i] ? finish_plain_ray(first + i, memory[i]) : answer_one(first + i);
    if (!is_answered) return i;
  }
  return count;
}

void QuestionBatch::answer_rays(std::size_t first, std::size_t count) const {
  std::array<std::optional<Question>, kRaysAtOnce> group;
  std::array<std::size_t, kRaysAtOnce> places;
  std::array<const double*, kRaysAtOnce> numbers;
  scratch.found_by_ray.resize(kRaysAtOnce);
  std::size_t size = 0;
  for (std::size_t place = first; place < first + count; ++place) {
    numbers[size] = numbers_of(place);
    if (const std::optional<Verdict> at_once = answer_at_once(asked, numbers[size])) {
      write_at_once(answers, place, *at_once);
      continue;
    }
    group[size].emplace(Question{.snapshot = snapshot,
                                 .asked = asked,
                                 .allowed = scratch.filter().allowed.by_slot(),
                                 .open_scenes = scratch.filter().open_scenes,
                                 .found = scratch.found_by_ray[size],
                                 .deadline = Deadline(asked.deadline_ns, asked.called_off)});
    places[size++] = place;
  }
  if (size == 0) return;
  ask_rays(std::span(group).first(size), std::span<const double* const>(numbers).first(size));
  for (std::size_t i = 0; i < size; ++i) finish(*group[i], places[i]);
}

std::size_t QuestionBatch::answer_all_plain(std::size_t count, bool together) const {
  Pause pause(asked.pause_ns);
  if (!together) {
    for (std::size_t i = 0; i < count; ++i) {
      if (!answer_plain_ray(i)) return i;
      if (pause.is_due(answers, i, 1)) return i + 1;
    }
    return count;
  }
  std::array<Bvh::RayTask, kPlainRaysAtOnce> tasks;
  for (std::size_t i = 0; i < count; i += tasks.size()) {
    const std::size_t size = std::min(tasks.size(), count - i);
    if (const std::size_t answered = answer_plain_rays(i, size, tasks); answered < size) return i + answered;
    if (pause.is_due(answers, i, size)) return i + size;
  }
  return count;
}

/// Rays in unrelated directions through a tree larger than the caches mostly wait for memory: walked in turn, one uses
/// the time that another waits. Rays like a camera's visit the same nodes, and gain by visiting them together where no
/// candidate needs to be filtered; otherwise each profits from what the last one left in the cache, and is faster
/// alone.
///
/// asked  at least kFewestTogether rays
constexpr std::size_t kFewestTogether = 16;
bool rays_gain_together(const Snapshot& snapshot, const Questions& asked, const QueryScratch& scratch) {
  constexpr std::uint64_t kCacheBytes = 4 << 20;
  constexpr std::size_t stride = kRayNumbers;
  if (asked.mode == HitMode::all) return false;
  std::size_t alike = 0;
  for (std::size_t i = 1; i < kFewestTogether; ++i) {
    const double* a = asked.numbers.data() + (i - 1) * stride;
    const double* b = a + stride;
    const bool same_start = a[0] == b[0] && a[1] == b[1] && a[2] == b[2];
    const double along = a[3] * b[3] + a[4] * b[4] + a[5] * b[5];
    const double squares = (a[3] * a[3] + a[4] * a[4] + a[5] * a[5]) * (b[3] * b[3] + b[4] * b[4] + b[5] * b[5]);
    const bool same_direction = along > 0 && along * along > 0.99 * squares;
    alike += same_start && same_direction ? 1 : 0;
  }
  if (alike >= kFewestTogether / 2) {
    return !snapshot.scenes.empty() && scratch.filter().all_open && asked.error_m == 0 &&
           asked.highest == Level::rational;
  }
  std::uint64_t bytes = 0;
  for (const auto& scene : snapshot.scenes) bytes += scene->tree.report().bytes;
  return bytes >= kCacheBytes;
}

void answer_batch(const QuestionBatch& batch, std::size_t count) {
  const bool together = batch.asked.kind == QuestionKind::ray && count >= kFewestTogether &&
                        rays_gain_together(batch.snapshot, batch.asked, batch.scratch);
  if (!are_plain_rays(batch.snapshot, batch.asked, batch.scratch.filter())) {
    batch.answers.cut(batch.answer_all(count, together));
    return;
  }
  if (batch.scratch.plain_rays.empty()) batch.scratch.plain_rays.resize(kPlainRaysAtOnce);
  batch.answers.cut(batch.answer_all_plain(count, together));
}

/// What a call of `answer` sets up before its first question, and puts back.
class AnswerScope {
 public:
  AnswerScope(const Snapshot& snapshot, const Questions& asked, QueryScratch& scratch)
      : precision_({.highest = asked.highest, .error_asked_m = asked.error_m / 2}) {
    if (!is_filter_taken(scratch.filter(), snapshot, asked)) take_filter(snapshot, asked, scratch);
  }

 private:
  OwnFloatEnvironment own_floats_;
  PrecisionScope precision_;
};

/// Any questions but a plain ray alone, which would carry what is needed here.
[[gnu::noinline]] void answer_any(const Snapshot& snapshot, const Questions& asked, Answers& answers,
                                  QueryScratch& scratch) {
  const std::uint32_t stride = numbers_of(asked.kind);
  const std::size_t count = stride == 0 ? 0 : asked.numbers.size() / stride;
  answers.reset(count);
  if (count == 0) return;
  const AnswerScope scope(snapshot, asked, scratch);
  answer_batch({snapshot, asked, scratch, answers, stride}, count);
  if (!snapshot.stale_objects.empty()) doubt_where_stale_objects_reach(snapshot, asked, answers);
}

/// False: it is not plain, and its answer is not written.
bool answer_plain_ray_alone(const Snapshot& snapshot, const Questions& asked, Answers& answers, QueryScratch& scratch) {
  answers.reset(1);
  const AnswerScope scope(snapshot, asked, scratch);
  if (!are_plain_rays(snapshot, asked, scratch.filter()) || scratch.plain_rays.empty()) return false;
  const double* numbers = asked.numbers.data();
  if (!keeps_ray_rules(numbers)) return false;
  PlainRay& ray = scratch.plain_rays.front();
  const PlainOutcome outcome =
      answer_plain_ray(snapshot, asked, numbers, scratch.filter().allowed.by_slot(), ray, 0, answers);
  if (outcome == PlainOutcome::not_plain) return false;
  if (outcome == PlainOutcome::reaches_movers) {
    const QuestionBatch batch{snapshot, asked, scratch, answers, kRayNumbers};
    if (!batch.answer_with_movers(0, ray)) answers.cut(0);
  }
  if (!snapshot.stale_objects.empty()) doubt_where_stale_objects_reach(snapshot, asked, answers);
  return true;
}

}  // namespace

bool is_question(QuestionKind kind, const double* numbers) {
  using namespace wire_contract;
  switch (kind) {
    case QuestionKind::ray: return keeps_rules<kRayFields>(numbers);
    case QuestionKind::sphere: return keeps_rules<kSphereFields>(numbers);
    case QuestionKind::box: return keeps_rules<kBoxFields>(numbers);
    case QuestionKind::near: return keeps_rules<kNearFields>(numbers);
    case QuestionKind::sweep: return keeps_rules<kSweepFields>(numbers);
    case QuestionKind::inside: return keeps_rules<kInsideFields>(numbers);
    default: return false;
  }
}

void Answers::cut(std::size_t count) {
  if (exact_tests.size() == count) return;
  for (auto* column : {&hit_counts, &nodes, &exact_tests}) column->resize(count);
  answers.resize(count);
  reasons.resize(count);
  levels.resize(count);
}

void answer(const Snapshot& snapshot, const Questions& questions, Answers& answers, QueryScratch& scratch) {
  const bool is_ray_alone = questions.kind == QuestionKind::ray && questions.numbers.size() == kRayNumbers;
  if (is_ray_alone && answer_plain_ray_alone(snapshot, questions, answers, scratch)) return;
  answer_any(snapshot, questions, answers, scratch);
}

}  // namespace collided::engine
