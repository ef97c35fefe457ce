#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// One question's answer as bytes that are equal where the answers are: verdict, reason and every hit with its object by
/// name, since numbers of objects belong to a server's life, in an order that does not know them; not what it cost.
struct ComparedAnswer {
  std::string bytes;
  std::string words;      // "hit crate 3.8", for people
  bool by_clock = false;  // the answer came from a deadline, or a server that was still recovering
};

/// What the replies of one request say.
class ComparedAnswers {
 public:
  /// False where a reply's lists do not fit each other; its answers up to there are in.
  bool add(const wire::Reply& reply);
  /// By the number of the question. A command's answer is number 0: its JSON but for the version, which belongs to a
  /// server's life.
  std::map<std::uint64_t, ComparedAnswer> take();

 private:
  std::map<std::uint64_t, ComparedAnswer> answers_;
  std::map<std::uint32_t, std::string> text_;  // by chunk
};

/// Sends recorded questions, the chunks of one request, as a request of this connection's; the replies are handed to
/// `take` until there are as many answers as the questions ask for, or one reply for each that has none.
/// queries  changed: client and number become this connection's
std::optional<Error> ask_again(Connection& connection, std::vector<dds::Sample<wire::Query>>& queries,
                               const std::function<void(const wire::Reply&)>& take);

}  // namespace collided::client
