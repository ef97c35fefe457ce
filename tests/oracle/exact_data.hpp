#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace collided::oracle {

/// The folder of exact answers: $COLLIDED_DATA/exact, else shared/data/exact beside the repository; empty if absent.
std::filesystem::path exact_data();

/// A table with a header line, plain or gzipped.
struct Table {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;

  std::size_t column(const std::string& title) const;
};
Table read_table(const std::filesystem::path& file);

}  // namespace collided::oracle
