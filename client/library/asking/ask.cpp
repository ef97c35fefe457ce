#include "client/library/asking/ask.hpp"

#include <algorithm>
#include <thread>
#include <utility>

#include "client/library/asking/answer_decoding.hpp"
#include "client/library/asking/question_request.hpp"
#include "client/library/asking/send_window.hpp"
#include "client/library/connection/errors.hpp"
#include "client/library/connection/route.hpp"
#include "client/library/publishing/shape_encoding.hpp"
#include "idl/columns.hpp"
#include "idl/instant.hpp"

namespace collided::client {
namespace {

using wire_contract::kMaxQuestionsPerChunk;
using wire_contract::kMaxQuestionsPerRequest;

// Answers to more questions than this take longer than waking up; the processor is better left to the server that
// computes them.
constexpr std::size_t kMostAtOnce = 16;

template <class Question>
auto encoder_of(std::span<const Question> questions) {
  return [questions](std::size_t first, std::size_t count, double* numbers) {
    for (const Question& question : questions.subspan(first, count)) {
      encode(question, numbers);
      numbers += QuestionWire<Question>::number_count;
    }
  };
}

std::optional<Error> options_fault(const QuestionRequest& request, const AskOptions& options) {
  const std::string noun = request.noun;
  if (options.only.size() > wire_contract::kMaxNameBytes || options.skip.size() > wire_contract::kMaxNameBytes) {
    return bad_input(noun + ": a name pattern has more than " + std::to_string(wire_contract::kMaxNameBytes) +
                     " bytes");
  }
  if (!(options.error_m >= 0)) {
    return bad_input(noun + ": error asked is " + words(options.error_m) + "; allowed 0 or more");
  }
  if (options.deadline.count() < 0 || options.timeout.count() <= 0) {
    return bad_input(noun + ": a time is negative, or the timeout 0");
  }
  if (options.as_of.time.count() < 0) {
    return bad_input(noun + ": the instant is " + std::to_string(options.as_of.time.count()) +
                     " ns; allowed 0 or more");
  }
  return std::nullopt;
}

// Sets all fields except the questions, since the sample may contain those of an earlier request.
void fill_header(wire::Query& query, const QuestionRequest& request, const AskOptions& options,
                 const WriteBarrier& barrier) {
  query.chunk_count =
      static_cast<std::uint32_t>((request.question_count + request.most_in_chunk - 1) / request.most_in_chunk);
  query.kind = static_cast<std::uint8_t>(request.kind);
  query.mode = static_cast<std::uint8_t>(options.mode);
  query.importance = static_cast<std::uint8_t>(options.importance);
  query.instant = static_cast<std::uint8_t>(options.as_of.kind);
  query.instant_ns = options.as_of.time.count();
  query.mask = options.mask;
  query.max_hits = options.max_hits.value_or(request.kind == wire_contract::QuestionKind::near ? 1 : 1'000);
  query.deadline_ns = options.deadline.count();
  query.error_asked = options.error_m;
  query.barrier_publisher = barrier.publisher;
  query.barrier_sequence = barrier.sequence;
  static_cast<void>(dds::set_text(query.only, options.only));  // lengths were checked
  static_cast<void>(dds::set_text(query.skip, options.skip));
  static_cast<void>(dds::set_text(query.text, request.text));
  dds::borrow(query.blob, request.blob);
}

// Each chunk is made just before it is sent, so that the server works on the first one meanwhile.
std::optional<Error> send_chunk(Connection& connection, Requests::Running& running, const QuestionRequest& request,
                                std::uint32_t chunk) {
  const std::size_t first = std::size_t{chunk} * request.most_in_chunk;
  const std::size_t count = std::min<std::size_t>(request.most_in_chunk, request.question_count - first);
  std::vector<double>& numbers = running.numbers();
  numbers.resize(count * request.number_count);
  request.encode(first, count, numbers.data());
  wire::Query& query = running.query();
  query.chunk_index = chunk;
  query.first_question = static_cast<std::uint32_t>(first);
  wire::clear_questions(query);
  wire::lend_columns(numbers, wire::question_columns(request.kind), running.columns(), query);
  return connection.send(query);
}

// Asks once; the answers include the write `barrier`. `answers` receives the answers, or after an error reusable
// memory.
std::optional<Error> run_once(Connection& connection, const QuestionRequest& request, const AskOptions& options,
                              const WriteBarrier& barrier, Clock::time_point deadline, Answers& answers) {
  if (auto error = connection.ready(deadline)) { return error; }
  const std::uint64_t server = connection.pulse().server();
  const std::unique_ptr<Requests::Running> running = connection.requests().begin();
  if (!running) {
    return Error{ErrorCode::refused, std::to_string(Requests::kMost) + " requests of this client wait for answers",
                 kNothingSent};
  }
  if (request.question_count > kMostAtOnce) { running->sleep_while_waiting(); }
  wire::Query& query = running->query();
  query.request = running->number();
  fill_header(query, request, options, barrier);

  SendWindow window;
  std::uint32_t sent = 0;
  const auto send_to = [&](std::size_t end) {
    std::optional<Error> error;
    for (; !error && sent < query.chunk_count && sent < end; ++sent) {
      error = send_chunk(connection, *running, request, sent);
      window.note_sent(Clock::now());
    }
    return error;
  };
  if (auto error = send_to(window.size())) { return error; }
  AnswerCollector collector(request.question_count, request.most_in_chunk, connection.names(), std::move(answers));
  while (!collector.complete()) {
    if (auto error = send_to(collector.chunks_answered() + window.size())) { return error; }
    const Connection::Waited waited = connection.wait(*running, deadline, server, request.noun);
    if (waited.error) { return waited.error; }
    for (const auto& reply : *waited.replies) {
      if ((*reply)->server != server) {
        continue;  // a second server on this namespace
      }
      const std::size_t before = collector.chunks_answered();
      if (auto error = collector.add(**reply)) {
        answers = collector.take();
        return error;
      }
      if (collector.chunks_answered() > before)
        window.note_answered(Clock::now(), std::chrono::nanoseconds((*reply)->compute_ns));
    }
  }
  answers = collector.take();
  return std::nullopt;
}

}  // namespace

Result<Answers> run(Connection& connection, const QuestionRequest& request, const AskOptions& options,
                    Answers&& earlier) {
  if (auto error = options_fault(request, options)) { return *error; }
  const Clock::time_point deadline = Clock::now() + options.timeout;
  Answers answers = std::move(earlier);
  const WriteBarrier barrier = options.fresh ? connection.last_write() : WriteBarrier{};
  const auto once = [&](Connection& asked) { return run_once(asked, request, options, barrier, deadline, answers); };
  Route* const route = connection.route();
  const bool is_routed = route != nullptr && route->has_company();
  const auto ask_once = [&] { return is_routed ? route->ask(once, options, answers, deadline) : once(connection); };
  std::uint64_t server = connection.pulse().server();
  while (auto error = ask_once()) {
    // If another server has replaced the one that was asked, retries there; a question changes nothing.
    const bool is_replaced = error->code == ErrorCode::disconnected && !connection.pulse().silent() &&
                             std::exchange(server, connection.pulse().server()) != connection.pulse().server();
    const Clock::time_point again = Clock::now() + error->retry_after;
    if ((error->retry_after.count() == 0 && !is_replaced) || again >= deadline) { return *error; }
    std::this_thread::sleep_until(again);
  }
  return answers;
}

namespace {

template <class Question>
Error question_fault(const std::string& reason, std::size_t index, std::size_t count) {
  const std::string noun = QuestionWire<Question>::noun;
  return bad_input((count == 1 ? noun : noun + ' ' + std::to_string(index)) + ": " + reason);
}

/// Checks all questions before the first is sent, since a request is answered completely or not at all.
template <class Question>
std::optional<Error> fault_of(std::span<const Question> questions) {
  using Wire = QuestionWire<Question>;
  if (questions.empty() || questions.size() > kMaxQuestionsPerRequest) {
    return bad_input(std::string(Wire::noun) + ": " + std::to_string(questions.size()) +
                     " questions; a request holds 1 to " + std::to_string(kMaxQuestionsPerRequest));
  }
  for (std::size_t i = 0; i < questions.size(); ++i) {
    if (const auto found = fault(questions[i])) { return question_fault<Question>(*found, i, questions.size()); }
  }
  return std::nullopt;
}

}  // namespace

template <class Question>
Result<Answers> ask(Connection& connection, std::span<const Question> questions, const AskOptions& options,
                    Answers&& earlier) {
  using Wire = QuestionWire<Question>;
  if (auto error = fault_of(questions)) { return *error; }
  return run(connection,
             {Wire::kind, Wire::noun, Wire::number_count, questions.size(), encoder_of<Question>(questions)}, options,
             std::move(earlier));
}

template Result<Answers> ask(Connection&, std::span<const RayQuestion>, const AskOptions&, Answers&&);
template Result<Answers> ask(Connection&, std::span<const SphereQuestion>, const AskOptions&, Answers&&);
template Result<Answers> ask(Connection&, std::span<const BoxQuestion>, const AskOptions&, Answers&&);
template Result<Answers> ask(Connection&, std::span<const NearQuestion>, const AskOptions&, Answers&&);
template Result<Answers> ask(Connection&, std::span<const InsideQuestion>, const AskOptions&, Answers&&);

Result<Answers> sweep(Connection& connection, const Shape& shape, std::span<const SweepQuestion> motions,
                      const AskOptions& options) {
  using Wire = QuestionWire<SweepQuestion>;
  if (auto error = fault_of(motions)) { return *error; }
  const Result<std::vector<std::uint8_t>> bytes = encode_shape(shape, Vec3::Ones(), Wire::noun);
  if (!bytes) { return bytes.error(); }
  const QuestionRequest request{
      Wire::kind, Wire::noun, Wire::number_count, motions.size(), encoder_of<SweepQuestion>(motions), *bytes};
  return run(connection, request, options, {});
}

}  // namespace collided::client
