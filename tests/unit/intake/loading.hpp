#pragma once

#include <string>
#include <string_view>

#include "server/intake/readers/reading.hpp"

namespace collided::test {
using namespace engine;

struct Loaded {
  Scene scene;
  LoadReport report;
};

/// What the file's text loads as; throws as loading does.
inline Loaded load(const std::string& file, std::string_view bytes, const LoadOptions& options = {}) {
  Loaded loaded;
  loaded.scene = load_scene_from_memory({bytes.data(), bytes.size()}, file, options, loaded.report);
  return loaded;
}

/// The complaint of a load that must fail, or "loaded" when it does not.
inline std::string complaint(const std::string& file, std::string_view bytes, const LoadOptions& options = {}) {
  try {
    load(file, bytes, options);
  } catch (const LoadError& error) { return error.what(); }
  return "loaded";
}

/// A text of numbers as bytes: what a binary file holds.
template <class Number>
void append(std::string& bytes, Number value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(value));
}

}  // namespace collided::test
