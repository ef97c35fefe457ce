#include "tests/oracle/exact_data.hpp"

#include <cstdio>
#include <cstdlib>
#include <memory>
#include <sstream>
#include <stdexcept>

namespace collided::oracle {

namespace fs = std::filesystem;

fs::path exact_data() {
  const char* given = std::getenv("COLLIDED_DATA");
  const fs::path root = fs::path(__FILE__).parent_path().parent_path().parent_path();
  const fs::path folder = (given != nullptr ? fs::path(given) : root.parent_path() / "shared" / "data") / "exact";
  return fs::is_directory(folder) ? folder : fs::path();
}

std::size_t Table::column(const std::string& title) const {
  for (std::size_t i = 0; i < header.size(); ++i) {
    if (header[i] == title) return i;
  }
  throw std::runtime_error("no column '" + title + "'");
}

Table read_table(const fs::path& file) {
  const bool packed = file.extension() == ".gz";
  const std::string command = (packed ? "gzip -dc '" : "cat '") + file.string() + "'";
  const auto close = [](FILE* f) { pclose(f); };
  const std::unique_ptr<FILE, decltype(close)> pipe(popen(command.c_str(), "r"), close);
  std::string text;
  char buffer[65536];
  for (std::size_t size; pipe && (size = std::fread(buffer, 1, sizeof buffer, pipe.get())) > 0;)
    text.append(buffer, size);
  Table table;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line);) {
    std::vector<std::string> cells;
    std::istringstream stream(line);
    for (std::string cell; std::getline(stream, cell, ',');) cells.push_back(cell);
    if (table.header.empty()) table.header = cells;
    else table.rows.push_back(cells);
  }
  if (table.rows.empty()) throw std::runtime_error("nothing in " + file.string());
  return table;
}

}  // namespace collided::oracle
