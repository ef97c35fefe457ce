#include "client/library/asking/pair.hpp"

#include "client/library/asking/answer_times.hpp"
#include "client/library/asking/question_encoding.hpp"
#include "client/library/commands/command.hpp"
#include "client/library/commands/json_reading.hpp"
#include "client/library/connection/errors.hpp"
#include "idl/answers/pair.hpp"
#include "idl/commands.hpp"

namespace collided::client {

Result<PairAnswer> pair(Connection& connection, const std::string& a, const std::string& b,
                        const PairOptions& options) {
  if (auto error = time_fault("pair", options.as_of, options.deadline)) return *error;
  nlohmann::json arguments{{"a", a},
                           {"b", b},
                           {"certificate", options.certificate},
                           {"triangles", options.triangles},
                           {"most", options.most_triangle_pairs},
                           {"as_of", wire_contract::text_of(instant_of(options.as_of))},
                           {"deadline_ns", server_deadline(options.deadline, options.timeout).count()}};
  if (!options.opinion.empty()) arguments["opinion"] = options.opinion;  // an older server refuses unknown arguments
  return read_answer<PairAnswer>(command(connection, wire_contract::command::kPair, arguments, options.timeout),
                                 "pair");
}

}  // namespace collided::client
