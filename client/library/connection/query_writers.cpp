#include "client/library/connection/query_writers.hpp"

namespace collided::client {

using wire_contract::QueryRight;

QueryWriters::QueryWriters(const dds::Participant& participant, const std::string& name_space, std::string keys)
    : keys_(std::move(keys)), topic_(participant, name_space) {
  writer_of(QueryRight::greet);
}

std::size_t QueryWriters::place_of(QueryRight right) const {
  return keys_.empty() ? 0 : static_cast<std::size_t>(right);
}

dds::Writer<wire::Query>& QueryWriters::writer_of(QueryRight right) {
  const std::lock_guard lock(mutex_);
  std::optional<dds::Writer<wire::Query>>& writer = writers_[place_of(right)];
  if (!writer) {
    writer.emplace(topic_, dds::WriterOptions{.partition = keys_.empty() ? "" : wire_contract::name_of(right),
                                              .max_blocking_ns = 1'000'000'000});
  }
  return *writer;
}

Error QueryWriters::no_right(QueryRight right) const {
  constexpr std::array kWhat{"greet the server", "ask questions", "change the world", "send files"};
  return {
      ErrorCode::refused,
      "the keys in '" + keys_ + "' give no right to " + kWhat[static_cast<std::size_t>(right)] + ". Nothing was sent",
      std::string("role ") + (right == QueryRight::ask ? "asker or admin" : "admin") +
          " has it; where the authority is: collide keys add NAME --role ROLE"};
}

std::optional<Error> QueryWriters::open(QueryRight right) {
  try {
    writer_of(right);
    return std::nullopt;
  } catch (const dds::NotAllowedError&) { return no_right(right); } catch (const dds::DdsError& failed) {
    return failure_of(failed);
  }
}

std::optional<Error> QueryWriters::write(const wire::Query& query, QueryRight right) {
  if (auto error = open(right)) { return error; }
  try {
    if (writer_of(right).write(query)) { return std::nullopt; }
  } catch (const dds::DdsError& failed) { return failure_of(failed); }
  return Error{ErrorCode::timeout, "the server took no question for 1 s: its queue is full",
               "ask less at a time, or give it more threads"};
}

std::uint32_t QueryWriters::matched_readers() { return writer_of(QueryRight::greet).matched_readers(); }

}  // namespace collided::client
