// response_study: methods of response beside their references, as rows.
#include <fstream>
#include <iostream>

#include <CLI/CLI.hpp>

#include "tests/response/response_study.hpp"

int main(int argc, char** argv) {
  CLI::App app("Energy drift, penetration, error and time of every response method, by stiffness and step.");
  collided::response::StudyOptions options;
  std::string file = "-";
  app.add_option("--csv", file, "Where to write; - is the standard output")->capture_default_str();
  app.add_option("--seed", options.seed, "Of the starts")->capture_default_str();
  app.add_option("--starts", options.starts, "Starts a row, of which the worst counts")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--steps", options.steps_s, "Lengths of a step, s")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);

  const std::vector<collided::response::ResponseRow> rows = collided::response::response_rows(options);
  if (file == "-") {
    write_csv(std::cout, rows);
    return 0;
  }
  std::ofstream out(file);
  write_csv(out, rows);
  out.close();
  if (!out) {
    std::cerr << file << ": cannot be written\n";
    return 2;
  }
  std::cout << rows.size() << " rows, seed " << options.seed << ", in " << file << "\n";
  return 0;
}
