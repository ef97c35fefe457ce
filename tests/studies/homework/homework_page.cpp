#include "tests/studies/homework/homework_page.hpp"

#include <sys/utsname.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numeric>
#include <sstream>

#include <fmt/format.h>

#include "tests/studies/plot/plot.hpp"
#include "client/draw/svg.hpp"

namespace collided::homework {
using namespace engine;
namespace {

using draw::Scale;
using report::Figure;

constexpr double kAll = 1e300;

std::string row(const std::vector<std::string>& cells, const char* tag = "td") {
  std::string html = "<tr>";
  for (const std::string& cell : cells) html += fmt::format("<{0} class=\"t\">{1}</{0}>", tag, draw::escaped(cell));
  return html + "</tr>\n";
}

std::string table(const std::vector<std::string>& heads, const std::vector<std::vector<std::string>>& rows) {
  std::string html = "<table><thead>" + row(heads, "th") + "</thead><tbody>\n";
  for (const auto& cells : rows) html += row(cells);
  return html + "</tbody></table>\n";
}

std::string text_of(const Slope& slope) {
  if (!slope.known()) return fmt::format("unknown ({} points)", slope.points);
  return fmt::format("{:.2f} +- {:.2f} ({} points)", slope.exponent, slope.half, slope.points);
}

bool is_ours(const std::string& method) { return method.starts_with("Collided"); }

double knob(const Point& p) { return p.sweep == Sweep::polygons ? static_cast<double>(p.polygons) : p.x; }

draw::Axis knob_axis(Sweep sweep) {
  static constexpr const char* kLabels[] = {"objects", "polygons of an object",
                                            "relative size: diameter over the cube's side"};
  return {.label = kLabels[static_cast<int>(sweep)], .scale = Scale::logarithmic};
}

std::vector<const Point*> points_of(const std::vector<Point>& points, Sweep sweep, const std::string& method,
                                    double most) {
  std::vector<const Point*> found;
  for (const Point& p : points) {
    if (p.sweep == sweep && p.method == method && p.x <= most) found.push_back(&p);
  }
  return found;
}

/// One line a method; of Collided also the 95th percentile, where `with_p95`.
std::string times_plot(const std::vector<Point>& points, Sweep sweep, double most, const std::string& title,
                       double Point::*value, const std::string& label, bool with_p95) {
  draw::Plot plot{.title = title, .x = knob_axis(sweep), .y = {.label = label, .scale = Scale::logarithmic}};
  for (const std::string& method : methods_of(points)) {
    draw::Series times{.name = method,
                       .paint = is_ours(method) ? draw::Paint::accent : draw::Paint::palette,
                       .dashed = method == "Collided, all polygons"};
    draw::Series p95{.name = "Collided, 95th percentile", .paint = draw::Paint::quiet, .joined = false, .hollow = true};
    for (const Point* p : points_of(points, sweep, method, most)) {
      times.points.push_back({knob(*p), p->*value});
      p95.points.push_back({knob(*p), p->p95_us});
    }
    plot.series.push_back(std::move(times));
    if (with_p95 && method == "Collided") plot.series.push_back(std::move(p95));
  }
  return draw::svg(plot);
}

std::string contacts_plot(const std::vector<Point>& points, Sweep sweep, double most) {
  draw::Plot plot{.title = "Contacts beside the time",
                  .x = knob_axis(sweep),
                  .y = {.label = "pairs of objects a frame, mean"},
                  .height = 300};
  plot.y.scale = Scale::logarithmic;
  const std::string first = points.front().method;
  draw::Series contacts{.name = "meet", .paint = draw::Paint::accent},
      candidates{.name = "candidates of Collided's coarse phase"};
  for (const Point* p : points_of(points, sweep, first, most)) {
    contacts.points.push_back({knob(*p), p->contacts});
    candidates.points.push_back({knob(*p), p->candidates});
  }
  plot.series = {contacts, candidates};
  return draw::svg(plot);
}

std::string points_table(const std::vector<Point>& points, Sweep sweep, double most) {
  std::vector<std::vector<std::string>> rows;
  for (const Point& p : points) {
    if (p.sweep != sweep || p.x > most) continue;
    rows.push_back({fmt::format("{}", knob(p)), fmt::format("{:.3g}", p.problem.relative_size), p.method,
                    fmt::format("{}", p.repeats), fmt::format("{:.1f}", p.median_us), fmt::format("{:.1f}", p.p95_us),
                    fmt::format("{:.1f}", p.mean_us), fmt::format("{:.2f}", p.contacts),
                    p.polygon_pairs < 0 ? "-" : fmt::format("{:.1f}", p.polygon_pairs),
                    fmt::format("{:.1f}", p.candidates),
                    p.contacts > 0 ? fmt::format("{:.1f}", p.candidates / p.contacts) : "-", fmt::format("{}", p.wrong),
                    fmt::format("{}", p.first_wrong)});
  }
  return table({name(sweep), "size", "method", "repeats", "median us", "p95 us", "mean us", "object pairs",
                "polygon pairs", "candidates", "candidates / pairs", "wrong", "Collided wrong there"},
               rows);
}

Figure sweep_figure(const std::vector<Point>& points, Sweep sweep, double most, const std::string& id,
                    const std::string& title, const std::string& caption) {
  Figure figure{id, title, caption, ""};
  // The median is what a frame takes; the mean also holds the few frames in which something meets.
  figure.body = times_plot(points, sweep, most, title, &Point::median_us, "median time of a frame, us", true) +
                times_plot(points, sweep, most, "The same, mean", &Point::mean_us, "mean time of a frame, us", false) +
                contacts_plot(points, sweep, most);
  figure.rows = points_table(points, sweep, most);
  return figure;
}

Figure picture_figure(const std::filesystem::path& file, const std::string& id, const std::string& title) {
  std::ostringstream text;
  if (std::ifstream in(file); in) text << in.rdbuf();
  return {
      id, title,
      "Problem A over the real service: the spheres are a publisher's objects, the contacts the server's own events. "
      "A line leads from each contact's point along its normal; those in contact are filled.",
      text.str()};
}

Figure exponents_figure(const std::vector<Point>& points) {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& method : methods_of(points)) {
    rows.push_back({method, text_of(slope_of(points, Sweep::objects, method, 1, 50)),
                    text_of(slope_of(points, Sweep::objects, method, 50, kAll)),
                    text_of(slope_of(points, Sweep::polygons, method, 0, kAll)),
                    text_of(slope_of(points, Sweep::size, method, 0, 0.2)),
                    text_of(slope_of(points, Sweep::size, method, 0.2, kAll))});
  }
  return {
      "exponents", "Exponents",
      "time = c x^e, least squares on logarithms of the mean time of a frame, with the 95 % interval of e. The mean, "
      "since "
      "with few objects the median frame has no contact at all.",
      table({"method", "objects 1 to 50", "objects from 50 (same density)", "polygons", "size to 0.2", "size from 0.2"},
            rows)};
}

Figure claims_figure(const std::vector<Point>& points) {
  std::vector<std::vector<std::string>> rows;
  for (const Claim& claim : claims(points)) rows.push_back({claim.text, claim.method, claim.measured, claim.verdict});
  return {"claims", "The homework's claims, here",
          "True or false where the 95 % intervals say so. V-COLLIDE itself is not in Debian; Collided with all "
          "polygons answers its "
          "calls and stands in its place.",
          table({"claim", "method", "exponents", "here"}, rows)};
}

Figure agreement_figure(const std::vector<Point>& points) {
  std::vector<std::vector<std::string>> rows;
  for (const std::string& method : methods_of(points)) {
    std::size_t equal = 0, wrong = 0, first_wrong = 0, recordings = 0;
    for (const Point& p : points) {
      if (p.method != method) continue;
      equal += p.pairs_equal;
      wrong += p.wrong;
      first_wrong += p.first_wrong;
      ++recordings;
    }
    rows.push_back({method, fmt::format("{}", recordings), fmt::format("{}", equal), fmt::format("{}", wrong),
                    fmt::format("{}", first_wrong)});
  }
  return {
      "agreement", "Are the pairs the same",
      "All frames of all recordings. A pair that one has and Collided has not, or the other way round, is decided in "
      "rationals. FCL rounds in double and Bullet in single precision.",
      table({"method", "recordings", "object pairs equal to Collided's", "wrong", "Collided wrong"}, rows)};
}

Figure parts_figure(const Parts& p) {
  return {"parts", "Detection, determination, response",
          fmt::format("{} objects of {} polygons, size {:.3g}, {:.1f} contacts a frame: median microseconds of a "
                      "frame. Detection says which "
                      "objects meet, determination where and how deep, response what becomes of their velocities.",
                      p.problem.objects, p.problem.polygons, p.problem.relative_size, p.contacts),
          table({"part", "us a frame"}, {{"detection", fmt::format("{:.1f}", p.detection_us)},
                                         {"determination, on top", fmt::format("{:.1f}", p.determination_us)},
                                         {"response", fmt::format("{:.1f}", p.response_us)}})};
}

std::string first_match(const char* file, const std::string& key) {
  std::ifstream in(file);
  for (std::string line; std::getline(in, line);) {
    if (!line.starts_with(key)) continue;
    const std::size_t value = line.find_first_not_of(" \t=:\"", key.size());
    return value == std::string::npos ? "" : line.substr(value, line.find_last_not_of('"') + 1 - value);
  }
  return "unknown";
}

Figure environment_figure(const report::Provenance& from) {
  utsname system{};
  uname(&system);
  return {"environment", "Environment", "",
          table({"what", "here"},
                {{"operating system", first_match("/etc/os-release", "PRETTY_NAME") + ", kernel " + system.release},
                 {"processor", from.machine},
                 {"memory", first_match("/proc/meminfo", "MemTotal")},
                 {"graphics", std::filesystem::exists("/dev/dri") ? "a card, not used" : "none; not used"},
                 {"build", COLLIDED_HOMEWORK_BUILD},
                 {"commit", from.commit},
                 {"seed", fmt::format("{}", from.seed)},
                 {"time", "processor time of one thread"}})};
}

Figure lost_numbers_figure() {
  return {"lost", "What the original lacks", "",
          "<p>The transcript of the homework has no values in its figures 2 to 7, and its machine is of the year 2000. "
          "So only "
          "shapes are compared here (exponents, and which grows faster), never numbers.</p>\n"};
}

Claim decided(const std::string& text, const std::string& method, const std::string& measured, bool known, bool yes,
              bool no) {
  return {text, method, measured, !known ? "not decided" : yes ? "true" : no ? "false" : "not decided"};
}

/// The lower claim's exponent against the higher one's.
Claim smaller(const std::string& text, const std::string& method, const std::string& low_name, const Slope& low,
              const std::string& high_name, const Slope& high) {
  return decided(text, method, fmt::format("{} {}; {} {}", low_name, text_of(low), high_name, text_of(high)),
                 low.known() && high.known(), low.high() < high.low(), low.low() > high.high());
}

}  // namespace

std::vector<Claim> claims(const std::vector<Point>& points) {
  std::vector<Claim> all;
  const std::vector<std::string> methods = methods_of(points);
  for (const std::string& method : methods) {
    const Slope objects = slope_of(points, Sweep::objects, method, 1, 50);
    all.push_back(decided("more objects take more time (1 to 50)", method, text_of(objects), objects.known(),
                          objects.low() > 0, objects.high() <= 0));
  }
  for (const std::string& method : methods) {
    all.push_back(smaller("polygons matter less than objects", method, "polygons",
                          slope_of(points, Sweep::polygons, method, 0, kAll), "objects",
                          slope_of(points, Sweep::objects, method, 1, 50)));
  }
  for (const std::string& method : methods) {
    all.push_back(smaller("size bites from 0.2 on", method, "to 0.2", slope_of(points, Sweep::size, method, 0, 0.2),
                          "from 0.2", slope_of(points, Sweep::size, method, 0.2, kAll)));
  }
  const std::string v_collide = "Collided, all polygons", prototype = "simple prototype";
  for (const Sweep sweep : kSweeps) {
    const double most = sweep == Sweep::objects ? 50 : kAll;
    all.push_back(smaller(std::string("V-COLLIDE grows more slowly than the simple prototype: ") + name(sweep),
                          v_collide, "it", slope_of(points, sweep, v_collide, 0, most), "the prototype",
                          slope_of(points, sweep, prototype, 0, most)));
  }
  return all;
}

std::vector<Figure> homework_figures(const std::vector<Point>& points, const Parts& parts,
                                     const report::Provenance& from, const std::filesystem::path& pictures) {
  const std::string scene =
      "20 objects of 256 polygons and size 0.2 where nothing else is said; every method sees the same recorded frames. "
      "Where few objects meet, the median frame has no contact, and the prototype's median is that of its sphere tests "
      "alone; so the mean is drawn as well. ";
  return {
      picture_figure(pictures / "homework_1.svg", "picture1", "Problem A: spheres in a cube, early"),
      picture_figure(pictures / "homework_2.svg", "picture2", "Problem A: the same later"),
      sweep_figure(points, Sweep::objects, 50, "objects", "Time against the number of objects, 1 to 50", scene),
      sweep_figure(
          points, Sweep::objects, kAll, "many", "Time against the number of objects, on to 100,000",
          scene +
              "From 50 on the size shrinks so that the share of the cube that is filled stays. A curve that ends: a "
              "frame took more than 2 s, or the meshes' copies would have had more than 8 million triangles."),
      sweep_figure(points, Sweep::polygons, kAll, "polygons", "Time against the number of polygons of an object",
                   scene),
      sweep_figure(points, Sweep::size, kAll, "size", "Time against the relative size", scene),
      exponents_figure(points),
      claims_figure(points),
      agreement_figure(points),
      parts_figure(parts),
      environment_figure(from),
      lost_numbers_figure()};
}

void write_points(const std::filesystem::path& file, const std::vector<Point>& points, const report::Provenance& from) {
  std::ofstream out(file);
  out << "sweep,x,objects,polygons,size,method,repeats,median_us,p95_us,mean_us,contacts,candidates,polygon_pairs,"
         "pairs_equal,wrong,"
         "first_wrong,seed,machine,build,commit\n";
  for (const Point& p : points) {
    out << fmt::format("{},{},{},{},{},\"{}\",{},{},{},{},{},{},{},{},{},{},{},\"{}\",\"{}\",{}\n", name(p.sweep), p.x,
                       p.problem.objects, p.polygons, p.problem.relative_size, p.method, p.repeats, p.median_us,
                       p.p95_us, p.mean_us, p.contacts, p.candidates, p.polygon_pairs, p.pairs_equal, p.wrong,
                       p.first_wrong, p.problem.seed, from.machine, COLLIDED_HOMEWORK_BUILD, from.commit);
  }
}

}  // namespace collided::homework
