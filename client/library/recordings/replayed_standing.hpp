#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <span>
#include <string>

#include <nlohmann/json_fwd.hpp>

#include "client/library/connection/connection.hpp"

namespace collided::client {

/// The standing questions that a replay has added, each with the recorded client that owns it.
///
/// threads  one
class ReplayedStanding {
 public:
  explicit ReplayedStanding(Connection& connection) : connection_(connection) {}

  /// Notes a repeated command `fence`.
  ///
  /// recorded_client  its recorded sender
  void done(std::uint64_t recorded_client, const nlohmann::json& arguments, std::span<const std::uint8_t> blob);
  /// Removes the questions that this client had added without `keep`.
  void owner_gone(std::uint64_t recorded_client);
  /// Number of added questions.
  std::uint64_t made() const { return made_; }

 private:
  void add(std::uint64_t recorded_client, const nlohmann::json& arguments);

  Connection& connection_;
  std::map<std::string, std::uint64_t> owners_;  // of questions without `keep`, by name
  std::uint64_t made_ = 0;
};

}  // namespace collided::client
