#pragma once

#include <string>
#include <vector>

namespace collided::engine::service {

/// One value as the file writes it.
struct FileValue {
  std::string key;  // "table.name", one of settings()
  std::vector<std::string> values;
  std::string place;  // "path:line"
};

/// Reads a TOML file of settings. Throws OptionsError with line, column and what was probably meant.
std::vector<FileValue> read_options_file(const std::string& path);

}  // namespace collided::engine::service
