#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "client/library/connection/connection.hpp"
#include "collided/standing.hpp"

namespace collided::client {

/// The functions of Client for standing questions.
Result<AddedStanding> add_standing(Connection& connection, const Standing& standing);
Result<void> add_standing(Connection& connection, std::span<const Standing> standing);
Result<std::size_t> remove_standing(Connection& connection, const std::string& name, std::optional<StandingForm> form);
Result<std::vector<ListedStanding>> list_standing(Connection& connection, const std::string& name_glob,
                                                  std::optional<StandingForm> form);
Result<StandingWatch> watch_standing(std::shared_ptr<Connection> connection, const StandingWatchOptions& options);

}  // namespace collided::client
