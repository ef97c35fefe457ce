#include "client/library/recordings/asked_again.hpp"

#include <algorithm>
#include <cstring>
#include <functional>
#include <nlohmann/json.hpp>
#include <set>
#include <utility>

#include "client/library/connection/errors.hpp"
#include "idl/columns.hpp"

namespace collided::client {
namespace {

using wire_contract::kHitNumbers;
using wire_contract::ReplyStatus;
using wire_contract::UndecidedReason;
using wire_contract::Verdict;

constexpr std::chrono::seconds kTimeout{10};

template <class Value>
void append(std::string& bytes, const Value& value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

struct Hits {
  explicit Hits(const wire::Reply& reply)
      : objects(dds::view(reply.objects)), triangles(dds::view(reply.triangles)), flags(dds::view(reply.hit_flags)) {
    const auto names = wire_contract::unpack_names(dds::view(reply.names));
    const auto ids = dds::view(reply.named_ids);
    for (std::size_t i = 0; i < std::min(names.size(), ids.size()); ++i) name_of.emplace(ids[i], names[i]);
    const wire::Columns<wire::Reply> columns = wire::hit_columns(reply);
    if (wire::row_count(reply, columns)) wire::gather_rows(reply, columns, numbers);
    count = std::min({objects.size(), triangles.size(), flags.size(), numbers.size() / kHitNumbers});
  }
  std::string name(std::size_t i) const {
    const auto found = name_of.find(objects[i]);
    return found == name_of.end() ? "?" : std::string(found->second);
  }
  std::string bytes(std::size_t i) const {
    std::string all = name(i) + '\0';
    append(all, triangles[i]);
    append(all, flags[i]);
    for (const double number : std::span(numbers).subspan(i * kHitNumbers, kHitNumbers)) append(all, number);
    return all;
  }
  std::span<const std::uint64_t> objects;
  std::span<const std::uint32_t> triangles;
  std::span<const std::uint8_t> flags;
  std::vector<double> numbers;
  std::map<std::uint64_t, std::string_view> name_of;
  std::size_t count = 0;
};

std::string words_of(Verdict verdict, std::uint8_t reason, const Hits& hits, std::size_t first, std::size_t count) {
  std::string words(name_of(std::min(verdict, Verdict::invalid)));
  if (std::string why(name_of(static_cast<codes::UndecidedReason>(reason))); !why.empty()) {
    std::ranges::replace(why, '_', ' ');
    words += " (" + why + ')';
  }
  if (count > 0) words += ' ' + hits.name(first) + ' ' + client::words(hits.numbers[first * kHitNumbers]);
  if (count > 1) words += " and " + std::to_string(count - 1) + " more";
  return words;
}

}  // namespace

bool ComparedAnswers::add(const wire::Reply& reply) {
  // A refusal also has a text, but it is not an answer.
  const auto text = reply.status == static_cast<std::uint8_t>(ReplyStatus::ok) ? dds::view(reply.text)
                                                                               : std::span<const std::uint8_t>();
  if (!text.empty()) text_[reply.chunk_index].assign(text.begin(), text.end());
  const auto verdicts = dds::view(reply.answers);
  const auto reasons = dds::view(reply.reasons);
  const auto counts = dds::view(reply.hit_counts);
  const Hits hits(reply);
  const auto uncovered = dds::view(reply.uncovered_questions);
  if (wire::row_count<wire::Reply>(reply, wire::kUncoveredColumns) != uncovered.size()) return false;
  std::size_t at = 0;
  for (std::size_t i = 0; i < verdicts.size(); ++i) {
    if (i >= reasons.size() || i >= counts.size() || counts[i] > hits.count - at) return false;
    std::vector<std::string> each;
    for (std::size_t hit = at; hit < at + counts[i]; ++hit) each.push_back(hits.bytes(hit));
    std::sort(each.begin(), each.end());
    ComparedAnswer& answer = answers_[std::uint64_t{reply.first_question} + i];
    answer.bytes = {static_cast<char>(verdicts[i]), static_cast<char>(reasons[i])};
    for (const std::string& bytes : each) answer.bytes += bytes;
    for (std::size_t k = 0; k < uncovered.size(); ++k) {
      if (uncovered[k] != i) continue;
      for (const double number : dds::view(reply.uncovered_points).subspan(3 * k, 3)) append(answer.bytes, number);
      append(answer.bytes, reply.uncovered_distances._buffer[k]);
    }
    answer.words = words_of(static_cast<Verdict>(verdicts[i]), reasons[i], hits, at, counts[i]);
    answer.by_clock = reasons[i] == static_cast<std::uint8_t>(UndecidedReason::deadline) ||
                      reasons[i] == static_cast<std::uint8_t>(UndecidedReason::recovering) ||
                      reasons[i] == static_cast<std::uint8_t>(UndecidedReason::stale_object);
    at += counts[i];
  }
  return at == hits.count;
}

std::map<std::uint64_t, ComparedAnswer> ComparedAnswers::take() {
  std::string text;
  for (const auto& [chunk, part] : text_) text += part;
  text_.clear();
  nlohmann::json answer = nlohmann::json::parse(text, nullptr, false);
  nlohmann::json no_pairs = nlohmann::json::array();
  if (answer.is_object()) {
    // The cost of an answer depends on the order in which a server has received its objects.
    for (const char* key : {"version", "tested", "filtered"}) answer.erase(key);
    for (nlohmann::json& pair : answer.contains("pairs") ? answer["pairs"] : no_pairs) {
      for (const char* key : {"a_id", "b_id"}) pair.erase(key);
    }
    const auto verdict = answer.find("answer");
    answers_[0] = {.bytes = answer.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace),
                   .words = verdict != answer.end() && verdict->is_string() ? verdict->get<std::string>() : "an answer",
                   .by_clock = answer.contains("stale") || answer.contains("late")};
  }
  return std::exchange(answers_, {});
}

std::optional<Error> ask_again(Connection& connection, std::vector<dds::Sample<wire::Query>>& queries,
                               const std::function<void(const wire::Reply&)>& take) {
  const Clock::time_point deadline = Clock::now() + kTimeout;
  if (auto error = connection.ready(deadline)) return error;
  const std::uint64_t server = connection.pulse().server();
  const std::unique_ptr<Requests::Running> running = connection.requests().begin();
  if (!running) return Error{ErrorCode::refused, "too many requests wait for answers", kNothingSent};
  running->sleep_while_waiting();
  std::size_t sent = 0, wanted = 0, answered = 0;
  std::size_t most_chunks = queries.size();  // a command's answer may have more
  std::set<std::uint32_t> chunks;
  for (const dds::Sample<wire::Query>& query : queries) { wanted += wire::question_count(*query).value_or(0); }
  while (answered < wanted || chunks.size() < most_chunks) {
    for (; sent < queries.size() && sent < chunks.size() + wire_contract::kChunksInFlight; ++sent) {
      queries[sent]->request = running->number();
      // The recorded state has been reproduced, so the answer need not wait for a publisher's message, and must not
      // depend on time.
      queries[sent]->barrier_publisher = 0;
      queries[sent]->deadline_ns = 0;
      if (auto error = connection.send(*queries[sent])) return error;
    }
    const Connection::Waited waited = connection.wait(*running, deadline, server, "replay");
    if (waited.error) return waited.error;
    for (const auto& reply : *waited.replies) {
      if ((*reply)->server != server) continue;
      if ((*reply)->status == static_cast<std::uint8_t>(ReplyStatus::progress)) continue;
      take(**reply);
      chunks.insert((*reply)->chunk_index);
      if (wanted == 0) most_chunks = std::max<std::size_t>(most_chunks, (*reply)->chunk_count);
      answered += (*reply)->answers._length;
      if ((*reply)->status == static_cast<std::uint8_t>(ReplyStatus::refused)) return std::nullopt;
    }
  }
  return std::nullopt;
}

}  // namespace collided::client
