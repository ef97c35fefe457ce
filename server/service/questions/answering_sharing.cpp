#include <algorithm>
#include <utility>

#include "idl/columns.hpp"
#include "server/service/questions/answering.hpp"
#include "server/service/runtime/clock.hpp"

// Spreads the questions of one chunk over the idle threads.
namespace collided::engine::service {

using wire_contract::QuestionKind;

namespace {

/// Twice as many as there are threads, since questions differ in cost: the thread that is done first takes another
/// part.
constexpr std::size_t kPartsAThread = 2;
/// A moving shape is copied into every part.
constexpr std::uint32_t kMostSharedBytes = 65'536;

bool may_be_shared(const wire::Query& query) {
  const auto kind = static_cast<QuestionKind>(query.kind);
  const bool is_question = kind != QuestionKind::what_if && !wire::question_columns(kind).empty();
  return is_question && query.blob._length <= kMostSharedBytes;
}

}  // namespace

/// Into how many parts an ask with this many questions left is worth splitting; 1: it stays whole.
std::uint32_t Answering::parts_of(const Ask& ask, std::uint32_t left) {
  const std::size_t threads = 1 + (ask.is_costly ? costly_.idle() : queue_.idle());
  if (ask.is_costly) return static_cast<std::uint32_t>(std::min<std::size_t>(threads, left));
  const double cost = cost_of(*ask.query) * left / std::max(1U, wire::question_count(*ask.query).value_or(1));
  const double worth = cost * ns_per_cost_.load(std::memory_order_relaxed) / kLeastPartNs;
  const std::size_t most = std::min<std::size_t>(kPartsAThread * threads, left / kPartQuestions);
  return static_cast<std::uint32_t>(std::clamp(worth, 1.0, static_cast<double>(std::max<std::size_t>(1, most))));
}

/// Splits questions off the end of an ask for idle threads, which take one part after the other, as from one list. Each
/// part is answered on the same state and has replies of its own, so the answers do not depend on the number of
/// threads.
///
/// source  self-scheduling: Tang, Yew, "Processor self-scheduling for multiple-nested parallel loops", 1986
void Answering::share(Ask& ask) {
  const bool is_any_idle = ask.is_costly ? costly_.idle() > 0 && costly_.waiting() == 0
                                         : queue_.idle() > 0 && queue_.waiting() == 0 && !queue_.has_own();
  if (!is_any_idle || stopping_.load() || !ask.refusal.empty() || !may_be_shared(*ask.query)) return;
  const std::uint32_t count = wire::question_count(*ask.query).value_or(0);
  if (count <= ask.answered + 1) return;
  const auto left = static_cast<std::uint32_t>(count - ask.answered);
  std::uint32_t parts = parts_of(ask, left);
  if (parts < 2 || why_refused(*ask.query)) return;
  // The state of a past instant is looked up in the first turn.
  if (ask.query->instant != 0 && !ask.past) return;
  if (!ask.past && !ask.hold && !with_.leases.keep(ask, with_.world.newest(), steady_ns())) return;
  const std::uint32_t group = ask.is_costly ? 1 : kPartQuestions;
  const std::uint32_t share = (left / parts + group - 1) / group * group;
  for (std::uint32_t rest = (left - 1) / share * share; rest > 0; rest -= share)
    push_part(ask, static_cast<std::uint32_t>(ask.answered) + rest);
}

/// Passes the questions from number `first` on to another thread. They belong to the client's current turn, so nothing
/// more is counted for it.
void Answering::push_part(Ask& ask, std::uint32_t first) {
  AskPointer part = pool_.get();
  wire::split_questions(*ask.query, first, *part->query);
  part->taken_ns = ask.taken_ns;
  part->from = ask.from;
  part->owner = ask.owner;
  part->passed_barrier = ask.passed_barrier;
  part->past = ask.past;
  part->is_costly = ask.is_costly;
  part->is_part = true;
  if (ask.hold) part->hold = with_.leases.share(ask.hold);
  Share share = share_of(*part);
  share.cost = 1;
  share.is_begun = true;  // so that it is accepted
  if (part->is_costly) return static_cast<void>(costly_.push(share, part));
  Work work(std::move(part));
  static_cast<void>(queue_.push(share, work));
}

}  // namespace collided::engine::service
