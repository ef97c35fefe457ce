#include "server/world/query/answer_writing.hpp"

#include <algorithm>

#include "idl/clocks.hpp"
#include "server/world/query/covered.hpp"
#include "server/world/query/unknown_space.hpp"

namespace collided::engine {
namespace {

/// A miss needs a no from every test. In mode `any` one certain hit is enough; in other modes a single undecided test
/// leaves the whole answer undecided.
void write_found(Answers& answers, std::size_t place, Question& question) {
  const bool is_late = is_cut_short(question);
  if (is_late) {
    // The findings so far need not contain the nearest or deepest: their bounds would be wrong.
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

/// Turns a miss or a hit into undecided if it depends on space that is not covered. The hits found stay in the answer.
void doubt_where_not_covered(Answers& answers, std::size_t place, const Question& question, const double* numbers) {
  const bool is_claim = answers.answers[place] == Verdict::miss || answers.answers[place] == Verdict::hit;
  if (!is_claim) return;
  const std::optional<Leaving> leaving = leaves_covered(question, numbers);
  if (!leaving) return;
  answers.answers[place] = Verdict::undecided;
  answers.reasons[place] = UndecidedReason::not_covered;
  answers.not_covered.push_back({.question = static_cast<std::uint32_t>(place), .leaving = *leaving});
}

/// Turns it into undecided if it depends on unknown space.
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
  // The point nearest to the box's centre need not be reached by the box. In another shard's box it would count as that
  // shard's responsibility, so a shard reports such a doubt without a place.
  if (question.snapshot.covers_without_places && question.asked.kind == QuestionKind::box) return;
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

}  // namespace

std::optional<Verdict> answer_at_once(const Questions& asked, const double* numbers) {
  if (!is_question(asked.kind, numbers)) return Verdict::invalid;
  if (asked.kind == QuestionKind::sweep && asked.mover == nullptr) return Verdict::invalid;
  if (asked.deadline_ns != 0 && wire_contract::steady_ns() > asked.deadline_ns) return Verdict::undecided;
  return std::nullopt;
}

void write_at_once(Answers& answers, std::size_t place, Verdict answer) {
  answers.answers[place] = answer;
  answers.reasons[place] = answer == Verdict::invalid ? UndecidedReason::none : UndecidedReason::deadline;
  answers.levels[place] = 0;
  answers.hit_counts[place] = 0;
  answers.nodes[place] = 0;
  answers.exact_tests[place] = 0;
}

bool is_cut_short(const Question& question) {
  if (!question.deadline.was_over()) return false;
  const QuestionKind kind = question.asked.kind;
  const bool one_is_enough =
      question.asked.mode == HitMode::any && kind != QuestionKind::near && kind != QuestionKind::sweep;
  return !one_is_enough || question.found.empty();
}

void write_answer(Question& question, const double* numbers, const AnswerFilter& filter, std::size_t place,
                  Answers& answers) {
  write_found(answers, place, question);
  note_age(answers, question);
  const Snapshot& snapshot = question.snapshot;
  if (snapshot.covers && !snapshot.covers_without_places) doubt_where_not_covered(answers, place, question, numbers);
  UnknownSpace* const unknown = filter.unknown.get();
  if (unknown != nullptr && unknown->is_any) doubt_where_unknown(answers, place, question, numbers, *unknown);
  if (!question.asked.with_hits) question.found.clear();
}

}  // namespace collided::engine
