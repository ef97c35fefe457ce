#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "client/library/connection.hpp"

namespace collided::client {

/// One question's answer as bytes that are equal where the answers are: verdict, reason and every hit with its object by
/// name, since numbers of objects belong to a server's life, in an order that does not know them; not what it cost.
struct ComparedAnswer {
  std::string bytes;
  std::string words;  // "hit crate 3.8", for people
  bool by_clock = false;  // the answer came from a deadline, or a server that was still recovering
};

/// Adds a reply's answers by the number of their question. False where its lists do not fit each other.
bool add_answers(const wire::Reply& reply, std::map<std::uint64_t, ComparedAnswer>& answers);

/// Sends recorded questions, the chunks of one request, as a request of this connection's; the replies are handed to
/// `take` until there are as many answers as the questions ask for, or one reply for each that has none.
/// queries  changed: client and number become this connection's
std::optional<Error> ask_again(Connection& connection, std::vector<dds::Sample<wire::Query>>& queries,
                               const std::function<void(const wire::Reply&)>& take);

}  // namespace collided::client
