// response_study: methods of response beside their references, as rows.
#include <fstream>
#include <iostream>

#include <CLI/CLI.hpp>

#include "tests/studies/response/contact_study.hpp"
#include "tests/studies/response/response_study.hpp"

namespace {

template <typename Rows>
bool write(const std::string& file, const Rows& rows) {
  if (file == "-") {
    write_csv(std::cout, rows);
    return true;
  }
  std::ofstream out(file);
  write_csv(out, rows);
  out.close();
  if (!out) std::cerr << file << ": cannot be written\n";
  if (out) std::cout << rows.size() << " rows in " << file << "\n";
  return static_cast<bool>(out);
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App app("Energy drift, penetration, error and time of every response method, by stiffness and step.");
  collided::response::StudyOptions options;
  std::string file = "-";
  std::string contact_file;
  app.add_option("--csv", file, "Where to write; - is the standard output")->capture_default_str();
  app.add_option("--contact", contact_file,
                 "Where to write the study of one contact by four integrators; without it, it is left out");
  app.add_option("--seed", options.seed, "Of the starts")->capture_default_str();
  app.add_option("--starts", options.starts, "Starts a row, of which the worst counts")
      ->capture_default_str()
      ->check(CLI::PositiveNumber);
  app.add_option("--steps", options.steps_s, "Lengths of a step, s")->check(CLI::PositiveNumber);
  CLI11_PARSE(app, argc, argv);

  const bool is_written = write(file, collided::response::response_rows(options));
  if (contact_file.empty()) return is_written ? 0 : 2;
  return write(contact_file, collided::response::contact_rows({.seed = options.seed, .starts = options.starts + 1})) &&
                 is_written
             ? 0
             : 2;
}
