#include "client/library/recordings/replayed_standing.hpp"

#include <nlohmann/json.hpp>

#include "client/library/watching/standing.hpp"
#include "idl/glob.hpp"
#include "idl/packed_fences.hpp"

namespace collided::client {
namespace {

bool is_true(const nlohmann::json& arguments, const char* key) {
  const auto found = arguments.find(key);
  return found != arguments.end() && found->is_boolean() && found->get<bool>();
}

}  // namespace

void ReplayedStanding::done(std::uint64_t recorded_client, const nlohmann::json& arguments,
                            std::span<const std::uint8_t> blob) {
  // Keeps removed names: another client's question may have the name by now, with its own owner.
  if (is_true(arguments, "remove")) return;
  if (!is_true(arguments, "many")) return add(recorded_client, arguments);
  const auto packed = wire_contract::unpack_fences(std::as_bytes(blob));
  if (!packed) return;
  for (const wire_contract::PackedFence& one : *packed)
    add(recorded_client, nlohmann::json::parse(one.arguments, nullptr, false));
}

void ReplayedStanding::add(std::uint64_t recorded_client, const nlohmann::json& arguments) {
  if (!arguments.is_object()) return;
  const auto name = arguments.find("name");
  if (name == arguments.end() || !name->is_string()) return;
  ++made_;
  if (is_true(arguments, "keep")) owners_.erase(name->get<std::string>());
  else owners_[name->get<std::string>()] = recorded_client;
}

void ReplayedStanding::owner_gone(std::uint64_t recorded_client) {
  std::erase_if(owners_, [&](const auto& entry) {
    const auto& [name, owner] = entry;
    if (owner != recorded_client) return false;
    // A missing question is not an error.
    static_cast<void>(remove_standing(connection_, wire_contract::glob_of(name), {}));
    return true;
  });
}

}  // namespace collided::client
