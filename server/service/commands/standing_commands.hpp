#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include <collided/listed_standing.hpp>

#include "server/geometry/function_ref.hpp"
#include "server/service/commands/command_family.hpp"
#include "server/world/fences/fence_table.hpp"

namespace collided::engine::service {

/// Adds, lists and removes regions, bands and questions for the nearest.
class StandingCommands : public CommandFamily {
 public:
  using CommandFamily::CommandFamily;

  std::vector<BoundCommand> commands() override;
  /// Removes the questions of clients that have gone.
  void look_for_gone() override;

 private:
  struct Named {
    std::string name;
    std::uint64_t owner = 0;                 // the client that it is removed with; 0: it is kept
    std::uint32_t slot = FenceTable::kNone;  // of a region or the nearest
    const FenceDefinition* bands = nullptr;  // else of bands
  };
  using Visit = FunctionRef<void(const Named& one)>;
  using HeldById = std::map<ObjectId, std::vector<HeldObject>>;

  nlohmann::json add_or_remove(const CommandAsk& ask, const Arguments& arguments);
  void add(const CommandAsk& ask, const Arguments& arguments);
  nlohmann::json remove(const CommandAsk& ask, const Arguments& arguments);
  void remove(const std::vector<Named>& chosen);
  nlohmann::json list(const Arguments& arguments);
  nlohmann::json outlines(const Arguments& arguments);
  nlohmann::json answer_of(nlohmann::json rows, std::uint64_t count) const;
  void for_each(const std::string& glob, std::optional<StandingForm> form, Visit visit) const;
  HeldById held() const;
  std::map<std::string, std::vector<HeldObject>> narrowest(const HeldById& held) const;

  std::set<std::uint64_t> owners_;  // clients that may have questions
};

}  // namespace collided::engine::service
