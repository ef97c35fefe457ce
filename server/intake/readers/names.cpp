#include "server/intake/readers/names.hpp"

#include <fmt/format.h>

#include <unordered_map>
#include <unordered_set>
#include <utility>

#include "server/intake/limits.hpp"

namespace collided::engine {
namespace {

/// The number of bytes of the UTF-8 character at the beginning of the text; 0 if there is none. Overlong forms,
/// surrogates and codes beyond U+10FFFF are not characters (RFC 3629).
std::size_t character_bytes(std::string_view text) {
  const auto byte = [&](std::size_t i) { return i < text.size() ? static_cast<unsigned char>(text[i]) : 0u; };
  const auto follows = [&](std::size_t i) { return (byte(i) & 0xc0u) == 0x80u; };
  if (byte(0) < 0x80) { return 1; }
  if (byte(0) >= 0xc2 && byte(0) <= 0xdf && follows(1)) { return 2; }
  if ((byte(0) & 0xf0u) == 0xe0 && follows(1) && follows(2)) {
    const bool is_overlong = byte(0) == 0xe0 && byte(1) < 0xa0;
    const bool is_surrogate = byte(0) == 0xed && byte(1) >= 0xa0;
    return is_overlong || is_surrogate ? 0 : 3;
  }
  if (byte(0) >= 0xf0 && byte(0) <= 0xf4 && follows(1) && follows(2) && follows(3)) {
    const bool is_overlong = byte(0) == 0xf0 && byte(1) < 0x90;
    const bool is_beyond = byte(0) == 0xf4 && byte(1) >= 0x90;
    return is_overlong || is_beyond ? 0 : 4;
  }
  return 0;
}

bool is_control(char c) { return (c >= 0 && c < ' ') || c == 0x7f; }

std::string cut_to(std::string name, std::size_t byte_limit) {
  if (name.size() > byte_limit) {
    while (byte_limit > 0 && (static_cast<unsigned char>(name[byte_limit]) & 0xc0u) == 0x80u) { --byte_limit; }
    name.resize(byte_limit);
  }
  return name;
}

/// Makes names unique.
class UniqueNames {
 public:
  std::string take(const std::string& name) {
    if (taken_.insert(name).second) { return name; }
    std::uint64_t& number = last_numbers_[name];
    number = number == 0 ? 1 : number;
    for (;;) {
      const std::string ending = fmt::format("#{}", ++number);
      std::string candidate = cut_to(name, kMaxNameBytes - ending.size()) + ending;
      if (taken_.insert(candidate).second) { return candidate; }
    }
  }

 private:
  std::unordered_set<std::string> taken_;
  std::unordered_map<std::string, std::uint64_t> last_numbers_;
};

void tell_mended(const Reading& reading, std::uint64_t count, const std::string& sentence) {
  if (count == 0) { return; }
  if (reading.options.strict) { refuse(reading, fmt::format("{} {}", count, sentence)); }
  reading.report.mended.push_back(fmt::format("{} {}", count, sentence));
}

}  // namespace

std::string flaw_of_name(std::string_view name) {
  if (name.empty()) { return "is empty"; }
  if (name.size() > kMaxNameBytes) { return fmt::format("has {} bytes, limit {}", name.size(), kMaxNameBytes); }
  for (std::size_t i = 0; i < name.size();) {
    const std::size_t length = character_bytes(name.substr(i));
    if (length == 0) { return fmt::format("is not UTF-8 at byte {}", i); }
    if (is_control(name[i])) { return fmt::format("has a control character at byte {}", i); }
    i += length;
  }
  return {};
}

std::string mended_name(std::string_view name) {
  std::string good;
  for (std::size_t i = 0; i < name.size();) {
    const std::size_t length = character_bytes(name.substr(i));
    if (length == 0 || is_control(name[i])) {
      good += '?';
      ++i;
    } else {
      good += name.substr(i, length);
      i += length;
    }
  }
  return cut_to(std::move(good), kMaxNameBytes);
}

void name_parts(const Reading& reading, Scene& scene) {
  const std::uint64_t empty_count =
      std::erase_if(scene.parts, [](const Part& part) { return part.triangle_count == 0; });
  const bool is_alone = scene.parts.size() + scene.objects.size() == 1;
  std::uint64_t changed_count = 0;
  std::uint64_t numbered_count = 0;
  UniqueNames names;
  const auto take = [&](std::string& own) {
    std::string name = scene.name;
    if (!own.empty() || !is_alone) { name = fmt::format("{}/{}", scene.name, own.empty() ? "unnamed" : own); }
    const std::string fit = mended_name(name);
    changed_count += fit == name ? 0 : 1;
    own = names.take(fit);
    numbered_count += own == fit ? 0 : 1;
  };
  for (Part& part : scene.parts) take(part.name);
  for (SceneObject& object : scene.objects) take(object.name);
  if (empty_count > 0) {
    reading.report.refused.push_back(fmt::format("{} parts without triangles left out", empty_count));
  }
  tell_mended(reading, changed_count,
              "names were not UTF-8 of at most 255 bytes; what did not fit was replaced by '?'");
  tell_mended(reading, numbered_count, "names stood there before and got '#2', '#3', ...");
}

void rename_scene(const Reading& reading, Scene& scene, const std::string& new_name) {
  if (new_name == scene.name) { return; }
  const std::string old_name = std::exchange(scene.name, new_name);
  const auto renamed = [&](const std::string& name) {
    return name == old_name || name.starts_with(old_name + "/") ? new_name + name.substr(old_name.size()) : name;
  };
  std::uint64_t changed_count = 0;
  std::uint64_t numbered_count = 0;
  UniqueNames names;
  const auto rename = [&](std::string& name) {
    const std::string wanted = renamed(name);
    const std::string fit = mended_name(wanted);
    name = names.take(fit);
    changed_count += fit == wanted ? 0 : 1;
    numbered_count += name == fit ? 0 : 1;
  };
  for (Part& part : scene.parts) { rename(part.name); }
  for (SceneObject& object : scene.objects) { rename(object.name); }
  tell_mended(reading, changed_count, "names were longer than 255 bytes under the new scene name and were cut");
  tell_mended(reading, numbered_count, "names stood there before and got '#2', '#3', ...");
}

}  // namespace collided::engine
