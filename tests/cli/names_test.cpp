// A name is anybody's text: whatever is in it, each format keeps it apart from the format's own signs.
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>

#include "client/cli/output/output.hpp"
#include "client/cli/output/text_row.hpp"
#include "tests/studies/plot/plot.hpp"
#include "client/draw/svg.hpp"
#include "client/view/foxglove_scene.hpp"
#include "client/view/page_answers.hpp"
#include "client/view/page_messages.hpp"
#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/scratch_file.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

using nlohmann::json;

/// Every sign that some format reads as its own, alone and in the middle of others.
std::vector<std::string> hostile_names() {
  std::vector<std::string> names;
  for (int c = 1; c < 0x80; ++c) {
    names.emplace_back(1, static_cast<char>(c));
    names.push_back("a" + std::string(1, static_cast<char>(c)) + "b");
  }
  for (const char* name : {"",
                           "\\n",
                           "\\\\",
                           "\\\"",
                           "C:\\parts\\new\\table",
                           "\"quoted\"",
                           "</script><script>alert(1)</script>",
                           "<!--",
                           "]]>",
                           "&lt;",
                           "&amp;amp;",
                           "a,b",
                           "'single'",
                           "$(x)`y`",
                           "tab\tline\nend\r",
                           "\x1b[2J",
                           "Gel\xc3\xa4nde",
                           "\xf0\x9f\x93\xa6 \xe6\xa3\x9a",
                           "{what}",
                           " space "}) {
    names.emplace_back(name);
  }
  return names;
}

TEST(HostileNames, JsonReadsBackToTheSameName) {
  for (const std::string& name : hostile_names()) {
    std::string text;
    cli::append_json_string(text, name);
    const json back = json::parse(text, nullptr, false);
    ASSERT_TRUE(back.is_string()) << text;
    EXPECT_EQ(back.get<std::string>(), name) << text;
    EXPECT_EQ(text.find('\n'), std::string::npos) << "a record is a line";
  }
  for (const char* broken : {"\xff", "caf\xe9", "\xed\xa0\x80"}) {
    std::string text;
    cli::append_json_string(text, broken);
    EXPECT_TRUE(json::parse(text, nullptr, false).is_string()) << text;
  }
}

TEST(HostileNames, EveryVerbThatTellsANameTellsTheSame) {
  for (const std::string& name : hostile_names()) {
    if (name.empty()) continue;
    fake::reset();
    fake::server().ray = [&](const RayQuestion&, const AskOptions&) {
      return fake::hit_answer({fake::hit(name, 1, {0, 0, 0})});
    };
    fake::server().sweep = [&](const Shape&, const SweepQuestion&, const AskOptions&) {
      return fake::hit_answer({fake::hit(name, 1, {0, 0, 0})});
    };
    fake::server().command = [&](const std::string&, const json&, const Shape&) -> Result<std::string> {
      return json{{"objects",
                   {{{"name", name}, {"kind", "box"}, {"scene", name}, {"publisher", name}, {"position", {1, 2, 3}}}}},
                  {"count", 1},
                  {"version", 9},
                  {"name", name},
                  {"contacts", {name}},
                  {"scene", name},
                  {"publisher", name}}
          .dump();
    };
    Event event;
    event.a = name;
    event.b = name + "b";
    fake::server().events = {event};
    fake::server().readings = {{.probe = name, .object = name + "o", .state = Clearance::gap, .met = name + "m"}};
    fake::server().status.state = "ready";
    fake::server().status.scenes = {name};
    fake::server().status.publishers = {{name, 1, {}, false}};
    const auto record = [&](const std::string& words) {
      return json::parse(collide(words + " --json").out, nullptr, false);
    };
    EXPECT_EQ(record("ray 0 0 5 0 0 -1")["object"], name);
    EXPECT_EQ(record("sweep sphere 1 --from 0 0 0 --to 1 1 1")["object"], name);
    EXPECT_EQ(record("ls")["name"], name);
    EXPECT_EQ(record("ls")["publisher"], name);
    EXPECT_EQ(record("get thing")["name"], name);
    EXPECT_EQ(record("get thing")["contacts"][0], name);
    EXPECT_EQ(record("watch -n 1")["a"], name);
    fake::server().events = {event};
    EXPECT_EQ(record("watch -n 1")["b"], name + "b");
    EXPECT_EQ(record("probe")["probe"], name);
    EXPECT_EQ(record("probe")["met"], name + "m");
    EXPECT_EQ(record("status")["scenes"][0], name);
    EXPECT_EQ(record("status")["publishers"][0]["name"], name);
  }
}

TEST(HostileNames, CsvReadsBackToTheSameName) {
  for (const std::string& name : hostile_names()) {
    fake::reset();
    fake::server().ray = [&](const RayQuestion&, const AskOptions&) {
      return fake::hit_answer({fake::hit(name, 1, {0, 0, 0})});
    };
    const std::string text = collide("ray 0 0 5 0 0 -1 --csv --fields answer,object,distance").out;
    const std::string head = "answer,object,distance\n";
    ASSERT_EQ(text.substr(0, head.size()), head);
    // By RFC 4180: a cell in quotes holds anything, a quote twice.
    ASSERT_TRUE(text.ends_with(",1\n")) << text;
    std::string cell = text.substr(head.size(), text.size() - head.size() - 3);
    ASSERT_TRUE(cell.starts_with("hit,")) << text;
    cell.erase(0, 4);
    const bool must_quote = name.find_first_of(",\"\r\n") != std::string::npos;
    EXPECT_EQ(cell.starts_with('"') && cell.ends_with('"'), must_quote) << text;
    if (must_quote) {
      cell = cell.substr(1, cell.size() - 2);
      for (std::size_t at = cell.find("\"\""); at != std::string::npos; at = cell.find("\"\"", at + 1))
        cell.erase(at, 1);
    }
    EXPECT_EQ(cell, name);
    if (name.find_first_of("\r\n") == std::string::npos && cell.find_first_of(" \t") == std::string::npos) {
      std::vector<std::string> cells;
      cli::split_cells(std::string_view(text).substr(head.size(), text.size() - head.size() - 1), ',', cells);
      EXPECT_EQ(cells, (std::vector<std::string>{"hit", name, "1"}));
    }
  }
}

TEST(HostileNames, APlainRecordStaysOneLineOfItsColumns) {
  for (const std::string& name : hostile_names()) {
    fake::reset();
    fake::server().ray = [&](const RayQuestion&, const AskOptions&) {
      return fake::hit_answer({fake::hit(name, 1, {0, 0, 0})});
    };
    const std::string text = collide("ray 0 0 5 0 0 -1 --plain --fields answer,object,distance").out;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\n'), 1) << text;
    EXPECT_EQ(std::count(text.begin(), text.end(), '\t'), 2) << text;
    EXPECT_EQ(text.find('\r'), std::string::npos);
  }
}

// A terminal obeys what a name may hold: nothing of it but printed signs comes through, in a sentence or in a table.
TEST(HostileNames, ATerminalIsGivenNoControlCharacters) {
  for (const std::string& name : hostile_names()) {
    if (name.empty()) continue;
    fake::reset();
    fake::server().ray = [&](const RayQuestion&, const AskOptions&) {
      return fake::hit_answer({fake::hit(name, 1, {0, 0, 0})});
    };
    fake::server().sphere = [&](const SphereQuestion&, const AskOptions&) {
      return fake::hit_answer({fake::hit(name, 1, {0, 0, 0})});
    };
    fake::server().sweep = [&](const Shape&, const SweepQuestion&, const AskOptions&) {
      return fake::hit_answer({fake::hit(name, 1, {0, 0, 0})});
    };
    fake::server().command = [&](const std::string&, const json&, const Shape&) -> Result<std::string> {
      return json{{"objects",
                   {{{"name", name}, {"kind", name}, {"scene", name}, {"publisher", name}, {"position", {1, 2, 3}}}}},
                  {"count", 1},
                  {"version", 9},
                  {"name", name},
                  {"kind", name},
                  {"contacts", {name}},
                  {"scene", name},
                  {"publisher", name},
                  {"differences", {name}},
                  {"every", 1}}
          .dump();
    };
    Event event;
    event.a = event.b = name;
    fake::server().readings = {{.probe = name, .object = name, .state = Clearance::gap, .met = name}};
    fake::server().status.state = "ready";
    fake::server().status.scenes = {name};
    fake::server().status.publishers = {{name, 1, {}, false}};
    for (const char* words : {"ray 0 0 5 0 0 -1", "sphere 0 0 0 1", "sweep sphere 1 --from 0 0 0 --to 1 1 1", "ls",
                              "get thing", "watch -n 1", "watch -n 1 --format '{a}'", "probe", "probe --watch -n 1",
                              "status", "audit", "ray 0 0 5 0 0 -1 --watch -n 1 --every 1ms"}) {
      fake::server().events = {event};
      const std::string text = at_terminal(words).out;
      EXPECT_NE(text, "") << words;
      for (const char c : text) {
        const bool is_control = (c >= 0 && c < ' ' && c != '\n') || c == 0x7f;
        ASSERT_FALSE(is_control) << words << ": " << static_cast<int>(c);
      }
    }
  }
}

/// What stands between tags, and in attributes, as a reader of XML takes it.
std::string unescaped(std::string text) {
  const auto put = [&](std::string_view what, std::string_view by) {
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size()))
      text.replace(at, what.size(), by);
  };
  put("&lt;", "<");
  put("&gt;", ">");
  put("&quot;", "\"");
  put("&amp;", "&");
  return text;
}

TEST(HostileNames, ADrawingHoldsNoSignOfXmlButItsOwn) {
  EXPECT_EQ(draw::escaped("<a b=\"c\">&'</a>"), "&lt;a b=&quot;c&quot;&gt;&amp;'&lt;/a&gt;");
  for (const std::string& name : hostile_names()) {
    const std::string text = draw::escaped(name);
    EXPECT_EQ(text.find_first_of("<>\""), std::string::npos) << text;
    EXPECT_EQ(unescaped(text), name);
  }
  // Each place of each drawing into which somebody's text goes.
  const std::string evil = "<i x=\"&\">";
  const auto plain = [](std::string svg) {
    for (std::size_t at = svg.find("&lt;i x=&quot;&amp;&quot;&gt;"); at != std::string::npos;
         at = svg.find("&lt;i x=&quot;&amp;&quot;&gt;"))
      svg.erase(at, 29);
    return svg;
  };
  const auto check = [&](const std::string& svg, std::size_t least_count) {
    EXPECT_EQ(svg.find("<i"), std::string::npos);
    EXPECT_EQ(svg.find("x=\"&\""), std::string::npos);
    EXPECT_GE((svg.size() - plain(svg).size()) / 29, least_count) << svg;
    std::string rest = plain(svg);
    for (const char* own : {">&lt;= ", ">&gt;= "}) {
      if (const std::size_t at = rest.find(own); at != std::string::npos) rest.erase(at, 7);  // a legend's own
    }
    EXPECT_EQ(rest.find('&'), std::string::npos) << rest;
  };
  check(draw::svg(draw::Plot{.title = evil,
                             .x = {.label = evil},
                             .y = {.label = evil},
                             .series = {{.name = evil, .points = {{1, 2, evil}, {3, 4, evil}}}}}),
        5);
  check(draw::svg(
            draw::Bars{.title = evil, .value = {.label = evil}, .series = {evil, evil}, .groups = {{evil, {1, 2}}}}),
        5);
  check(draw::svg(draw::Strips{.title = evil, .parts = {evil}, .rows = {{evil, {1}, evil}}}), 4);
  check(draw::svg(draw::HeatMap{.title = evil,
                                .x_label = evil,
                                .y_label = evil,
                                .columns = {evil},
                                .rows = {evil},
                                .cells = {{0.5, evil}},
                                .legend = evil}),
        6);
}

TEST(HostileNames, ThePageAndFoxgloveReadBackTheSameName) {
  for (const std::string& name : hostile_names()) {
    ShownObject object;
    object.name = name;
    object.scene = name;
    object.moving = true;
    const ShownObjects shown{.epoch = 1, .version = 2, .table_version = 3, .objects = {object}};
    EXPECT_EQ(json::parse(view::objects_text(shown))["objects"][0]["name"], name);
    EXPECT_EQ(json::parse(view::objects_text(shown))["objects"][0]["scene"], name);
    const json entity = json::parse(view::scene_update(shown, {.of_object = 1}))["entities"][0];
    EXPECT_EQ(entity["id"], name);
    EXPECT_EQ(entity["frame_id"], name);
    Event event;
    event.a = name;
    event.b = name + "b";
    EXPECT_EQ(json::parse(view::events_text(std::vector<Event>{event}, 9))["events"][0]["a"], name);
    EXPECT_EQ(json::parse(view::events_text(std::vector<Event>{event}, 9))["events"][0]["b"], name + "b");
    EXPECT_EQ(json::parse(view::contact_update(std::vector<Event>{event}))["entities"][0]["id"],
              name + " x " + name + "b");
    EXPECT_EQ(json::parse(view::event_json(event))["b"], name + "b");
    EXPECT_EQ(json::parse(view::refused_text(1, name))["why"], name);
  }
}

// The file of a saved run: no name ends the script that it stands in, and each reads back as it was.
TEST(HostileNames, ASavedRunReadsBackToTheSameName) {
  const std::string name = "</script><b>\\\"&'<!--\n\xc3\xa4";
  fake::reset();
  fake::server().status.state = "ready";
  fake::server().status.scenes = {name};
  fake::server().command = [](const std::string&, const json&, const Shape&) -> Result<std::string> {
    return std::string("{}");
  };
  fake::server().shapes = [](const ShapesOptions&) -> Result<ShownObjects> {
    return ShownObjects{.epoch = 1, .version = 1, .table_version = 1, .objects = {}};
  };
  Event event;
  event.a = name;
  event.b = "floor";
  fake::server().events = {event};
  const ScratchFile file("run.html", "");
  ASSERT_EQ(collide("view --save " + file.path() + " --last 300ms").code, 0);
  std::ifstream in(file.path());
  const std::string page((std::istreambuf_iterator<char>(in)), {});
  const std::string head = R"(<script type="application/json" id="run">)";
  const std::size_t begin = page.find(head);
  ASSERT_NE(begin, std::string::npos);
  const std::string run = page.substr(begin + head.size(), page.find("</script>", begin) - begin - head.size());
  const json saved = json::parse(run, nullptr, false);
  ASSERT_TRUE(saved.is_object()) << run.substr(0, 400);
  EXPECT_EQ(run.find('<'), std::string::npos);
  bool told = false;
  for (const json& message : saved["messages"]) {
    if (message["kind"] != "text") continue;
    const json text = json::parse(message["data"].get<std::string>());
    told = told || (text["type"] == "status" && text["scenes"][0] == name);
  }
  EXPECT_TRUE(told) << run.substr(0, 2000);
}

TEST(HostileNames, AnUndoLineIsReadByTheShellAsTheSameName) {
  for (const std::string& name : hostile_names()) {
    const bool has_control =
        std::any_of(name.begin(), name.end(), [](char c) { return (c >= 0 && c < ' ') || c == 0x7f; });
    if (name.empty() || has_control) continue;  // no object has such a name
    fake::reset();
    const json box{{"box", {{"center", {0, 0, 0}}, {"half_m", {0.2, 0.2, 0.1}}, {"rotation", {1, 0, 0, 0}}}}};
    fake::server().command = [&](const std::string& command, const json&, const Shape&) -> Result<std::string> {
      if (command == "remove") return json{{"removed", {name}}, {"ended", 0}, {"version", 1}}.dump();
      return json{{"objects", {{{"name", name}, {"kind", "box"}, {"scene", ""}, {"publisher", ""}}}},
                  {"count", 1},
                  {"version", 1},
                  {"name", name},
                  {"shape", {box}},
                  {"pose", {1, 2, 3, 1, 0, 0, 0}},
                  {"layers", 1},
                  {"mask", 0xffffffff},
                  {"group", 0},
                  {"moving", true}}
          .dump();
    };
    const std::string said = at_terminal("rm thing").err;
    const std::size_t undo = said.find("undo: collide ");
    ASSERT_NE(undo, std::string::npos) << said;
    const std::string line = said.substr(undo + 14, said.find('\n', undo) - undo - 14);
    fake::server().command = [&](const std::string& command, const json& arguments,
                                 const Shape&) -> Result<std::string> {
      EXPECT_EQ(command, "add");
      EXPECT_EQ(arguments["name"], name) << line;
      return json{{"name", name}, {"id", 7}, {"version", 2}}.dump();
    };
    EXPECT_EQ(collide(line).code, 0) << line;
  }
}

}  // namespace
}  // namespace collided
