#pragma once

#include <string>

#include <CLI/CLI.hpp>

namespace collided::cli {

/// --solid and --solid=winding: meshes include their interior, and how to treat those that are not closed.
struct SolidFlag {
  std::string word = {};  // as given; "true" without a word; empty: not given

  void declare(CLI::App& app, const std::string& meaning) { app.add_flag("--solid", word, meaning); }
  bool is_given() const { return !word.empty(); }
  /// Throws Failure for another word.
  bool is_by_winding() const;
};

}  // namespace collided::cli
