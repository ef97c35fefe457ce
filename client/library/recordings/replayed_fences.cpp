#include "client/library/recordings/replayed_fences.hpp"

#include <nlohmann/json.hpp>

#include "client/library/watching/fences.hpp"
#include "client/library/watching/margins.hpp"
#include "client/library/watching/nearest.hpp"
#include "idl/glob.hpp"
#include "idl/packed_fences.hpp"

namespace collided::client {
namespace {

bool is_true(const nlohmann::json& arguments, const char* key) {
  const auto found = arguments.find(key);
  return found != arguments.end() && found->is_boolean() && found->get<bool>();
}

}  // namespace

void ReplayedFences::done(std::uint64_t recorded_client, const nlohmann::json& arguments,
                          std::span<const std::uint8_t> blob) {
  // Names of which a removal took the fence are left: by now another's may have one, and is another Owned.
  if (is_true(arguments, "remove")) return;
  if (!is_true(arguments, "many")) return add(recorded_client, arguments);
  const auto packed = wire_contract::unpack_fences(std::as_bytes(blob));
  if (!packed) return;
  for (const wire_contract::PackedFence& one : *packed)
    add(recorded_client, nlohmann::json::parse(one.arguments, nullptr, false));
}

void ReplayedFences::add(std::uint64_t recorded_client, const nlohmann::json& arguments) {
  if (!arguments.is_object()) return;
  const auto name = arguments.find("name");
  if (name == arguments.end() || !name->is_string()) return;
  ++made_;
  if (is_true(arguments, "keep")) owned_.erase(name->get<std::string>());
  else
    owned_[name->get<std::string>()] = {recorded_client, arguments.contains("bands")    ? Kind::margin
                                                         : arguments.contains("within") ? Kind::nearest
                                                                                        : Kind::fence};
}

void ReplayedFences::owner_gone(std::uint64_t recorded_client) {
  std::erase_if(owned_, [&](const auto& entry) {
    const auto& [name, owned] = entry;
    if (owned.owner != recorded_client) return false;
    const std::string glob = wire_contract::glob_of(name);
    // One that is gone already needs no removing.
    if (owned.kind == Kind::margin) static_cast<void>(remove_margins(connection_, glob));
    else if (owned.kind == Kind::nearest) static_cast<void>(remove_nearest(connection_, glob));
    else static_cast<void>(remove_fences(connection_, glob));
    return true;
  });
}

}  // namespace collided::client
