#include <fmt/format.h>

#include <chrono>
#include <cstring>
#include <thread>

#include "idl/described_json.hpp"
#include "server/service/commands/measuring_commands.hpp"
#include "server/service/questions/validation.hpp"
#include "server/world/audit/menu.hpp"

namespace collided::engine::service {

using nlohmann::json;
namespace names = wire_contract::command;

json MeasuringCommands::audit() const {
  const AuditCounts counts = with_.audit.counts();
  Audit audit{.every = with_.audit.every(),
              .chosen = counts.chosen,
              .audited = counts.audited,
              .differing = counts.differing,
              .skipped = counts.skipped,
              .float_repairs = with_.counts.float_repairs.load(),
              .questions = {},
              .differences = with_.audit.differences(),
              .opinion = {}};
  for (const QuestionKind kind : kPlainQuestions) {
    const auto& levels = with_.counts.levels[static_cast<std::size_t>(kind)];
    audit.questions.push_back({.kind = std::string(name_of(kind)),
                               .in_double = levels[0].load(),
                               .expansion = levels[1].load(),
                               .rational = levels[2].load()});
  }
  if (with_.audit.asks_fcl()) audit.opinion = counts.opinion;
  return json_of(audit);
}

namespace {

/// The questions that came with the command; BadCommand names the first invalid one.
std::vector<double> own_questions(QuestionKind kind, const std::vector<std::byte>& bytes) {
  const std::size_t stride = numbers_of(kind);
  const std::size_t question_bytes = stride * sizeof(double);
  if (bytes.empty() || bytes.size() % question_bytes != 0) {
    throw BadCommand(fmt::format("menu: {} bytes of questions; {} are needed for each {}", bytes.size(), question_bytes,
                                 name_of(kind)));
  }
  const std::size_t count = bytes.size() / question_bytes;
  if (count > names::kMostMenuQuestions) {
    throw BadCommand(
        fmt::format("menu: {} questions, allowed {}; nothing was asked", count, names::kMostMenuQuestions));
  }
  std::vector<double> numbers(count * stride);
  std::memcpy(numbers.data(), bytes.data(), bytes.size());
  for (std::size_t i = 0; i < count; ++i) {
    if (is_question(kind, &numbers[i * stride])) continue;
    throw BadCommand(
        fmt::format("menu: question {} is no {}: a number that is not finite, a negative size, no direction or no "
                    "rotation; nothing was asked",
                    i, name_of(kind)));
  }
  return numbers;
}

QuestionKind kind_of(const std::string& name) {
  for (const QuestionKind kind : kPlainQuestions) {
    if (name == name_of(kind)) return kind;
  }
  throw BadCommand(fmt::format("menu: 'of' is {}; allowed: ray, sphere, box, near", printable(name)));
}

MenuOptions menu_options(const Arguments& arguments, const std::vector<std::byte>& bytes) {
  MenuOptions options;
  options.questions = arguments.whole_32("questions");
  options.seed = arguments.whole("seed");
  const std::string opinion = arguments.text("opinion");
  if (!opinion.empty() && opinion != "fcl")
    throw BadCommand(fmt::format("menu: 'opinion' is {}; allowed: fcl", printable(opinion)));
  constexpr std::int64_t kOpinionTime_ns = 5'000'000'000;
  if (!opinion.empty()) options.opinion_ns = kOpinionTime_ns;
  if (!arguments.has("of")) return options;
  options.own_kind = kind_of(arguments.text("of"));
  options.own_numbers = own_questions(options.own_kind, bytes);
  return options;
}

}  // namespace

std::unique_ptr<CommandFamily> measuring_commands(CommandContext& context) {
  return std::make_unique<MeasuringCommands>(context);
}

std::vector<BoundCommand> MeasuringCommands::commands() {
  return {handed_on(names::kPair, this, &MeasuringCommands::pair_later),
          handed_on(names::kClearance, this, &MeasuringCommands::clearance_later),
          handed_on(names::kExplain, this, &MeasuringCommands::explain_later),
          handed_on(names::kMenu, this, &MeasuringCommands::menu_later),
          on_asking_thread(names::kAudit, this, &MeasuringCommands::audit)};
}

/// A job that ends at its deadline, or when its client goes.
std::shared_ptr<MeasuringCommands::AwaitedJob> MeasuringCommands::await(CommandAsk ask, const Arguments& arguments) {
  const auto job = std::make_shared<AwaitedJob>();
  job->ask = std::move(ask);
  const auto within_ns = static_cast<std::int64_t>(arguments.whole("deadline_ns"));
  job->deadline_ns = within_ns > 0 ? steady_ns() + within_ns : 0;
  const std::lock_guard lock(awaited_mutex_);
  awaited_.push_back(job);
  return job;
}

/// Whether a client still waits for this job. While the server stops, each client is refused with that reason.
bool MeasuringCommands::is_wanted(const AwaitedJob& job) const {
  return threads_.are_stopping() || !job.called_off.load();
}

/// The result of the work; throws BadCommand if the server stops before it is complete.
json MeasuringCommands::finished(const AwaitedJob& job, const std::function<json()>& work) const {
  json answer = work();
  if (threads_.are_stopping() && job.called_off.load()) throw BadCommand("the server is stopping");
  return answer;
}

void MeasuringCommands::stop() {
  constexpr std::int64_t kPatienceNs = 1'000'000'000;
  const std::int64_t until_ns = steady_ns() + kPatienceNs;
  const auto is_done = [this] {
    const std::lock_guard lock(awaited_mutex_);
    std::erase_if(awaited_, [](const std::weak_ptr<AwaitedJob>& job) { return job.expired(); });
    return awaited_.empty();
  };
  while (!is_done() && steady_ns() < until_ns) std::this_thread::sleep_for(std::chrono::milliseconds(2));
  const std::lock_guard lock(awaited_mutex_);
  for (const std::weak_ptr<AwaitedJob>& awaited : awaited_) {
    if (const std::shared_ptr<AwaitedJob> job = awaited.lock()) job->called_off.store(true);
  }
}

void MeasuringCommands::look_for_gone() {
  const std::lock_guard lock(awaited_mutex_);
  std::erase_if(awaited_, [&](const std::weak_ptr<AwaitedJob>& awaited) {
    const std::shared_ptr<AwaitedJob> job = awaited.lock();
    if (job && !answers_.answering().knows(job->ask.client)) job->called_off.store(true);
    return !job || job->called_off.load();
  });
}

/// The state at the named instant; null for the latest. Throws BadCommand.
std::shared_ptr<const Snapshot> MeasuringCommands::past_state(const Arguments& arguments,
                                                              const Snapshot& newest) const {
  const std::string text = arguments.text("as_of");
  const std::optional<wire_contract::AskedInstant> instant = wire_contract::asked_instant(text);
  if (!instant) throw BadCommand(fmt::format("{}: as_of {} is no instant", arguments.command(), printable(text)));
  if (instant->kind == wire_contract::AskedInstant::Kind::latest) return nullptr;
  auto past = answers_.answering().past_states().at(*instant, newest);
  if (const auto* why_not = std::get_if<std::string>(&past)) throw BadCommand(arguments.command() + ": " + *why_not);
  return std::get<std::shared_ptr<const Snapshot>>(std::move(past));
}

void MeasuringCommands::menu_later(CommandAsk ask, const Arguments& arguments) {
  MenuOptions options = menu_options(arguments, ask.blob);
  threads_.require_room("menu");
  const auto job = await(std::move(ask), arguments);
  options.cancelled = [this, job] { return threads_.are_stopping() || job->is_over(); };
  const bool is_taken = threads_.push_slow([this, job, options = std::move(options)] {
    if (!job->called_off.load()) answers_.answer(job->ask, [&] { return menu(options, *job); });
  });
  if (!is_taken) answers_.refuse(job->ask, CommandThreads::kNoThread);
}

/// What is found by the deadline, and whether that is all.
json MeasuringCommands::menu(const MenuOptions& options, const AwaitedJob& job) const {
  const SnapshotRing::Lease state = with_.loop.world().newest();
  Menu answer{.rows = menu_of(*state, options), .seed = options.seed, .version = state->version};
  answer.late = job.is_over();
  return json_of(answer);
}

}  // namespace collided::engine::service
