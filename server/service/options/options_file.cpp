#include "server/service/options/options_file.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <optional>
#include <toml++/toml.h>

#include "idl/outside_text.hpp"
#include "server/service/questions/nearest_word.hpp"
#include "server/service/questions/validation.hpp"
#include "server/service/options/options.hpp"

namespace collided::engine::service {
namespace {

/// "server.threads" -> {"server", "threads"}
std::pair<std::string, std::string> split_key(const std::string& key) {
  const std::size_t dot = key.find('.');
  return {key.substr(0, dot), key.substr(dot + 1)};
}

[[noreturn]] void refuse(const std::string& path, const toml::source_position& where, const std::string& what) {
  throw OptionsError(fmt::format("{} line {}, column {}: {}", path, where.line, where.column, what));
}

/// The tables that settings are in.
std::vector<std::string> known_tables() {
  std::vector<std::string> tables;
  for (const Setting& setting : settings()) {
    std::string table = split_key(setting.key).first;
    if (tables.empty() || tables.back() != table) tables.push_back(std::move(table));
  }
  return tables;
}

std::vector<std::string> known_keys(const std::string& table) {
  std::vector<std::string> keys;
  for (const Setting& setting : settings()) {
    auto [its_table, key] = split_key(setting.key);
    if (its_table == table) keys.push_back(std::move(key));
  }
  return keys;
}

std::optional<std::string> text_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* whole = node.as_integer()) return std::to_string(whole->get());
  if (const auto* truth = node.as_boolean()) return truth->get() ? "true" : "false";
  if (const auto* number = node.as_floating_point()) return fmt::format("{}", number->get());
  return std::nullopt;
}

FileValue read_value(const std::string& path, const Setting& setting, const toml::node& node) {
  FileValue value;
  value.key = setting.key;
  value.place = fmt::format("{}:{}", path, node.source().begin.line);
  if (const toml::array* list = node.as_array()) {
    if (!setting.many)
      refuse(path, node.source().begin, fmt::format("'{}' is a list; one value is allowed", setting.key));
    for (const toml::node& item : *list) {
      const std::optional<std::string> text = text_of(item);
      if (!text) refuse(path, item.source().begin, fmt::format("'{}' holds something else than text", setting.key));
      value.values.push_back(*text);
    }
    return value;
  }
  const std::optional<std::string> text = text_of(node);
  if (!text) refuse(path, node.source().begin, fmt::format("'{}' is neither text nor a number", setting.key));
  value.values.push_back(*text);
  return value;
}

void read_table(const std::string& path, const std::string& name, const toml::table& table,
                std::vector<FileValue>& values) {
  const std::vector<std::string> keys = known_keys(name);
  for (const auto& [key, node] : table) {
    const std::string full = name + "." + std::string(key.str());
    const auto setting = std::find_if(settings().begin(), settings().end(),
                                      [&](const Setting& candidate) { return candidate.key == full; });
    if (setting == settings().end()) {
      refuse(path, key.source().begin,
             fmt::format("unknown key {} in [{}]{}", printable(key.str()), name, did_you_mean(key.str(), keys)));
    }
    values.push_back(read_value(path, *setting, node));
  }
}

std::string text_of_file(const std::string& path) {
  constexpr std::size_t kMostBytes = 1 << 20;
  std::ifstream file(path, std::ios::binary);
  if (!file) throw OptionsError(path + ": File could not be opened for reading");
  // One byte more than allowed, so that a longer file is detected.
  std::string text(kMostBytes + 1, '\0');
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) throw OptionsError(path + ": it cannot be read");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kMostBytes) throw OptionsError(fmt::format("{}: it has more than {} bytes", path, kMostBytes));
  return text;
}

/// toml++ makes a nested table of each dot in a key, and calls itself once for each of them.
void refuse_deep_keys(const std::string& path, std::string_view text) {
  constexpr std::size_t kMostDots = 64;
  std::size_t dots = 0, line = 1;
  for (const char c : text) {
    line += c == '\n' ? 1 : 0;
    if (std::string_view("=,[]{}\n").find(c) != std::string_view::npos) dots = 0;
    else if (c == '.' && ++dots > kMostDots)
      throw OptionsError(fmt::format("{} line {}: more than {} dots in one word", path, line, kMostDots));
  }
}

}  // namespace

std::vector<FileValue> read_options_file(const std::string& path) {
  const std::string text = text_of_file(path);
  refuse_deep_keys(path, text);
  toml::table file;
  try {
    file = toml::parse(text, path);
  } catch (const toml::parse_error& error) {
    const toml::source_position where = error.source().begin;
    if (where.line == 0) throw OptionsError(fmt::format("{}: {}", path, error.description()));
    refuse(path, where, std::string(error.description()));
  }
  const std::vector<std::string> tables = known_tables();
  std::vector<FileValue> values;
  for (const auto& [key, node] : file) {
    const std::string name(key.str());
    const toml::table* table = node.as_table();
    if (!table) {
      refuse(path, key.source().begin,
             fmt::format("key {} stands outside of a table such as [server]", printable(name)));
    }
    if (std::find(tables.begin(), tables.end(), name) == tables.end()) {
      refuse(path, key.source().begin,
             fmt::format("unknown table [{}]{}", wire_contract::shown(name), did_you_mean(name, tables)));
    }
    read_table(path, name, *table, values);
  }
  return values;
}

}  // namespace collided::engine::service
