#include "server/service/options/options.hpp"

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <map>

#include "idl/outside_text.hpp"
#include "server/service/questions/nearest_word.hpp"
#include "server/service/options/options_file.hpp"
#include "server/service/options/quantities.hpp"

namespace collided::engine::service {
namespace {

/// The command line, parsed but not checked.
struct Flags {
  std::map<std::string, std::string> values;  // by flag
  std::vector<std::string> scenes;
  std::string config;
};

std::vector<std::string> known_flags() {
  std::vector<std::string> flags{"--config", "--check-config", "--print-config", "--once", "--version", "--help"};
  for (const Setting& setting : settings()) {
    if (*setting.flag) flags.emplace_back(setting.flag);
  }
  return flags;
}

/// Whether a text such as "-.5" or "-1,0,0:1,1,1" begins with a number.
bool starts_as_number(const std::string& text) { return is_number(text.substr(0, text.find_first_of(",:"))); }

/// Joins a number to the flag before it: "--unit -.5" becomes "--unit=-.5". A number is never an option, so the error
/// message is about the value.
std::vector<std::string> join_numbers(const std::vector<std::string>& arguments) {
  std::vector<std::string> joined;
  for (const std::string& argument : arguments) {
    const bool after_flag =
        !joined.empty() && joined.back().starts_with("--") && joined.back().find('=') == std::string::npos;
    if (after_flag && argument.starts_with('-') && starts_as_number(argument)) {
      joined.back() += "=" + argument;
    } else {
      joined.push_back(argument);
    }
  }
  return joined;
}

void add_flags(CLI::App& app, Options& options, Flags& flags) {
  app.set_help_flag();
  app.allow_extras();
  app.add_option("scenes", flags.scenes);
  app.add_option("--config", flags.config);
  app.add_flag("--check-config", options.check_config);
  app.add_flag("--print-config", options.print_config);
  app.add_flag("--once", options.once);
  app.add_flag("--version", options.show_version);
  app.add_flag("-h,--help", options.show_help);
  for (const Setting& setting : settings()) {
    if (!*setting.flag) continue;
    if (*setting.value) app.add_option(setting.flag, flags.values[setting.flag]);
    else app.add_flag(setting.flag);
  }
}

Flags read_flags(const std::vector<std::string>& arguments, Options& options) {
  Flags flags;
  CLI::App app;
  add_flags(app, options, flags);
  // The parser takes its words in reverse order.
  std::vector<std::string> reversed = join_numbers(arguments);
  std::reverse(reversed.begin(), reversed.end());
  try {
    app.parse(reversed);
  } catch (const CLI::ParseError& error) { throw OptionsError(error.what()); }
  for (const std::string& extra : app.remaining()) {
    const std::string name = extra.substr(0, extra.find('='));
    throw OptionsError(
        fmt::format("unknown option {}{}", wire_contract::in_quotes(name), did_you_mean(name, known_flags())));
  }
  std::erase_if(flags.values, [&](const auto& flag) { return app.count(flag.first) == 0; });
  for (const Setting& setting : settings()) {
    const bool is_given = *setting.flag && !*setting.value && app.count(setting.flag) > 0;
    if (is_given) flags.values[setting.flag] = app.get_option(setting.flag)->results().back();
  }
  return flags;
}

std::vector<std::string> split_list(const std::string& text) {
  std::vector<std::string> items;
  std::size_t start = 0;
  while (start < text.size()) {
    const std::size_t comma = std::min(text.find(',', start), text.size());
    if (comma > start) items.push_back(text.substr(start, comma - start));
    start = comma + 1;
  }
  return items;
}

/// A setting's text from the source of the highest rank that has one.
Effective find_value(const Setting& setting, const Flags& flags, const std::vector<FileValue>& file,
                     const Environment& environment) {
  Effective found{.setting = &setting, .values = {}, .origin = "default"};
  const auto take = [&](const std::string& text, const std::string& origin) {
    found.values = setting.many ? split_list(text) : std::vector<std::string>{text};
    found.origin = origin;
  };
  if (std::string_view(setting.key) == "world.scenes" && !flags.scenes.empty()) {
    found.values = flags.scenes;
    found.origin = "flag SCENE";
    return found;
  }
  if (const auto flag = flags.values.find(setting.flag); flag != flags.values.end()) {
    take(flag->second, "flag " + flag->first);
    return found;
  }
  if (const char* text = environment(setting.variable)) {
    take(text, fmt::format("env {}", setting.variable));
    return found;
  }
  for (const FileValue& value : file) {
    if (value.key != setting.key) continue;
    found.values = value.values;
    found.origin = value.place;
    return found;
  }
  const char* ros = std::string_view(setting.key) == "dds.domain" ? environment("ROS_DOMAIN_ID") : nullptr;
  if (ros && *ros) {
    take(ros, "env ROS_DOMAIN_ID");
  } else {
    take(setting.fallback, "default");
  }
  return found;
}

std::string joined(const std::vector<std::string>& values) { return fmt::format("{}", fmt::join(values, ",")); }

void apply(const Effective& effective, Options& options, const ApplyFleetSetting& fleet) {
  const Setting& setting = *effective.setting;
  const std::optional<std::string> allowed =
      setting.apply != nullptr ? setting.apply(options, effective.values) : fleet(options, setting, effective.values);
  if (!allowed) return;
  throw OptionsError(fmt::format("{} is {}; allowed: {} (from {})", setting.key,
                                 wire_contract::in_quotes(joined(effective.values)), *allowed, effective.origin));
}

std::string in_quotes(const std::string& text) {
  std::string quoted_text = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') quoted_text += '\\';
    quoted_text += c;
  }
  return quoted_text + '"';
}

std::string toml_value(const Effective& effective) {
  if (effective.setting->many) {
    std::vector<std::string> items;
    for (const std::string& value : effective.values) items.push_back(in_quotes(value));
    return fmt::format("[{}]", fmt::join(items, ", "));
  }
  const std::string& text = effective.values[0];
  // Numbers and booleans are bare in TOML, all other texts in quotes.
  const bool bare = parse_whole(text).has_value() || text == "true" || text == "false";
  return bare ? text : in_quotes(text);
}

}  // namespace

ParsedOptions parse_options(const std::vector<std::string>& arguments, const Environment& environment,
                            const ApplyFleetSetting& fleet) {
  ParsedOptions parsed;
  const Flags flags = read_flags(arguments, parsed.options);
  if (parsed.options.show_help || parsed.options.show_version) return parsed;
  std::string config = flags.config;
  if (const char* path = environment("COLLIDED_CONFIG"); config.empty() && path) config = path;
  std::vector<FileValue> file;
  if (!config.empty()) file = read_options_file(config);
  for (const Setting& setting : settings()) {
    Effective effective = find_value(setting, flags, file, environment);
    // An empty variable or flag is a value like any other; only a list may be empty.
    if (effective.values.empty() && !setting.many) effective.values.emplace_back();
    apply(effective, parsed.options, fleet);
    parsed.effective.push_back(std::move(effective));
  }
  return parsed;
}

std::string print_config(const ParsedOptions& parsed) {
  std::string text;
  std::string table;
  for (const Effective& effective : parsed.effective) {
    const std::string key = effective.setting->key;
    const std::size_t dot = key.find('.');
    if (key.substr(0, dot) != table) {
      table = key.substr(0, dot);
      text += fmt::format("{}[{}]\n", text.empty() ? "" : "\n", table);
    }
    text += fmt::format("{:<40}# {}\n", fmt::format("{} = {}", key.substr(dot + 1), toml_value(effective)),
                        effective.origin);
  }
  return text;
}

std::string help_text() {
  std::string text =
      "collided — a collision query service on DDS\n\n"
      "  collided [SCENE...]              no argument: a small embedded scene\n\n"
      "Each option may also be a key of the --config file or a variable; flag before variable before file.\n\n";
  for (const Setting& setting : settings()) {
    const std::string flag =
        *setting.flag ? fmt::format("{} {}", setting.flag, setting.value) : std::string("SCENE...");
    text += fmt::format("  {:<18} {:<20} {:<22} {}\n", flag, setting.key, setting.variable, setting.help);
  }
  text +=
      "  --config FILE                           COLLIDED_CONFIG        TOML\n"
      "  --print-config     what is in effect, and where each value came from\n"
      "  --check-config     check all of it and that scene files can be read; start nothing\n"
      "  --once             load, compare answers with brute force, exit\n"
      "  --version\n";
  return text;
}

}  // namespace collided::engine::service
