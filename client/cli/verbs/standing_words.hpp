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

/// How `add` reads what a standing question of one form asks.
class StandingWords {
 public:
  virtual ~StandingWords() = default;
  /// Declares the options that this form alone has.
  virtual void declare(CLI::App& app) = 0;
  /// Puts what the words ask into the question, and of bands and the nearest which objects it looks at. Throws Failure.
  ///
  /// words  all of the verb: "add", the name, and what follows
  virtual void read(const std::vector<std::string>& words, const Io& io, Standing& standing) const = 0;
};

/// "add dock box 0 0 0 5 5 3"
std::unique_ptr<StandingWords> region_words();
/// "add close 'drone*' 'person*' 5m,2m,50cm"
std::unique_ptr<StandingWords> bands_words();
/// "add escape 'door_*' person_7 20m", or a point in place of the object
std::unique_ptr<StandingWords> nearest_words();

}  // namespace collided::cli
