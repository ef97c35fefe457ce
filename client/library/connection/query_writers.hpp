#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "client/library/connection/errors.hpp"
#include "idl/dds.hpp"

namespace collided::client {

/// Where a client's queries go: one writer for all of them, or with keys one for each right, since each right is a
/// partition of its own. These are made when they are first needed: most clients use one or two.
///
/// threads  any
class QueryWriters {
 public:
  /// keys  the client's folder; empty: none
  QueryWriters(const dds::Participant& participant, const std::string& name_space, std::string keys);

  /// Makes the writer of this right. The error where the keys do not give it.
  std::optional<Error> open(wire_contract::QueryRight right);
  /// Writes. The error where the keys do not give the right, or the server takes no more messages.
  std::optional<Error> write(const wire::Query& query, wire_contract::QueryRight right);
  /// How many readers the writer of greetings has.
  std::uint32_t matched_readers();
  /// Rights of the same place share a writer.
  std::size_t place_of(wire_contract::QueryRight right) const;

 private:
  dds::Writer<wire::Query>& writer_of(wire_contract::QueryRight right);
  Error no_right(wire_contract::QueryRight right) const;

  const std::string keys_;
  dds::Topic<wire::Query> topic_;
  std::mutex mutex_;  // guards which are made; a writer that is stays
  std::array<std::optional<dds::Writer<wire::Query>>, wire_contract::kQueryRights.size()> writers_;
};

}  // namespace collided::client
