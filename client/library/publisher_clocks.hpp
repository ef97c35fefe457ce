#pragma once

#include <cstdint>
#include <limits>
#include <map>
#include <mutex>
#include <optional>
#include <string>

#include "client/library/connection.hpp"
#include "collided/diagnosis.hpp"

namespace collided::client {

/// How far the clocks of those that publish poses are from each other, as heard from here: what the quickest of a
/// publisher's batches took is not known, but it is much the same for all.
class PublisherClocks {
 public:
  /// Hears from now on.
  explicit PublisherClocks(const Connection& connection);

  /// names  by publisher
  /// returns  nothing where fewer than two were heard often enough
  std::optional<Finding> finding(const std::map<std::uint64_t, std::string>& names) const;

 private:
  struct Clock {
    std::uint32_t heard = 0;
    std::int64_t behind_ns = std::numeric_limits<std::int64_t>::max();  // of the quickest batch, its way included
  };
  void hear(dds::Taker<wire::PoseBatch> taker);

  mutable std::mutex mutex_;
  std::map<std::uint64_t, Clock> clocks_;  // under the mutex
  dds::Topic<wire::PoseBatch> topic_;
  dds::Reader<wire::PoseBatch> reader_;  // ends first
};

}  // namespace collided::client
