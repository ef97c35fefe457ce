#pragma once

#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "idl/dds.hpp"
#include "server/world/objects/snapshot.hpp"

namespace collided::engine::service {

/// One chunk of a request on its way from the listener to a worker.
struct Ask {
  dds::Sample<wire::Query> query;
  std::int64_t taken_ns = 0;  // steady clock
  bool passed_fence = false;
  std::string refusal;         // decided before a worker saw it; empty: none
  SnapshotRing::Lease pinned;  // the state that all chunks of its request are answered on; none: the newest

  /// For the next question, which brings its own query.
  void reset();
};
using AskPointer = std::unique_ptr<Ask>;

/// Used asks keep their memory for later ones.
class AskPool {
 public:
  AskPool();
  AskPointer get();
  void put(AskPointer ask);

 private:
  static constexpr std::size_t kMost = 256;  // up to 80 kB each
  static constexpr std::size_t kAtFirst = 16;
  std::mutex mutex_;
  std::vector<AskPointer> spares_;
};

/// One question that is a whole request.
bool is_single(const wire::Query& query);

/// About how much work a chunk is: 1 is a ray. Commands count as a thousand.
double cost_of(const wire::Query& query);

/// Why a chunk cannot be answered, as a sentence with the value and what is allowed; nothing where it can.
std::optional<std::string> why_refused(const wire::Query& query);

}  // namespace collided::engine::service
