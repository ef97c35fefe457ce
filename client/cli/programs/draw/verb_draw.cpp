#include <filesystem>
#include <fstream>
#include <numbers>
#include <set>

#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/verbs/ask_options.hpp"
#include "client/draw/drawing/drawing.hpp"
#include "client/draw/drawing/standing_outlines.hpp"

namespace collided::cli {
namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kStyles[] = {"wireframe", "hidden-line", "obscured-line", "haloed", "toon", "hatched"};
constexpr std::size_t kMostContacts = 200;  // pairs whose points are requested
constexpr double kTerminalColumns = 78;

std::string after_dot(const std::string& path) {
  const std::size_t dot = path.rfind('.');
  return dot == std::string::npos ? std::string() : path.substr(dot + 1);
}

draw::Style style_of(const std::string& text) {
  for (std::size_t i = 0; i < std::size(kStyles); ++i) {
    if (text == kStyles[i]) return static_cast<draw::Style>(i);
  }
  throw bad_use(fmt::format("no style '{}'", text), "wireframe, hidden-line, obscured-line, haloed, toon or hatched");
}

class DrawCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "-o FILE", out_, "File to write: .svg or .png");
    app.add_flag("--term", term_, "A plan in the terminal, in braille");
    option(app, "--style NAME", style_, "wireframe, hidden-line (the usual), obscured-line, haloed, toon, hatched");
    option(app, "--from X Y Z", from_, "Where the eye is (above, left of the front)");
    option(app, "--at X Y Z", at_, "What it looks at (the middle)");
    option(app, "--up AXIS", up_, "What is up in the picture (0 0 1)");
    app.add_flag("--ortho", ortho_, "Parallel projection");
    option(app, "--fov ANGLE", fov_, "Field of view (as much as shows everything)");
    option(app, "--width N", width_, "Pixels (1200; with --term columns)");
    option(app, "--crease", Measure::angle, crease_rad_, "Draw edges sharper than this (30deg)");
    option(app, "--tones N", tones_, "Of the toon style (3)");
    option(app, "--light X Y Z", light_, "Direction towards the light");
    option(app, "--ray NUMBERS", rays_, "Ask this ray and draw it: X Y Z DX DY DZ; may be repeated")
        ->allow_extra_args(false);
    option(app, "--clearance GLOB", clearance_, "Colour objects of this name (glob) by their distance to the others");
    option(app, "--reach", Measure::length, reach_m_, "Distance at which that colour ends (1)");
    option(app, "--bands", bands_, "Steps of that colour (8)");
    app.add_flag("--no-contacts", no_contacts_, "Leave out the rings at contacts");
    app.add_flag("--no-fences", no_fences_,
                 "Leave out the dashed lines of standing questions (fences, margins, nearest)");
    option(app, "--only GLOB", ask_.only, "Draw objects whose name matches this glob");
    option(app, "--skip GLOB", ask_.skip, "Do not draw objects whose name matches this glob");
    option(app, "--mask", ask_.mask, "Layers that are drawn: bits, 0x3 or 0b11");
  }

  Exit run(Session& session, const Globals& globals) override {
    if (out_.empty() == !term_)
      throw bad_use("where to? -o FILE.svg, -o FILE.png or --term", "collide draw -o scene.svg");
    const std::string kind = after_dot(out_);
    if (!term_ && kind != "svg" && kind != "png") throw bad_use(fmt::format("'{}' is neither .svg nor .png", out_));
    draw::DrawOptions options = options_as_written();
    const std::vector<RayQuestion> rays_to_draw = ray_questions();
    ask_.timeout = std::max<std::chrono::nanoseconds>(timeout_of(globals), std::chrono::seconds(30));
    const auto start = Clock::now();
    Client& client = session.client(globals);
    const ShownObjects shown = take(client.shapes({.only = ask_.only,
                                                   .skip = ask_.skip,
                                                   .mask = ask_.mask,
                                                   .edges = true,
                                                   .crease_cosine = options.crease_cosine}));
    if (shown.objects.empty())
      throw Failure(Exit::no, "nothing to draw: no object matches", "collide ls shows what is there");
    if (options.clearance) measure(client, shown, ask_, *options.clearance);
    if (!no_contacts_ && !term_) options.contacts = contacts(client, shown, session, globals);
    if (!no_fences_) options.standing = standing_marks(client, shown, session, globals);
    draw::Rays rays(client, ask_);  // drawn objects also hide others
    try {
      options.ray_marks = ray_marks(rays, rays_to_draw, shown);
      const draw::Drawing drawing = draw::draw(shown, options, rays);
      write(session, globals, drawing, kind, rays, std::chrono::duration<double>(Clock::now() - start).count());
    } catch (const Error& error) { throw as_failure(error); }
    return Exit::yes;
  }

 private:
  draw::DrawOptions options_as_written() const {
    draw::DrawOptions options;
    options.style = style_of(style_);
    options.view.is_orthographic = ortho_ || term_;
    if (!from_.empty()) options.view.from = parse_vector(from_, Measure::length);
    if (!at_.empty()) options.view.at = parse_vector(at_, Measure::length);
    if (!up_.empty()) options.view.up = parse_vector(up_);
    if (options.view.up.isZero(0)) throw bad_use("--up 0 0 0 has no direction");
    if (!fov_.empty()) options.view.field_of_view_rad = parse_finite(fov_, Measure::angle);
    if (options.view.field_of_view_rad &&
        !(*options.view.field_of_view_rad > 0 && *options.view.field_of_view_rad < 3)) {
      throw bad_use("--fov " + fov_ + " is not between 0 and 171deg");
    }
    options.view.width_px = width_.empty() ? (term_ ? 2 * kTerminalColumns : 1200)
                                           : static_cast<double>(parse_count(width_, 1)) * (term_ ? 2 : 1);
    if (options.view.width_px < 16 || options.view.width_px > 4'000)
      throw bad_use("--width " + width_ + " is not from 16 to 4000");
    if (term_ && from_.empty()) plan_view(options.view);
    options.crease_cosine = std::cos(crease_rad_);
    options.tones = static_cast<int>(std::min<std::uint64_t>(parse_count(tones_, 2), 32));
    if (!light_.empty()) options.toward_light = parse_vector(light_);
    if (options.toward_light && options.toward_light->isZero(0)) throw bad_use("--light 0 0 0 has no direction");
    if (!clearance_.empty()) options.clearance = ramp();
    // Dots are farther apart than pixels.
    if (term_) options.sight.spacing_px = 0.5;
    return options;
  }

  /// Sets the view from above, with y up in the picture.
  static void plan_view(draw::View& view) {
    view.from = view.at.value_or(Vec3::Zero()) + Vec3(0, 0, 1);
    if (!view.at) view.at = Vec3::Zero();
    view.up = Vec3::UnitY();
  }

  draw::ClearanceRamp ramp() const {
    if (reach_m_ == 0) throw bad_use("--reach 0 is not above 0");
    return {.is_measured = {},
            .name_glob = clearance_,
            .reach_m = reach_m_,
            .bands = static_cast<int>(std::min<std::uint64_t>(bands_, 64))};
  }

  /// Finds the objects that are coloured by clearance. The server decides which names the glob matches.
  static void measure(Client& client, const ShownObjects& shown, const AskOptions& ask, draw::ClearanceRamp& ramp) {
    std::set<std::uint64_t> ids;
    for (const ShownObject& object : take(client.shapes({.only = ramp.name_glob, .mask = ask.mask})).objects)
      ids.insert(object.id);
    if (ids.empty()) throw Failure(Exit::no, fmt::format("--clearance: no object is named '{}'", ramp.name_glob));
    for (const ShownObject& object : shown.objects) ramp.is_measured.push_back(ids.contains(object.id) ? 1 : 0);
  }

  static std::vector<draw::ContactMark> contacts(Client& client, const ShownObjects& shown, Session& session,
                                                 const Globals& globals) {
    std::vector<draw::ContactMark> marks;
    const std::uint32_t count = take(client.status()).contacts;
    if (count == 0) return marks;
    std::set<std::string> names;
    for (const ShownObject& object : shown.objects) names.insert(object.name);
    Watch watch = take(client.watch());
    std::set<std::pair<std::string, std::string>> pairs;
    std::uint32_t heard = 0;
    const auto deadline = Clock::now() + std::chrono::seconds(1);
    while (heard < count && Clock::now() < deadline) {
      const std::optional<Event> event = watch.next(std::chrono::milliseconds(50));
      if (!event || event->kind != EventKind::open) continue;
      ++heard;
      if (names.contains(event->a) && names.contains(event->b)) pairs.emplace(event->a, event->b);
    }
    std::size_t asked = 0;
    for (const auto& [a, b] : pairs) {
      if (asked++ == kMostContacts) break;
      const Result<PairAnswer> pair = client.pair(a, b);
      if (!pair || pair->verdict != Verdict::hit) continue;  // they have separated since
      for (const ManifoldPoint& point : pair->manifold) marks.push_back({point.point, pair->normal, point.depth_m});
      if (pair->manifold.empty()) marks.push_back({pair->point, pair->normal, pair->depth_m});
    }
    if (pairs.size() > kMostContacts)
      print_hint(session.io, globals, fmt::format("{} of {} contacts are drawn", kMostContacts, pairs.size()));
    return marks;
  }

  /// Regions in the world, the regions and bands of drawn objects, and lines to the nearest.
  static std::vector<draw::StandingMark> standing_marks(Client& client, const ShownObjects& shown, Session& session,
                                                        const Globals& globals) {
    std::vector<draw::StandingMark> marks;
    const Result<std::vector<draw::StandingOutline>> outlines = draw::standing_outlines(client, true);
    if (!outlines) {
      print_hint(session.io, globals, "fences are not drawn: " + outlines.error().message);
      return marks;
    }
    for (const draw::StandingOutline& outline : *outlines) {
      const std::string& name = outline.carrier();
      const auto carrier = std::ranges::find(shown.objects, name, &ShownObject::name);
      if (!name.empty() && carrier == shown.objects.end()) continue;
      marks.push_back({.lines = draw::placed_lines(outline, name.empty() ? Pose{} : carrier->pose),
                       .is_held = outline.is_held(),
                       .is_endless = outline.is_endless()});
    }
    const Result<std::vector<draw::StandingOutline>> nearest = draw::nearest_outlines(client);
    if (!nearest) return marks;
    for (const draw::StandingOutline& outline : *nearest) {
      if (!outline.lines.empty()) marks.push_back({.lines = draw::placed_lines(outline, {}), .is_held = true});
    }
    return marks;
  }

  std::vector<RayQuestion> ray_questions() const {
    std::vector<RayQuestion> questions;
    for (const std::string& text : rays_) {
      const std::vector<double> n = parse_numbers({text}, Measure::length);
      if (n.size() != 6)
        throw bad_use(fmt::format("--ray {}: {} numbers; an origin and a direction are six", text, n.size()));
      questions.push_back({.origin = {n[0], n[1], n[2]}, .direction = {n[3], n[4], n[5]}});
      if (questions.back().direction.isZero(0)) throw bad_use(fmt::format("--ray {}: its direction is 0 0 0", text));
    }
    return questions;
  }

  static std::vector<draw::RayMark> ray_marks(draw::Rays& rays, const std::vector<RayQuestion>& questions,
                                              const ShownObjects& shown) {
    // A ray without a hit is drawn for the length of the scene.
    Eigen::AlignedBox3d bounds;
    for (const Vec3& p : draw::extreme_points(shown)) bounds.extend(p);
    const double far_m = bounds.isEmpty() ? 1 : bounds.diagonal().norm();
    std::vector<draw::RayMark> marks;
    const std::vector<Answer> answers = rays.first_hits(questions);
    for (std::size_t i = 0; i < answers.size(); ++i) {
      const bool is_hit = !answers[i].hits.empty();
      const Vec3 end = is_hit ? answers[i].hits.front().point
                              : Vec3(questions[i].origin + far_m * questions[i].direction.normalized());
      marks.push_back({questions[i].origin, end, is_hit});
    }
    return marks;
  }

  void write(Session& session, const Globals& globals, draw::Drawing drawing, const std::string& kind,
             const draw::Rays& rays, double seconds) const {
    if (term_) {
      session.io.out << draw::as_braille(drawing.picture);
      return;
    }
    drawing.picture.title = fmt::format("{} lines of a scene, {}", drawing.segments.size(), style_);
    const std::string bytes = kind == "svg" ? draw::as_svg(drawing.picture) : draw::as_png(drawing.picture);
    std::ofstream file(out_, std::ios::binary);
    file.write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    file.close();
    if (!file || bytes.empty()) throw Failure(Exit::bad_use, fmt::format("{}: could not be written", out_));
    std::set<std::uint32_t> lines;
    for (const draw::LineSegment& segment : drawing.segments) lines.insert(segment.line);
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) {
      printer.line(fmt::format("wrote {}  {} edges, {} kB, {} visibility rays in {:.1f} s, {} undecided", written_to(),
                               format_count(lines.size()), (bytes.size() + 999) / 1000, format_count(rays.asked()),
                               seconds, rays.undecided()));
    } else {
      printer.record({{"file", std::string_view(out_)},
                      {"edges", std::uint64_t{lines.size()}},
                      {"bytes", std::uint64_t{bytes.size()}},
                      {"rays", rays.asked()},
                      {"undecided", rays.undecided()},
                      {"bias", drawing.bias_m},
                      {"contacts", std::uint64_t{drawing.picture.rings.size() - ray_hits(drawing)}},
                      {"seconds", seconds}});
    }
    printer.finish();
  }

  static std::size_t ray_hits(const draw::Drawing& drawing) {
    return static_cast<std::size_t>(std::count_if(drawing.picture.rings.begin(), drawing.picture.rings.end(),
                                                  [](const draw::CircleMark& r) { return r.ink.name == "ray-hit"; }));
  }

  /// The absolute path, so that the file is found from any folder.
  std::string written_to() const { return std::filesystem::absolute(out_).lexically_normal().string(); }

  std::string out_;
  bool term_ = false;
  std::string style_ = "hidden-line";
  std::string from_;
  std::string at_;
  std::string up_;
  bool ortho_ = false;
  std::string fov_;
  std::string width_;
  double crease_rad_ = std::numbers::pi / 6;
  std::string tones_ = "3";
  std::string light_;
  std::vector<std::string> rays_;
  std::string clearance_;
  double reach_m_ = 1;
  std::uint64_t bands_ = 8;
  bool no_contacts_ = false;
  bool no_fences_ = false;
  AskOptions ask_;
};

}  // namespace

std::unique_ptr<Command> make_draw() { return std::make_unique<DrawCommand>(); }

}  // namespace collided::cli
