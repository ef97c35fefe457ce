#pragma once

#include <array>
#include <cstdint>
#include <mutex>
#include <optional>
#include <string>

#include "client/library/connection/errors.hpp"
#include "idl/dds.hpp"

namespace collided::client {

/// The writers of a client's queries: one for all or, with keys, one for each right, since each right is a separate
/// partition. These are made on demand; most clients use one or two.
///
/// threads  any
class QueryWriters {
 public:
  /// keys  the client's folder; empty: none
  QueryWriters(const dds::Participant& participant, const std::string& name_space, std::string keys);

  /// Makes the writer of this right. Returns the error if the keys do not grant it.
  std::optional<Error> open(wire_contract::QueryRight right);
  /// Writes. Returns the error if the keys do not grant the right, or the server accepts no more messages.
  std::optional<Error> write(const wire::Query& query, wire_contract::QueryRight right);
  /// Number of readers of the writer for greetings.
  std::uint32_t matched_readers();
  /// Index of a right's writer; without keys all rights share one.
  std::size_t place_of(wire_contract::QueryRight right) const;

 private:
  dds::Writer<wire::Query>& writer_of(wire_contract::QueryRight right);
  Error no_right(wire_contract::QueryRight right) const;

  const std::string keys_;
  dds::Topic<wire::Query> topic_;
  std::mutex mutex_;  // guards the creation of writers; an existing writer stays
  std::array<std::optional<dds::Writer<wire::Query>>, wire_contract::kQueryRights.size()> writers_;
};

}  // namespace collided::client
