#include "server/world/query/query.hpp"

#include <string_view>

#include "idl/question_rules.hpp"
#include "server/exact_phase/arithmetic/precision.hpp"
#include "server/geometry/float_environment.hpp"
#include "server/world/query/plain_rays.hpp"
#include "server/world/query/question_batch.hpp"
#include "server/world/query/stale_reach.hpp"

namespace collided::engine {

namespace {

/// Most patterns are empty, and then no call is needed.
inline bool is_same_pattern(std::string_view a, std::string_view b) {
  return a.size() == b.size() && (a.empty() || a == b);
}

/// True if the filter is that of the questions, for the snapshot.
inline bool is_filter_taken(const AnswerFilter& filter, const Snapshot& snapshot, const Questions& asked) {
  return filter.table_version == snapshot.objects.version() && filter.mask == asked.mask &&
         is_same_pattern(filter.only, asked.only) && is_same_pattern(filter.skip, asked.skip);
}

/// A function of its own, since most questions have the same filter as those before.
[[gnu::noinline]] void take_filter(const Snapshot& snapshot, const Questions& asked, QueryScratch& scratch) {
  scratch.filters.take(snapshot, asked);
}

/// Set-up of a call of `answer` before its first question, undone at the end.
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

/// Answers any questions but a single plain ray, which would carry needless state.
[[gnu::noinline]] void answer_any(const Snapshot& snapshot, const Questions& asked, Answers& answers,
                                  QueryScratch& scratch) {
  const std::uint32_t stride = numbers_of(asked.kind);
  const std::size_t count = stride == 0 ? 0 : asked.numbers.size() / stride;
  answers.reset(count);
  if (count == 0) return;
  const AnswerScope scope(snapshot, asked, scratch);
  const QuestionBatch batch(snapshot, asked, scratch, answers);
  answers.cut(batch.answer_all(count));
  if (!snapshot.stale_objects.empty()) doubt_where_stale_objects_reach(snapshot, asked, answers);
}

/// False: the ray is not plain, and its answer is not written.
bool answer_plain_ray_alone(const Snapshot& snapshot, const Questions& asked, Answers& answers, QueryScratch& scratch) {
  answers.reset(1);
  const AnswerScope scope(snapshot, asked, scratch);
  if (!are_plain_rays(snapshot, asked, scratch.filter()) || scratch.plain_rays.empty()) return false;
  PlainRay& ray = scratch.plain_rays.front();
  const std::vector<std::uint8_t>& allowed = scratch.filter().allowed.by_slot();
  const PlainOutcome outcome = answer_plain_ray(snapshot, asked, asked.numbers.data(), allowed, ray, 0, answers);
  if (outcome == PlainOutcome::not_plain) return false;
  if (outcome == PlainOutcome::reaches_movers) {
    const QuestionBatch batch(snapshot, asked, scratch, answers);
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
