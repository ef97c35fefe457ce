#include <fmt/format.h>

#include <cmath>

#include "server/service/commands/commands.hpp"
#include "server/world/query/menu.hpp"

namespace collided::engine::service {

using nlohmann::json;
using wire_contract::ReplyStatus;

namespace {

/// Infinity is no JSON number.
json number(double value) {
  return std::isfinite(value) ? json(value) : json("inf");
}

}  // namespace

json Commands::audit(const Arguments& arguments) const {
  arguments.allow_only({});
  const AuditCounts counts = audit_.counts();
  json questions = json::array();
  for (const wire_contract::QueryKind kind : wire_contract::kWorldQuestions) {
    const auto& levels = counts_.levels[static_cast<std::size_t>(kind)];
    questions.push_back({{"kind", wire_contract::name_of(kind)},
                         {"double", levels[0].load()},
                         {"expansion", levels[1].load()},
                         {"rational", levels[2].load()}});
  }
  return {{"every", audit_.every()},
          {"chosen", counts.chosen},
          {"audited", counts.audited},
          {"differing", counts.differing},
          {"skipped", counts.skipped},
          {"differences", audit_.differences()},
          {"questions", questions},
          {"float_repairs", counts_.float_repairs.load()}};
}

void Commands::make_room(const char* what, const WorkQueue<SlowJob>& jobs) const {
  if (!jobs.has_room()) throw BadCommand(fmt::format("{}: too many such commands wait already", what), "ask again");
}

void Commands::menu_later(CommandAsk ask, const Arguments& arguments) {
  std::uint32_t questions = 0;
  std::uint64_t seed = 0;
  try {
    arguments.allow_only({"questions", "seed"});
    questions = static_cast<std::uint32_t>(arguments.whole("questions", 1'000, 100'000));
    seed = arguments.whole("seed", 1, ~std::uint64_t{0});
    make_room("menu", slow_jobs_);
  } catch (const BadCommand& bad) {
    answering_->send_text(ask.client, ask.request, ReplyStatus::refused, refusal_text(bad.what(), bad.hint));
    return;
  }
  const auto shared = std::make_shared<CommandAsk>(std::move(ask));
  slow_jobs_.push([this, shared, questions, seed] { answer(*shared, [&] { return menu(questions, seed); }); });
}

json Commands::menu(std::uint32_t questions, std::uint64_t seed) const {
  const SnapshotRing::Lease state = loop_.world().newest();
  json rows = json::array();
  const auto cancelled = [this] { return stopping_.load(); };
  for (const MenuRow& row : menu_of(*state, {.questions = questions, .seed = seed, .cancelled = cancelled})) {
    rows.push_back({{"kind", row.asked_of},
                    {"method", row.method},
                    {"asked", row.asked},
                    {"judged", row.judged},
                    {"undecided", row.undecided},
                    {"wrong", row.wrong},
                    {"worst_error", number(row.worst_error_m)},
                    {"worst_bound", number(row.worst_bound_m)},
                    {"p50_ns", row.p50_ns},
                    {"p99_ns", row.p99_ns}});
  }
  return {{"rows", rows}, {"seed", seed}, {"version", state->version}};
}

}  // namespace collided::engine::service
