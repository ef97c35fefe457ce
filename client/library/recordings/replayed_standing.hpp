#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// The standing questions that a replay has made again, and the client that each goes with.
///
/// threads  one
class ReplayedStanding {
 public:
  explicit ReplayedStanding(Connection& connection) : connection_(connection) {}

  /// Takes a command `fence` that was given again.
  ///
  /// recorded_client  that had given it
  void done(std::uint64_t recorded_client, const nlohmann::json& arguments, std::span<const std::uint8_t> blob);
  /// Removes what that client had added without keeping it.
  void owner_gone(std::uint64_t recorded_client);
  /// How many were made.
  std::uint64_t made() const { return made_; }

 private:
  void add(std::uint64_t recorded_client, const nlohmann::json& arguments);

  Connection& connection_;
  std::map<std::string, std::uint64_t> owners_;  // of those that were not kept, by name
  std::uint64_t made_ = 0;
};

}  // namespace collided::client
