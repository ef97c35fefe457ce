#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include <nlohmann/json.hpp>

#include "client/library/asking/answer_times.hpp"
#include "client/library/asking/certificate_decoding.hpp"
#include "client/library/asking/question_encoding.hpp"
#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "collided/explanations.hpp"
#include "idl/commands.hpp"

/// What all explanations have in common. Reading throws nlohmann::json::exception.
namespace collided::client {

inline std::chrono::nanoseconds time_in(const nlohmann::json& row, const char* key) {
  return std::chrono::nanoseconds(row.at(key).get<std::int64_t>());
}
inline std::optional<std::chrono::nanoseconds> time_if(const nlohmann::json& row, const char* key) {
  return row.contains(key) ? std::optional(time_in(row, key)) : std::nullopt;
}
/// positive  the word that means yes
inline Verdict verdict_word(const nlohmann::json& row, const char* positive) {
  const std::string word = row.at("answer");
  return word == positive ? Verdict::hit : word == "undecided" ? Verdict::undecided : Verdict::miss;
}

/// Asks and reads the answer.
///
/// arguments  those of what is explained, without those that ExplainOptions has
template <class Read>
auto explain(Connection& connection, nlohmann::json arguments, const ExplainOptions& options, const Read& read) {
  arguments["deadline_ns"] = server_deadline(options.deadline, options.timeout).count();
  return read_answer(command(connection, wire_contract::command::kExplain, arguments, options.timeout), "explain",
                     read);
}

}  // namespace collided::client
