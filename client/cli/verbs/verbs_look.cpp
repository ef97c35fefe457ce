#include <fmt/format.h>

#include "client/cli/command.hpp"
#include "client/cli/input/number.hpp"
#include "client/cli/input/option.hpp"
#include "client/cli/output/clock_text.hpp"
#include "client/cli/output/described_record.hpp"
#include "client/cli/output/figure_text.hpp"
#include "client/cli/server_command.hpp"
#include "client/library/connection/described_status.hpp"
#include "idl/answers/commands.hpp"
#include "idl/commands.hpp"
#include "client/cli/output/readable.hpp"

namespace collided::cli {
namespace {

namespace wire = wire_contract::command;

std::string json_text(const nlohmann::json& value) {
  return value.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
}

/// Prints the wings in a line; nothing for a server of an older version, which does not list them.
void print_wings(Printer& printer, const char* head, const std::vector<Wing>& wings) {
  std::string names;
  for (const Wing& wing : wings)
    names += (names.empty() ? "" : ", ") + printable(wing.name) + (wing.in_use ? " (in use)" : "");
  if (!names.empty()) printer.line(head + names);
}

class StatusCommand : public Command {
 public:
  void declare(CLI::App&) override {}

  Exit run(Session& session, const Globals& globals) override {
    const ConnectOptions options = connect_options(session.io, globals);
    const ServerStatus status = take(session.client(globals).status());
    const nlohmann::json covers = covers_of(session.client(globals));
    const std::optional<Figures> figures = figures_of(session.client(globals));
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) {
      print_text(printer, status, options.domain);
      if (figures) print_figures(printer, *figures);
      print_covers(printer, covers);
      if (figures) print_wings(printer, "wings  ", figures->wings);
      if (figures && figures->keeps_nothing)
        printer.line(
            printer.paint(Paint::doubt, "keeps nothing: what commands do is lost when the server ends (--state-dir)"));
      if (status.state == "recovering") print_losses(printer, session.client(globals));
    } else {
      Record all = record(status, options.domain);
      all.push_back({"in_doubt", figures ? Value(figures->pairs.in_doubt) : Value()});
      all.push_back({"cut_short", figures ? Value(figures->fences.cut_short) : Value()});
      all.push_back({"keeps_nothing", figures && figures->keeps_nothing});
      all.push_back({"tiles", figures ? Value(raw_json(json_of(figures->tiles))) : Value()});
      all.push_back({"wings", figures ? Value(raw_json(json_of(figures->wings))) : Value()});
      all.push_back({"covers", covers.is_null() ? Value() : Value(RawJson{covers.dump()})});
      printer.set_usual_fields({"state", "world", "scenes", "objects", "moving", "contacts", "undecided_answers"});
      printer.record(all);
    }
    printer.finish();
    return status.state == "ready" ? Exit::yes : Exit::no;
  }

 private:
  /// The covered space; null if none was stated, or if the server does not answer.
  static nlohmann::json covers_of(Client& client) {
    const Result<std::string> answer = client.command(wire::kCovers, "{}", {}, std::chrono::milliseconds(500));
    const nlohmann::json parsed = answer ? nlohmann::json::parse(*answer, nullptr, false) : nlohmann::json();
    const bool is_stated = parsed.is_object() && parsed.contains("covers") && parsed["covers"].is_array();
    return is_stated ? parsed["covers"] : nlohmann::json();
  }

  /// What is missing since a crash and must be accepted.
  static void print_losses(Printer& printer, Client& client) {
    const Result<std::string> answer =
        client.command(wire::kAcceptLoss, R"({"show": true})", {}, std::chrono::milliseconds(500));
    const nlohmann::json parsed = answer ? nlohmann::json::parse(*answer, nullptr, false) : nlohmann::json();
    for (const std::string& loss : texts_of(parsed, "losses"))
      printer.line(printer.paint(Paint::doubt, "missing: " + printable(loss) + " (collide accept-loss)"));
  }

  /// Nothing if the server does not answer.
  static std::optional<Figures> figures_of(Client& client) {
    const Result<std::string> answer = client.command(wire::kFigures, "{}", {}, std::chrono::milliseconds(500));
    return answer ? view::parse_figures(*answer) : std::nullopt;
  }

  static void print_figures(Printer& printer, const Figures& figures) {
    if (figures.pairs.in_doubt != 0)
      printer.line(printer.paint(Paint::doubt, format_count(figures.pairs.in_doubt) +
                                                   " pairs in doubt: neither known to touch nor to be apart"));
    if (const std::uint64_t count = figures.fences.cut_short; count != 0)
      printer.line(printer.paint(
          Paint::doubt,
          fmt::format(
              "{} search{} of fences ended at the limit: objects that came and went then may not have been reported",
              format_count(count), count == 1 ? "" : "es")));
    for (const HeldTiles& tiles : figures.tiles)
      printer.line(fmt::format("tiles of {}  {} of {} read  ·  {} of {} held", printable(tiles.scene),
                               format_count(tiles.read), format_count(tiles.of), format_count(tiles.triangles),
                               counted(tiles.triangles_of_file, "triangle")));
  }

  static void print_covers(Printer& printer, const nlohmann::json& covers) {
    if (covers.is_null()) return;
    if (covers.empty())
      printer.line(printer.paint(Paint::doubt, "nothing is covered: nothing is called free (load --covers)"));
    for (const nlohmann::json& box : covers) {
      const auto number = [](const nlohmann::json& x) {
        return x.is_number() ? format_number(x.get<double>()) : text_of_value(x);
      };
      std::string line = "covers";
      for (std::size_t i = 0; i < box.size(); ++i) line += (i == 3 ? " to " : " ") + number(box[i]);
      printer.line(line);
    }
  }
  static std::string text_of_value(const nlohmann::json& value) {
    return value.is_string() ? printable(value.get<std::string>()) : "?";
  }

  static void print_text(Printer& printer, const ServerStatus& status, int domain) {
    const bool is_well = status.state == "ready" && status.step_lasting < std::chrono::seconds(1);
    const Paint paint = is_well ? Paint::good : Paint::doubt;
    printer.line(fmt::format("collided {} pid {}  domain {}  namespace {}  {}", status.version_text, status.pid, domain,
                             printable(status.name_space), printer.paint(paint, state_text(status))));
    std::string scenes;
    for (const std::string& scene : status.scenes) scenes += (scenes.empty() ? "" : ", ") + printable(scene);
    printer.line(fmt::format("scene {}  {}  ·  {}, {} moving  ·  {}  ·  world {}", scenes.empty() ? "(none)" : scenes,
                             counted(status.static_triangles, "triangle"), counted(status.objects, "object"),
                             format_count(status.moving), counted(status.contacts, "open contact"),
                             format_count(status.version)));
    printer.line(fmt::format("poses {} applied, {} dropped  ·  questions {} answered, {} refused, {} undecided",
                             format_count(status.poses_applied), format_count(status.poses_dropped),
                             format_count(status.questions_answered), format_count(status.questions_refused),
                             format_count(status.undecided_answers)));
    if (status.contacts_truncated) {
      printer.line(
          printer.paint(Paint::bad, "contacts are missing: the last step found more than it may tell (max_contacts)"));
    }
    for (const PublisherInfo& publisher : status.publishers) {
      const std::string state = publisher.lost ? printer.paint(Paint::bad, "lost, ") : std::string();
      printer.line(fmt::format("publisher {}  {}silent for {}", printable(publisher.name), state,
                               format_duration(publisher.silent)));
    }
  }

  static Record record(const ServerStatus& status, int domain) {
    Record record = record_of(status);
    record.insert(place_of(record, "namespace"), {"domain", std::int64_t{domain}});
    return record;
  }
};

class ListCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    option(app, "name GLOB", glob_, "Name or glob (* ? [..])");
    app.add_flag("--moving", moving_, "Only what moves");
    app.add_flag("--static", static_, "Only what stands still");
    option(app, "--limit", limit_, "At most so many (10000)");
    app.add_flag("--count", count_only_, "Only how many");
  }

  Exit run(Session& session, const Globals& globals) override {
    if (moving_ && static_) throw bad_use("--moving and --static exclude each other");
    nlohmann::json arguments{{"name", glob_}, {"limit", count_only_ ? 0 : limit_}};
    if (moving_ || static_) arguments["moving"] = moving_;
    const auto [objects, count, version] = server_answer<ObjectList>(session, globals, wire::kList, arguments);
    Printer printer = make_printer(session.io, globals);
    if (count_only_) {
      if (printer.human()) printer.line(std::to_string(count));
      else printer.record({{"count", count}});
      return count > 0 ? Exit::yes : Exit::no;
    }
    for (const ListedObject& object : objects) print(printer, object);
    printer.finish();
    if (objects.size() < count)
      print_hint(session.io, globals,
                 fmt::format("{} of {} objects; --limit shows more", objects.size(), format_count(count)));
    if (objects.empty()) print_hint(session.io, globals, none_line());
    return objects.empty() ? Exit::no : Exit::yes;
  }

 private:
  std::string none_line() const {
    const std::string_view kind = moving_ ? "moving object" : static_ ? "static object" : "object";
    if (!glob_.empty()) return fmt::format("no {}'s name matches '{}'", kind, printable(glob_));
    return fmt::format("no {}s; 'collide load FILE' and 'collide add' put some into the world", kind);
  }
  static void print(Printer& printer, const ListedObject& object) {
    if (!printer.human()) {
      Record record = record_of(object);
      record.back().value = object.attached_to;
      return printer.record(record);
    }
    printer.row({"OBJECT", "KIND", "MOVES", "AT", "FROM"},
                {printable(object.name), printable(object.kind),
                 std::string(object.moving ? "yes" : "no") + (object.stale ? ", stale" : "") +
                     (object.attached_to.empty() ? "" : ", with " + printable(object.attached_to)),
                 object.position ? readable_point(*object.position, 0, printer.digits()) : std::string(),
                 printable(object.publisher.empty() ? object.scene : object.publisher)});
  }

  std::string glob_;
  bool moving_ = false;
  bool static_ = false;
  bool count_only_ = false;
  std::uint64_t limit_ = 10'000;
};

class GetCommand : public Command {
 public:
  void declare(CLI::App& app) override { option(app, "name OBJECT", name_, "Name of the object"); }

  Exit run(Session& session, const Globals& globals) override {
    if (name_.empty()) throw bad_use("which object?", "collide ls lists their names");
    const nlohmann::json object = object_command(session, globals, wire::kGet, name_, {{"name", name_}});
    Printer printer = make_printer(session.io, globals);
    if (printer.human()) print_text(printer, object);
    else print_record(printer, object);
    printer.finish();
    return Exit::yes;
  }

 private:
  static std::string joined(const std::vector<double>& numbers, Digits digits) {
    std::string text;
    for (const double number : numbers)
      text += (text.empty() ? "" : " ") +
              (digits == Digits::all ? format_number(number + 0.0) : readable_number(number + 0.0));
    return text;
  }

  static void print_text(Printer& printer, const nlohmann::json& object) {
    printer.line(fmt::format("{}  {}  {}{}", printable(text_of(object, "name")), printable(text_of(object, "kind")),
                             flag_of(object, "moving") ? "moving" : "static",
                             flag_of(object, "stale") ? ", stale" : ""));
    const auto line = [&](const char* label, const std::string& text) {
      if (!text.empty()) printer.line(fmt::format("  {:<10}{}", label, text));
    };
    line("pose", joined(numbers_of(object, "pose"), printer.digits()));
    line("velocity", joined(numbers_of(object, "velocity"), printer.digits()));
    if (object.contains("bounds") && object["bounds"].is_array()) {
      std::string bounds;
      for (const nlohmann::json& corner : object["bounds"])
        bounds +=
            (bounds.empty() ? "" : "  to  ") + joined(numbers_of({{"corner", corner}}, "corner"), printer.digits());
      line("bounds", bounds);
    }
    for (const nlohmann::json& part : object.value("shape", nlohmann::json::array())) line("shape", json_text(part));
    if (count_of(object, "triangles") > 0) line("triangles", format_count(count_of(object, "triangles")));
    const bool is_by_winding = !text_of(object, "solid_by").empty();
    if (object.contains("solid"))
      line("solid", is_by_winding ? "by winding number" : flag_of(object, "solid") ? "yes" : "no");
    line("layers", fmt::format("{:#x}", count_of(object, "layers")));
    line("scene", printable(text_of(object, "scene")));
    line("publisher", printable(text_of(object, "publisher")));
    line("attached", printable(text_of(object, "attached_to")));
    std::string contacts;
    for (const std::string& contact : texts_of(object, "contacts"))
      contacts += (contacts.empty() ? "" : ", ") + printable(contact);
    line("contacts", contacts.empty() ? "none" : contacts);
  }

  static void print_record(Printer& printer, const nlohmann::json& object) {
    static constexpr std::array<const char*, 18> kKeys{
        "name",   "id",    "kind",      "moving", "scene",  "publisher", "position",    "pose",  "velocity",
        "bounds", "shape", "triangles", "layers", "age_ns", "contacts",  "attached_to", "solid", "solid_by"};
    Record record;
    for (const char* key : kKeys) {
      const bool given = object.contains(key) && !object[key].is_null();
      record.push_back({key, given ? Value(RawJson{json_text(object[key])}) : Value(std::monostate{})});
    }
    printer.record(record);
  }

  std::string name_;
};

class PlanCommand : public Command {
 public:
  void declare(CLI::App& app) override {
    app.add_flag("--pairs", pairs_, "Which shapes meet which, and how");
    app.add_flag("--wings", wings_, "Which optional parts the server has, and which of them are in use");
  }

  Exit run(Session& session, const Globals& globals) override {
    const auto plan = server_answer<Plan>(session, globals, wire::kPlan, nlohmann::json::object());
    Printer printer = make_printer(session.io, globals);
    if (pairs_) {
      for (const PlannedPair& pair : plan.pairs) {
        if (printer.human())
          printer.row({"A", "B", "HOW"}, {printable(pair.a), printable(pair.b), printable(pair.how)});
        else printer.record(record_of(pair));
      }
    } else if (wings_) {
      for (const Wing& wing : plan.wings) {
        if (printer.human()) printer.row({"NAME", "IN USE"}, {printable(wing.name), wing.in_use ? "yes" : "no"});
        else printer.record(record_of(wing));
      }
    } else {
      for (const PlannedStructure& structure : plan.structures) {
        if (printer.human()) print_structure(printer, structure);
        else printer.record(record_of(structure));
      }
      if (printer.human()) print_wings(printer, "wings     ", plan.wings);
    }
    printer.finish();
    return Exit::yes;
  }

 private:
  /// Prints a structure as lines, since its sentences would make a table hundreds of columns wide.
  static void print_structure(Printer& printer, const PlannedStructure& row) {
    std::string line = printer.paint(row.built ? Paint::good : Paint::faint, row.built ? "built   " : "left out") +
                       "  " + printable(row.structure) + ": " + printable(row.reason);
    if (!row.saves.empty()) line += "; saves " + printable(row.saves);
    printer.line(line);
  }

  bool pairs_ = false;
  bool wings_ = false;
};

}  // namespace

std::unique_ptr<Command> make_status() { return std::make_unique<StatusCommand>(); }
std::unique_ptr<Command> make_ls() { return std::make_unique<ListCommand>(); }
std::unique_ptr<Command> make_get() { return std::make_unique<GetCommand>(); }
std::unique_ptr<Command> make_plan() { return std::make_unique<PlanCommand>(); }

}  // namespace collided::cli
