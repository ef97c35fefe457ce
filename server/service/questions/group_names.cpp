#include "server/service/questions/group_names.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <functional>
#include <set>
#include <string_view>
#include <unordered_set>

#include "idl/glob.hpp"
#include "server/service/questions/nearest_word.hpp"
#include "server/service/questions/validation.hpp"

namespace collided::engine::service {
namespace {

using wire_contract::glob_matches;

std::vector<ObjectId> chosen_from(const Snapshot& state, const std::function<bool(const ObjectInfo&)>& is_meant) {
  std::vector<ObjectId> chosen;
  for (const auto& info : state.objects) {
    if (info && is_meant(*info)) chosen.push_back(info->id);
  }
  return chosen;
}

Refusal unknown_group(const Snapshot& state, const std::string& what, const std::string& text) {
  std::vector<std::string_view> names;
  std::set<std::string_view> scenes;
  for (const auto& info : state.objects) {
    if (!info) continue;
    names.push_back(info->name);
    if (!info->rare->scene.empty()) scenes.insert(info->rare->scene);
  }
  if (text.find_first_of("*?[") == std::string::npos) {
    const std::string loaded = scenes.empty() ? "" : fmt::format("; scenes: {}", fmt::join(scenes, ", "));
    return {what + ": " + unknown_object(text, names) + loaded};
  }
  std::string sentence =
      fmt::format("{}: no object's name matches {} ({} objects)", what, printable(text), names.size());
  const std::vector<std::string> near = nearest_words(text, names, 3);
  if (!near.empty()) sentence += fmt::format("; nearest names: {}", fmt::join(near, ", "));
  return {sentence};
}

}  // namespace

std::variant<std::vector<ObjectId>, Refusal> objects_meant(const Snapshot& state, const std::string& what,
                                                           const std::string& text, const std::string& skip) {
  const auto is_left_out = [&](const ObjectInfo& info) { return !skip.empty() && glob_matches(skip, info.name); };
  std::vector<ObjectId> meant = chosen_from(state, [&](const ObjectInfo& info) { return info.name == text; });
  if (meant.empty()) meant = chosen_from(state, [&](const ObjectInfo& info) { return info.rare->scene == text; });
  if (meant.empty()) meant = chosen_from(state, [&](const ObjectInfo& info) { return glob_matches(text, info.name); });
  if (meant.empty()) return unknown_group(state, what, text);
  std::erase_if(meant, [&](ObjectId id) { return is_left_out(*state.objects[slot_of(id)]); });
  if (meant.empty())
    return Refusal{fmt::format("{}: all of {} is left out by skip {}", what, printable(text), printable(skip))};
  return meant;
}

std::vector<ObjectId> all_others(const Snapshot& state, const std::vector<ObjectId>& those, const std::string& skip) {
  const std::unordered_set<ObjectId> left_out(those.begin(), those.end());
  return chosen_from(state, [&](const ObjectInfo& info) {
    return !left_out.contains(info.id) && (skip.empty() || !glob_matches(skip, info.name));
  });
}

}  // namespace collided::engine::service
