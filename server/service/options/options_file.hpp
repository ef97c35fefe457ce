#pragma once

#include <string>
#include <vector>

namespace collided::engine::service {

/// One value of the file.
struct FileValue {
  std::string key;                  // "table.name", one of settings()
  std::vector<std::string> values;  // one, unless it is a list
  std::string place;                // "path:line"
};

/// Reads a TOML file of settings. Throws OptionsError with line, column and, for an unknown word, the nearest known
/// one.
std::vector<FileValue> read_options_file(const std::string& path);

}  // namespace collided::engine::service
