#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// The answer to one question in a form that is comparable across runs of the server. The bytes are equal if the
/// answers are: verdict, reason and every hit, without costs. Objects are identified by name, and the order of hits
/// does not depend on ids, since ids differ between runs.
struct ComparedAnswer {
  std::string bytes;
  std::string words;      // "hit crate 3.8", for people
  bool by_clock = false;  // the answer came from a deadline, or a server that was still recovering
};

/// Collects the replies to one request for comparison.
/// threads  one at a time
class ComparedAnswers {
 public:
  /// Adds a reply. False if its columns differ in length; earlier answers stay valid.
  bool add(const wire::Reply& reply);
  /// The answers by the number of the question. The answer to a command is number 0: its JSON without the version,
  /// which differs between runs.
  std::map<std::uint64_t, ComparedAnswer> take();

 private:
  std::map<std::uint64_t, ComparedAnswer> answers_;
  std::map<std::uint32_t, std::string> text_;  // by chunk
};

/// Sends the recorded chunks of one request as a request of this connection. Calls `take` for each reply until all
/// questions are answered, or, for a request without questions, there is one reply for each chunk.
///
/// queries  this function sets their client and request number
std::optional<Error> ask_again(Connection& connection, std::vector<dds::Sample<wire::Query>>& queries,
                               const std::function<void(const wire::Reply&)>& take);

}  // namespace collided::client
