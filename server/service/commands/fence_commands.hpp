#pragma once

#include <cstdint>
#include <set>
#include <string>
#include <vector>

#include "server/geometry/function_ref.hpp"
#include "server/service/commands/command_family.hpp"
#include "server/world/fences/fence_table.hpp"

namespace collided::engine::service {

/// The question for the nearest object that a command defines; throws BadCommand.
FenceDefinition nearest_of(const Arguments& arguments);

/// Fences, margins and questions for the nearest.
class FenceCommands : public CommandFamily {
 public:
  using CommandFamily::CommandFamily;

  std::vector<BoundCommand> commands() override;
  /// Removes the fences of clients that have gone.
  void look_for_gone() override;

 private:
  using Visit = FunctionRef<void(const FenceTable& table, std::uint32_t slot)>;

  nlohmann::json fence(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json fences(const Arguments& arguments);
  nlohmann::json margins(const Arguments& arguments);
  nlohmann::json nearest(const Arguments& arguments);
  void add_fence(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json remove_fences(const CommandAsk& ask, const Arguments& arguments);
  void remove_fences(const std::vector<std::string>& chosen);
  void for_each_standing(const std::string& glob, Visit visit) const;
  void for_each_fence(const std::string& glob, Visit visit) const;
  void for_each_band(const std::string& glob, Visit visit) const;
  void for_each_margin(const std::string& glob, FunctionRef<void(const FenceDefinition& margin)> visit) const;

  std::set<std::uint64_t> fence_owners_;  // clients that may have fences
};

}  // namespace collided::engine::service
