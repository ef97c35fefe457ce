#include "server/intake/readers/srdf.hpp"

#include <fmt/format.h>

#include <pugixml.hpp>
#include <unordered_map>

#include "server/intake/readers/reading.hpp"

namespace collided::engine {

LinkPairs read_srdf(const std::string& text, const std::string& file) {
  pugi::xml_document document;
  const pugi::xml_parse_result parsed = document.load_buffer(text.data(), text.size());
  if (!parsed)
    throw LoadError(fmt::format("{}: byte {}: {}. Nothing was loaded.", file, parsed.offset, parsed.description()));
  const pugi::xml_node robot = document.child("robot");
  if (!robot) throw LoadError(fmt::format("{}: no <robot> in it. Nothing was loaded.", file));
  // Both kinds of file have a <robot>; a file that describes the links themselves would silently allow no pairs.
  if (robot.child("link") || robot.child("joint"))
    throw LoadError(
        fmt::format("{}: it describes links and joints, so it is a URDF file; --srdf takes an SRDF file, with "
                    "<disable_collisions>. Nothing was loaded.",
                    file));
  LinkPairs pairs;
  for (const pugi::xml_node pair : robot.children("disable_collisions")) {
    pairs.emplace_back(pair.attribute("link1").value(), pair.attribute("link2").value());
  }
  return pairs;
}

std::uint64_t allow_pairs(const LinkPairs& pairs, Scene& scene) {
  std::unordered_map<std::string_view, std::uint32_t> number_of;
  for (SceneObject& object : scene.objects) {
    object.number = static_cast<std::uint32_t>(number_of.size());
    number_of.emplace(object.name, object.number);
  }
  std::vector<NumberPair> allowed;
  std::uint64_t unknown_count = 0;
  for (const auto& [one, other] : pairs) {
    const auto a = number_of.find(one);
    const auto b = number_of.find(other);
    if (a == number_of.end() || b == number_of.end()) ++unknown_count;
    else allowed.emplace_back(a->second, b->second);
  }
  scene.allowed_pairs = std::make_shared<const AllowedPairs>(std::move(allowed));
  return unknown_count;
}

}  // namespace collided::engine
