#include "tests/oracle/moving_data.hpp"

#include <gmpxx.h>

#include <algorithm>
#include <cstdlib>
#include <optional>

#include "tests/oracle/exact_data.hpp"

namespace collided::oracle {
using namespace engine;

namespace fs = std::filesystem;

ExactResult ask(const MovingQuery& query, double width, TimeBracket& bracket) {
  const auto& p = query.point;
  if (query.edge_edge) return first_contact(MovingSegment{p[0], p[1]}, MovingSegment{p[2], p[3]}, width, bracket);
  return first_contact(p[0], MovingTriangle{p[1], p[2], p[3]}, width, bracket);
}

namespace {

std::optional<double> as_double(const std::string& numerator, const std::string& denominator) {
  mpq_class exact{mpz_class(numerator), mpz_class(denominator)};
  exact.canonicalize();
  const double value = exact.get_d();
  if (mpq_class(value) != exact) return std::nullopt;
  return value;
}

/// Eight rows a query: the four points at 0, then at 1.
std::optional<MovingQuery> query_of(const std::vector<std::vector<std::string>>& rows, std::size_t first) {
  MovingQuery query;
  query.point.resize(4);
  for (std::size_t row = 0; row < 8; ++row) {
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const auto value = as_double(rows[first + row][2 * axis], rows[first + row][2 * axis + 1]);
      if (!value) return std::nullopt;
      MovingPoint& p = query.point[row % 4];
      (row < 4 ? p.start : p.end)[static_cast<Eigen::Index>(axis)] = *value;
    }
  }
  query.hit = rows[first].at(6) == "1";
  return query;
}

}  // namespace

std::vector<MovingQuery> rational_queries(int& not_doubles) {
  not_doubles = 0;
  std::vector<MovingQuery> queries;
  if (exact_data().empty()) return queries;
  std::vector<fs::path> files;
  for (const auto& entry : fs::recursive_directory_iterator(exact_data().parent_path() / "ccd_queries")) {
    if (entry.path().extension() == ".gz") files.push_back(entry.path());
  }
  std::sort(files.begin(), files.end());
  for (const fs::path& file : files) {
    Table table = read_table(file);
    table.rows.insert(table.rows.begin(), table.header);  // these files start with data
    for (std::size_t first = 0; first + 8 <= table.rows.size(); first += 8) {
      auto query = query_of(table.rows, first);
      if (!query) {
        ++not_doubles;
        continue;
      }
      query->edge_edge = file.parent_path().filename() == "edge-edge";
      query->name = file.string() + "#" + std::to_string(first / 8);
      queries.push_back(std::move(*query));
    }
  }
  return queries;
}

std::vector<MovingQuery> timed_queries() {
  std::vector<MovingQuery> queries;
  if (exact_data().empty()) return queries;
  for (const char* name : {"edge-edge", "vertex-face", "generated-edge-edge", "generated-vertex-face"}) {
    const Table table = read_table(exact_data() / "ccd" / (std::string(name) + ".csv.gz"));
    const std::size_t first = table.column("p00_x");
    for (const auto& row : table.rows) {
      MovingQuery query;
      query.point.resize(4);
      for (std::size_t i = 0; i < 24; ++i) {
        MovingPoint& p = query.point[i / 3 % 4];
        (i < 12 ? p.start : p.end)[static_cast<Eigen::Index>(i % 3)] = std::strtod(row[first + i].c_str(), nullptr);
      }
      query.edge_edge = std::string(name).ends_with("edge-edge");
      query.hit = row[table.column("hit")] == "1";
      query.timed = query.hit;
      query.truth = {std::strtod(row[table.column("toi_lo")].c_str(), nullptr),
                     std::strtod(row[table.column("toi_hi")].c_str(), nullptr)};
      query.name = std::string(name) + " " + row[0] + " " + row[1];
      queries.push_back(std::move(query));
    }
  }
  return queries;
}

}  // namespace collided::oracle
