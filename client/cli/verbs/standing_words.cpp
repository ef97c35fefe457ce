#include "client/cli/verbs/standing_words.hpp"

#include <algorithm>
#include <cmath>

#include <fmt/format.h>

#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/input/shape_mesh.hpp"
#include "client/cli/verbs/ask_options.hpp"

namespace collided::cli {
namespace {

// ---- a region ------------------------------------------------------------------------------------------------------

constexpr const char* kRegionForms =
    "sphere X Y Z R, box X Y Z X Y Z (two opposite corners), prism LOW HIGH X Y X Y X Y ...,\n"
    "plane X Y Z NX NY NZ (what lies behind it), mesh FILE, hull FILE";

Vec3 vector_at(const std::vector<double>& numbers, std::size_t first) {
  return {numbers[first], numbers[first + 1], numbers[first + 2]};
}

void need(std::string_view kind, const std::vector<double>& numbers, std::size_t count) {
  if (numbers.size() != count)
    throw bad_use(fmt::format("a {} takes {} numbers; {} given", kind, count, numbers.size()), kRegionForms);
}

Prism prism_of(const std::vector<double>& numbers) {
  if (numbers.size() < 8 || numbers.size() % 2 != 0)
    throw bad_use("a prism takes its low and high end and three corners X Y or more", kRegionForms);
  Prism prism{.corners = {}, .low_m = numbers[0], .high_m = numbers[1]};
  for (std::size_t i = 2; i < numbers.size(); i += 2) prism.corners.push_back({numbers[i], numbers[i + 1]});
  return prism;
}

/// Sets the region's shape from words such as "box 0 0 0 5 5 3".
void set_shape(const std::vector<std::string>& words, const MeshReading& reading, const Io& io, Region& region) {
  const std::string& kind = words.front();
  if (is_mesh_kind(kind)) {
    region.shape = {read_mesh_shape(words, reading, io)};
    return;
  }
  const std::vector<double> numbers = parse_numbers({words.begin() + 1, words.end()}, Measure::length);
  if (std::any_of(numbers.begin(), numbers.end(), [](double x) { return !std::isfinite(x); }))
    throw bad_use("a fence's numbers must be finite");
  if (kind == "sphere") {
    need(kind, numbers, 4);
    region.shape = {SphereShape{.radius_m = numbers[3], .center = vector_at(numbers, 0)}};
  } else if (kind == "box") {
    need(kind, numbers, 6);
    const Vec3 a = vector_at(numbers, 0);
    const Vec3 b = vector_at(numbers, 3);
    region.shape = {BoxShape{.half_m = (b - a).cwiseAbs() / 2, .center = (a + b) / 2}};
  } else if (kind == "plane") {
    need(kind, numbers, 6);
    region.shape = {HalfSpaceShape{.normal = vector_at(numbers, 3), .point = vector_at(numbers, 0)}};
  } else if (kind == "prism") {
    region.prism = prism_of(numbers);
  } else {
    throw bad_use(fmt::format("no region '{}'", kind), kRegionForms);
  }
}

class RegionWords : public StandingWords {
 public:
  void declare(CLI::App& app) override {
    option(app, "--to OBJECT", to_, "add: object that it moves along with; the numbers are in its frame");
    option(app, "--detect WORDS", detect_, "add: what it reports, of enter, exit and cross (all)")
        ->allow_extra_args(false)
        ->delimiter(',');
    declare_mesh_reading(app, reading_);
  }

  void read(const std::vector<std::string>& words, const Io& io, Standing& standing) const override {
    if (words.size() < 3) throw bad_use("a name and a region are needed", kRegionForms);
    Region region;
    region.to = to_;
    if (!detect_.empty()) region.enter = region.exit = region.cross = false;
    for (const std::string& word : detect_) {
      if (word == "enter") region.enter = true;
      else if (word == "exit") region.exit = true;
      else if (word == "cross") region.cross = true;
      else throw bad_use(fmt::format("--detect {}: a fence does not report that", word), "enter, exit, cross");
    }
    set_shape({words.begin() + 2, words.end()}, reading_, io, region);
    standing.of = std::move(region);
  }

 private:
  std::string to_;
  std::vector<std::string> detect_;
  MeshReading reading_;
};

// ---- bands ---------------------------------------------------------------------------------------------------------

/// The distances of "5m,2m,50cm", in metres.
std::vector<double> bands_of(const std::vector<std::string>& words) {
  std::vector<double> bands_m = parse_numbers(words, Measure::length);
  for (std::size_t i = 0; i < bands_m.size(); ++i) {
    if (!std::isfinite(bands_m[i]) || bands_m[i] < 0)
      throw bad_use(fmt::format("band {} is {} m; a finite distance, 0 or more, is needed", i + 1, bands_m[i]));
    if (i > 0 && !(bands_m[i] < bands_m[i - 1]))
      throw bad_use(
          fmt::format("band {}, {} m, is not less than the one before it, {} m", i + 1, bands_m[i], bands_m[i - 1]),
          "the widest comes first: 5m,2m,50cm");
  }
  if (bands_m.empty()) throw bad_use("a margin needs a distance", "collide margin add NAME GLOB GLOB 5m,2m,50cm");
  return bands_m;
}

class BandsWords : public StandingWords {
 public:
  void declare(CLI::App& app) override {
    option(app, "--hysteresis", Measure::length, bands_.hysteresis_m,
           "add: a pair within a band leaves it beyond the band plus this (0)");
    option(app, "--dwell", bands_.dwell, "add: a change is reported once it has lasted so long; contact at once (0)");
  }

  void read(const std::vector<std::string>& words, const Io&, Standing& standing) const override {
    if (words.size() < 5)
      throw bad_use("a name, two groups and distances are needed",
                    "collide margin add close 'drone*' 'person*' 5m,2m,50cm");
    Bands bands = bands_;
    bands.around = words[2];
    bands.bands_m = bands_of({words.begin() + 4, words.end()});
    standing.only = words[3];
    standing.of = std::move(bands);
  }

 private:
  Bands bands_;
};

// ---- the nearest ---------------------------------------------------------------------------------------------------

constexpr const char* kNearestForms =
    "collide nearest add escape 'door_*' person_7 20m, or collide nearest add yard 'truck_*' 4 0 1 50m";

class NearestWords : public StandingWords {
 public:
  void declare(CLI::App& app) override {
    option(app, "--hysteresis", Measure::length, nearest_.hysteresis_m,
           "add: another one must be nearer by more than this (0)");
  }

  void read(const std::vector<std::string>& words, const Io&, Standing& standing) const override {
    if (words.size() != 5 && words.size() != 7)
      throw bad_use("a name, a group, an object or point, and a distance are needed", kNearestForms);
    Nearest nearest = nearest_;
    if (words.size() == 5) {
      nearest.to = words[3];
    } else {
      nearest.point = Vec3(parse_finite(words[3], Measure::length), parse_finite(words[4], Measure::length),
                           parse_finite(words[5], Measure::length));
    }
    nearest.within_m = parse_finite(words.back(), Measure::length);
    if (!(nearest.within_m > 0)) throw bad_use("distance " + words.back() + ": more than 0 is needed", kNearestForms);
    standing.only = words[2];
    standing.of = std::move(nearest);
  }

 private:
  Nearest nearest_;
};

}  // namespace

std::unique_ptr<StandingWords> region_words() { return std::make_unique<RegionWords>(); }
std::unique_ptr<StandingWords> bands_words() { return std::make_unique<BandsWords>(); }
std::unique_ptr<StandingWords> nearest_words() { return std::make_unique<NearestWords>(); }

}  // namespace collided::cli
