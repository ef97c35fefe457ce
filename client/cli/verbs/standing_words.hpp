#pragma once

#include <memory>
#include <string>
#include <vector>

#include <collided/client.hpp>

#include "client/cli/io.hpp"

namespace CLI {
class App;
}

namespace collided::cli {

/// How `add` reads a standing question of one form.
class StandingWords {
 public:
  virtual ~StandingWords() = default;
  /// Declares the options of this form alone.
  virtual void declare(CLI::App& app) = 0;
  /// Sets the question from the words, including the monitored objects for bands and the nearest. Throws Failure.
  ///
  /// words  all of the verb: "add", the name, and the rest
  virtual void read(const std::vector<std::string>& words, const Io& io, Standing& standing) const = 0;
};

/// "add dock box 0 0 0 5 5 3"
std::unique_ptr<StandingWords> region_words();
/// "add close 'drone*' 'person*' 5m,2m,50cm"
std::unique_ptr<StandingWords> bands_words();
/// "add escape 'door_*' person_7 20m", or a point instead of the object
std::unique_ptr<StandingWords> nearest_words();

}  // namespace collided::cli
