#include "client/library/commands/command.hpp"

#include <map>

#include <nlohmann/json.hpp>

#include "client/library/asking/answer_decoding.hpp"
#include "client/library/connection/errors.hpp"
#include "client/library/connection/route.hpp"
#include "client/library/publishing/shape_encoding.hpp"
#include "idl/command_table.hpp"
#include "idl/outside_text.hpp"

namespace collided::client {
namespace {

using wire_contract::ReplyStatus;

// Assembles the chunks of an answer's text, which may come in any order.
class TextCollector {
 public:
  void add(const wire::Reply& reply) {
    chunk_count_ = reply.chunk_count;
    chunks_[reply.chunk_index] = text_of(reply);
  }
  bool complete() const { return chunk_count_ > 0 && chunks_.size() == chunk_count_; }
  std::string text() const {
    std::string all;
    for (const auto& [index, text] : chunks_) { all += text; }
    return all;
  }

 private:
  std::size_t chunk_count_ = 0;
  std::map<std::uint32_t, std::string> chunks_;
};

Result<std::string> command_text(std::string_view name, std::string_view json_arguments) {
  const std::string where = "command '" + std::string(name) + "': ";
  nlohmann::json arguments =
      json_arguments.empty() ? nlohmann::json::object() : nlohmann::json::parse(json_arguments, nullptr, false);
  if (!arguments.is_object()) { return bad_input(where + "its arguments are not a JSON object"); }
  arguments["command"] = name;
  std::string text = arguments.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
  if (text.size() >= sizeof(wire::Query::text)) {
    return bad_input(where + "its arguments have " + std::to_string(text.size()) + " bytes; allowed " +
                     std::to_string(sizeof(wire::Query::text) - 1));
  }
  return text;
}

/// The right that a command with this text needs.
wire_contract::QueryRight right_of(std::string_view name, const std::string& text) {
  const bool is_load = name == wire_contract::command::kLoad;
  return wire_contract::command::right_for(name, is_load && nlohmann::json::parse(text).contains("upload"));
}

double fraction(const std::string& text) {
  const nlohmann::json parsed = nlohmann::json::parse(text, nullptr, false);
  return parsed.is_object() && parsed.contains("fraction") && parsed["fraction"].is_number()
             ? parsed["fraction"].get<double>()
             : 0;
}

std::optional<Error> send_command(Connection& connection, Requests::Running& running, const std::string& text,
                                  std::span<const std::uint8_t> blob, wire_contract::QueryRight right) {
  wire::Query& query = running.query();
  query = {};
  query.request = running.number();
  query.chunk_count = 1;
  query.kind = static_cast<std::uint8_t>(wire_contract::QuestionKind::command);
  static_cast<void>(dds::set_text(query.text, text));  // its length was checked
  dds::borrow(query.blob, blob);
  return connection.send(query, right);
}

}  // namespace

Result<std::string> command(Connection& connection, std::string_view name, std::string_view json_arguments,
                            const Shape& shape, std::chrono::nanoseconds timeout,
                            const std::function<void(double)>& progress) {
  std::vector<std::uint8_t> blob;
  if (!shape.empty()) {
    Result<std::vector<std::uint8_t>> encoded = encode_shape(shape, Vec3::Ones(), std::string(name));
    if (!encoded) { return encoded.error(); }
    blob = std::move(*encoded);
  }
  return command_with_blob(connection, name, json_arguments, blob, timeout, progress);
}

Result<std::string> command(Connection& connection, std::string_view name, const nlohmann::json& arguments,
                            std::chrono::nanoseconds timeout, const std::function<void(double)>& progress) {
  const Result<std::string> text = argument_text(name, arguments);
  return text ? command_with_blob(connection, name, *text, {}, timeout, progress) : text;
}

Result<std::string> argument_text(std::string_view name, const nlohmann::json& arguments) {
  try {
    return arguments.dump();
  } catch (const nlohmann::json::type_error&) {
    return bad_input(std::string(name) + ": a name is not UTF-8 text. Nothing was sent");
  }
}

namespace {

/// Sends the command and collects its answer.
///
/// changed_ns  set to the world time of the answer
Result<std::string> run_command(Connection& connection, std::string_view name, const std::string& text,
                                wire_contract::QueryRight right, std::span<const std::uint8_t> blob,
                                std::chrono::nanoseconds timeout, const std::function<void(double)>& progress,
                                std::int64_t& changed_ns) {
  Clock::time_point deadline = Clock::now() + timeout;
  if (auto error = connection.ready(deadline, right)) { return *error; }
  const std::uint64_t server = connection.pulse().server();
  const std::unique_ptr<Requests::Running> running = connection.requests().begin();
  if (!running) {
    return Error{ErrorCode::refused, std::to_string(Requests::kMost) + " requests of this client wait for answers",
                 kNothingSent};
  }
  if (auto error = send_command(connection, *running, text, blob, right)) { return *error; }
  TextCollector collector;
  while (!collector.complete()) {
    const Connection::Waited waited = connection.wait(*running, deadline, server, std::string(name));
    if (waited.error) { return *waited.error; }
    for (const auto& reply : *waited.replies) {
      if ((*reply)->server != server) {
        continue;  // a second server on this namespace
      }
      const auto status = static_cast<ReplyStatus>((*reply)->status);
      if (status == ReplyStatus::refused) { return refusal(text_of(**reply)); }
      if (status == ReplyStatus::progress) {
        deadline = Clock::now() + timeout;
        if (progress) { progress(fraction(text_of(**reply))); }
      } else {
        collector.add(**reply);
        changed_ns = (*reply)->world_time_ns;
      }
    }
  }
  std::string answer = collector.text();
  const wire_contract::command::CommandSpec* const spec = wire_contract::command::find_command(name);
  const bool may_be_bytes = spec != nullptr && spec->answers_bytes;
  if (!may_be_bytes && wire_contract::nests_too_deep(answer)) {
    return Error{ErrorCode::internal, std::string(name) + ": the server's answer nests too deep to be read", ""};
  }
  return answer;
}

}  // namespace

Result<std::string> command_with_blob(Connection& connection, std::string_view name, std::string_view json_arguments,
                                      std::span<const std::uint8_t> blob, std::chrono::nanoseconds timeout,
                                      const std::function<void(double)>& progress) {
  const Result<std::string> text = command_text(name, json_arguments);
  if (!text) { return text.error(); }
  const wire_contract::QueryRight right = right_of(name, *text);
  std::int64_t changed_ns = 0;
  Result<std::string> answer = run_command(connection, name, *text, right, blob, timeout, progress, changed_ns);
  if (right != wire_contract::QueryRight::ask && connection.route() != nullptr) {
    if (answer) connection.route()->note_change(changed_ns);
    else connection.route()->note_possible_change();
  }
  return answer;
}

}  // namespace collided::client
