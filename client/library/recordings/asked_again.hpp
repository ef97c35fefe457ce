#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// The answer to one question in a form that can be compared across runs of the server. The bytes are equal where the
/// answers are: verdict, reason and every hit, without costs. Objects are identified by name and hits are in an order
/// that does not depend on ids, since ids differ from run to run.
struct ComparedAnswer {
  std::string bytes;
  std::string words;      // "hit crate 3.8", for people
  bool by_clock = false;  // the answer came from a deadline, or a server that was still recovering
};

/// Collects the replies to one request for comparison.
/// threads  one at a time
class ComparedAnswers {
 public:
  /// Takes a reply. False where its columns differ in length; the answers before that count.
  bool add(const wire::Reply& reply);
  /// The answers by the number of the question. The answer to a command is number 0: its JSON without the version,
  /// which differs from run to run.
  std::map<std::uint64_t, ComparedAnswer> take();

 private:
  std::map<std::uint64_t, ComparedAnswer> answers_;
  std::map<std::uint32_t, std::string> text_;  // by chunk
};

/// Sends the recorded chunks of one request as a request of this connection. Calls `take` for each reply until all
/// questions are answered, or, for a request without questions, there is one reply for each chunk.
///
/// queries  their client and request number are set to this connection's
std::optional<Error> ask_again(Connection& connection, std::vector<dds::Sample<wire::Query>>& queries,
                               const std::function<void(const wire::Reply&)>& take);

}  // namespace collided::client
