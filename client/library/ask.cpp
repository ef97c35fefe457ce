#include "client/library/ask.hpp"

#include <algorithm>

#include "client/library/answer_decoding.hpp"
#include "client/library/errors.hpp"

namespace collided::client {
namespace {

using wire_contract::kChunksInFlight;
using wire_contract::kMaxQuestionsPerChunk;
using wire_contract::kMaxQuestionsPerRequest;

struct Request {
  wire_contract::QueryKind kind;
  const char* noun;
  std::uint32_t number_count;       // per question
  std::span<const double> numbers;  // of all questions
  std::size_t question_count() const { return numbers.size() / number_count; }
};

std::optional<Error> options_fault(const Request& request, const AskOptions& options) {
  const std::string noun = request.noun;
  if (options.only.size() > wire_contract::kMaxNameBytes || options.skip.size() > wire_contract::kMaxNameBytes) {
    return bad_input(noun + ": a name pattern has more than " + std::to_string(wire_contract::kMaxNameBytes) + " bytes");
  }
  if (!(options.error_m >= 0)) {
    return bad_input(noun + ": error asked is " + words(options.error_m) + "; allowed 0 or more");
  }
  if (options.deadline.count() < 0 || options.timeout.count() <= 0) {
    return bad_input(noun + ": a time is negative, or the timeout 0");
  }
  return std::nullopt;
}

// Everything but the questions; the slot's sample may hold what another request left.
void fill_header(wire::Query& query, const Request& request, const AskOptions& options, const Fence& fence) {
  query.chunk_count =
      static_cast<std::uint32_t>((request.question_count() + kMaxQuestionsPerChunk - 1) / kMaxQuestionsPerChunk);
  query.kind = static_cast<std::uint8_t>(request.kind);
  query.mode = static_cast<std::uint8_t>(options.pick);
  query.mask = options.mask;
  query.max_hits = options.max_hits;
  query.deadline_ns = options.deadline.count();
  query.error_asked_m = options.error_m;
  query.fence_publisher = fence.publisher;
  query.fence_sequence = fence.sequence;
  static_cast<void>(dds::set_text(query.only, options.only));  // lengths were checked
  static_cast<void>(dds::set_text(query.skip, options.skip));
  query.text[0] = 0;
  dds::borrow(query.blob, std::span<const std::uint8_t>());
}

std::optional<Error> send_chunk(Connection& connection, wire::Query& query, const Request& request,
                                std::uint32_t chunk) {
  const std::size_t first = std::size_t{chunk} * kMaxQuestionsPerChunk;
  const std::size_t count = std::min<std::size_t>(kMaxQuestionsPerChunk, request.question_count() - first);
  query.chunk_index = chunk;
  query.first_question = static_cast<std::uint32_t>(first);
  dds::borrow(query.numbers, request.numbers.subspan(first * request.number_count, count * request.number_count));
  return connection.send(query);
}

Result<Answers> run(Connection& connection, const Request& request, const AskOptions& options) {
  if (auto error = options_fault(request, options)) {
    return *error;
  }
  const Clock::time_point deadline = Clock::now() + options.timeout;
  if (auto error = connection.ready(deadline)) {
    return *error;
  }
  const std::uint64_t server = connection.pulse().server();
  const std::unique_ptr<Requests::Running> running = connection.requests().begin();
  if (!running) {
    return Error{ErrorCode::refused, std::to_string(Requests::kMost) + " requests of this client wait for answers",
                 kNothingSent};
  }
  wire::Query& query = running->query();
  query.request = running->number();
  fill_header(query, request, options, options.fresh ? connection.last_write() : Fence{});

  AnswerCollector collector(request.question_count(), kMaxQuestionsPerChunk, connection.names());
  std::uint32_t sent = 0;
  while (!collector.complete()) {
    for (; sent < query.chunk_count && sent < collector.chunks_answered() + kChunksInFlight; ++sent) {
      if (auto error = send_chunk(connection, query, request, sent)) {
        return *error;
      }
    }
    const Connection::Waited waited = connection.wait(*running, deadline, server, request.noun);
    if (waited.error) {
      return *waited.error;
    }
    for (const auto& reply : *waited.replies) {
      if ((*reply)->server != server) {
        continue;  // a second server on this namespace
      }
      if (auto error = collector.add(**reply)) {
        return *error;
      }
    }
  }
  return collector.take();
}

template <class Question>
Error question_fault(const std::string& reason, std::size_t index, std::size_t count) {
  const std::string noun = QuestionWire<Question>::noun;
  return bad_input((count == 1 ? noun : noun + ' ' + std::to_string(index)) + ": " + reason);
}

}  // namespace

template <class Question>
Result<Answers> ask(Connection& connection, std::span<const Question> questions, const AskOptions& options) {
  using Wire = QuestionWire<Question>;
  if (questions.empty() || questions.size() > kMaxQuestionsPerRequest) {
    return bad_input(std::string(Wire::noun) + ": " + std::to_string(questions.size()) +
                     " questions; a request holds 1 to " + std::to_string(kMaxQuestionsPerRequest));
  }
  double single[Wire::number_count];
  std::vector<double> many(questions.size() > 1 ? questions.size() * Wire::number_count : 0);
  double* const numbers = many.empty() ? single : many.data();
  for (std::size_t i = 0; i < questions.size(); ++i) {
    if (const auto reason = fault(questions[i])) {
      return question_fault<Question>(*reason, i, questions.size());
    }
    encode(questions[i], numbers + i * Wire::number_count);
  }
  const Request request{Wire::kind, Wire::noun, Wire::number_count, {numbers, questions.size() * Wire::number_count}};
  return run(connection, request, options);
}

template Result<Answers> ask(Connection&, std::span<const RayQuestion>, const AskOptions&);
template Result<Answers> ask(Connection&, std::span<const SphereQuestion>, const AskOptions&);
template Result<Answers> ask(Connection&, std::span<const BoxQuestion>, const AskOptions&);
template Result<Answers> ask(Connection&, std::span<const NearQuestion>, const AskOptions&);

}  // namespace collided::client
