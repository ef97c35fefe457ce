// The verbs fence, margin and nearest, which share all but how `add` reads its words.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "tests/cli/fakes/fake_client.hpp"
#include "tests/cli/terminal.hpp"

namespace collided {
namespace {

using nlohmann::json;
using Kind = StandingEventKind;

class StandingVerbs : public testing::Test {
 protected:
  void SetUp() override { fake::reset(); }

  static const Standing& added() { return fake::server().standing.back(); }
  template <class Form>
  static const Form& asked() {
    return std::get<Form>(added().of);
  }
  static std::string verb_of(StandingForm form) {
    return form == StandingForm::region ? "fence" : form == StandingForm::bands ? "margin" : "nearest";
  }
  /// The members that an event of its form and kind has not are filled as well: they must not be printed.
  static StandingEvent event(Kind kind, double length_m = 0, EndReason reason = EndReason::none) {
    StandingEvent event;
    event.kind = kind;
    event.form = kind <= Kind::cross   ? StandingForm::region
                 : kind <= Kind::leave ? StandingForm::bands
                                       : StandingForm::nearest;
    event.reason = reason;
    const char* const names[][3] = {
        {"dock", "forklift_2", ""}, {"close", "drone_1", "person_2"}, {"escape", "door_2", ""}};
    const auto& [standing, object, other] = names[static_cast<std::size_t>(event.form)];
    event.standing = standing;
    event.object = object;
    event.other = other;
    event.band_m = event.distance_m = length_m;
    event.sequence = 7;
    event.episode = 3;
    event.epoch = 1;
    event.world_time = std::chrono::seconds(100);
    event.entered = std::chrono::seconds(90);
    event.bracket_low_s = 0.5;
    event.bracket_high_s = 0.25;
    event.left_low_s = 0.125;
    event.left_high_s = 0.0625;
    if (event.form != StandingForm::region) event.normal = Vec3(1, 0, 0);
    event.closing_mps = 4;
    if (kind == Kind::approach || kind == Kind::near || kind == Kind::contact) event.contact_in = {0.5, 0.500001};
    return event;
  }
  static StandingEvent changed(const std::string& from, const std::string& to, EndReason reason) {
    StandingEvent changed = event(Kind::changed, 3, reason);
    changed.other = from;
    changed.object = to;
    return changed;
  }
  static std::vector<ListedStanding> one_of_each_form() {
    ListedStanding dock;
    dock.name = "dock";
    dock.kind = "box";
    dock.to = "truck";
    dock.only = "forklift*";
    dock.detect = {"enter", "exit"};
    dock.keep = true;
    dock.holds = {{.object = "forklift_1"}, {.object = "forklift_9", .in_doubt = true}, {.object = "forklift_2"}};
    ListedStanding close;
    close.name = "close";
    close.form = StandingForm::bands;
    close.around = "drone*";
    close.only = "person*";
    close.skip = "person_9";
    close.bands_m = {5, 2, 0};
    close.hysteresis_m = 0.1;
    close.dwell = std::chrono::milliseconds(200);
    close.keep = true;
    close.holds = {{.object = "person_2", .other = "drone_1", .band_m = 2}, {.object = "person_3", .other = "drone_1"}};
    ListedStanding escape;
    escape.name = "escape";
    escape.form = StandingForm::nearest;
    escape.only = "door_*";
    escape.to = "person_7";
    escape.within_m = 20;
    escape.holds = {{.object = "door_2", .since = std::chrono::seconds(90)}};
    escape.cut_short = 3;
    return {dock, close, escape};
  }
};

TEST_F(StandingVerbs, RegionsAreReadInMetresAndKept) {
  EXPECT_EQ(collide("fence add dock box 0 0 0 5 4 3m --only 'forklift*' --skip forklift_9 --mask 0x6 --keep").out,
            "dock\n");
  EXPECT_EQ(added().name, "dock");
  EXPECT_EQ(added().only, "forklift*");
  EXPECT_EQ(added().skip, "forklift_9");
  EXPECT_EQ(added().mask, 6U);
  EXPECT_TRUE(added().keep);
  EXPECT_TRUE(asked<Region>().enter && asked<Region>().exit && asked<Region>().cross);
  EXPECT_EQ(std::get<BoxShape>(asked<Region>().shape.at(0)).half_m, Vec3(2.5, 2, 1.5));
  EXPECT_EQ(std::get<BoxShape>(asked<Region>().shape.at(0)).center, Vec3(2.5, 2, 1.5));
  collide("fence add zone sphere 1 2 3 50cm --to person --detect enter --keep");
  EXPECT_EQ(std::get<SphereShape>(asked<Region>().shape.at(0)).radius_m, 0.5);
  EXPECT_EQ(asked<Region>().to, "person");
  EXPECT_TRUE(asked<Region>().enter && !asked<Region>().exit && !asked<Region>().cross);
  collide("fence add yard prism -1 2 0 0 4 0 4 4 --keep");
  ASSERT_TRUE(asked<Region>().prism);
  EXPECT_EQ(asked<Region>().prism->low_m, -1);
  EXPECT_EQ(asked<Region>().prism->corners.size(), 3u);
  collide("fence add ground plane 0 0 0 0 0 1 --keep");
  EXPECT_EQ(std::get<HalfSpaceShape>(asked<Region>().shape.at(0)).normal, Vec3(0, 0, 1));
}

TEST_F(StandingVerbs, BandsAreReadWithTheirUnitsAndKept) {
  EXPECT_EQ(collide("margin add close 'drone*' 'person*' 5m,2,50cm --hysteresis 10cm --dwell 200ms --keep").out,
            "close\n");
  EXPECT_EQ(added().name, "close");
  EXPECT_EQ(added().only, "person*");
  EXPECT_TRUE(added().keep);
  EXPECT_EQ(asked<Bands>().around, "drone*");
  EXPECT_EQ(asked<Bands>().bands_m, (std::vector<double>{5, 2, 0.5}));
  EXPECT_EQ(asked<Bands>().hysteresis_m, 0.1);
  EXPECT_EQ(asked<Bands>().dwell, std::chrono::milliseconds(200));
}

TEST_F(StandingVerbs, OfTheNearestAnObjectOrAPointAndADistanceAreRead) {
  EXPECT_EQ(collide("nearest add escape 'door_*' person_7 20m --hysteresis 10cm --skip door_9 --keep").out, "escape\n");
  EXPECT_EQ(added().name, "escape");
  EXPECT_EQ(added().only, "door_*");
  EXPECT_EQ(added().skip, "door_9");
  EXPECT_TRUE(added().keep);
  EXPECT_EQ(asked<Nearest>().to, "person_7");
  EXPECT_FALSE(asked<Nearest>().point);
  EXPECT_EQ(asked<Nearest>().within_m, 20);
  EXPECT_EQ(asked<Nearest>().hysteresis_m, 0.1);
  EXPECT_EQ(collide("nearest add yard 'truck_*' 4 0 -1m 500cm --keep").out, "yard\n");
  EXPECT_EQ(asked<Nearest>().to, "");
  EXPECT_EQ(*asked<Nearest>().point, Vec3(4, 0, -1));
  EXPECT_EQ(asked<Nearest>().within_m, 5);
}

TEST_F(StandingVerbs, WordsThatMakeNoQuestionAreRefusedAndNothingIsSent) {
  for (const char* wrong : {"fence add dock box 0 0 0",
                            "fence add dock sphere 1 2 3",
                            "fence add dock prism 0 1 0 0 1 0",
                            "fence add dock prism 0 1 0 0 1 0 1",
                            "fence add dock pyramid 1 2 3",
                            "fence add dock box 0 0 0 inf 1 1",
                            "fence add dock box 0 0 0 1 1 nan",
                            "fence add dock box 0 0 0 1 1 1 --detect enter,leave",
                            "fence move dock",
                            "fence rm",
                            "margin add close a",
                            "margin add close a b",
                            "margin add close a b 2m,5m",
                            "margin add close a b 2m,2m",
                            "margin add close a b -1",
                            "margin add close a b inf",
                            "margin add close a b nan",
                            "margin add close a b 5kg",
                            "margin add close a b 5 --hysteresis -1cm",
                            "margin add close a b 5 --hysteresis inf",
                            "margin add close a b 5 --dwell -1s",
                            "margin move close",
                            "margin rm",
                            "nearest add q a",
                            "nearest add q a b",
                            "nearest add q a b 0",
                            "nearest add q a b -1",
                            "nearest add q a b inf",
                            "nearest add q a b 5kg",
                            "nearest add q a 1 2 5",
                            "nearest add q a 1 2 x 5",
                            "nearest add q a b 5 --hysteresis -1cm",
                            "nearest add q a 1 2 3 4 5",
                            "nearest move q",
                            "nearest rm"}) {
    const Ran ran = collide(std::string(wrong) + " --keep");
    EXPECT_EQ(ran.code, 2) << wrong;
    EXPECT_FALSE(ran.err.empty()) << wrong;
  }
  EXPECT_NE(collide("margin add close a b 2m,5m --keep").err.find("band 2, 5 m, is not less than the one before it"),
            std::string::npos);
  EXPECT_TRUE(fake::server().standing.empty());
}

// A glob that names parts of a scene would be silent for ever otherwise.
TEST_F(StandingVerbs, AWarningSaysThatPartsOfScenesHaveNoBands) {
  EXPECT_EQ(collide("margin add close 'drone*' 'plant/*' 5 --keep").err, "");
  fake::server().standing_parts = 312;
  EXPECT_EQ(collide("margin add close 'drone*' 'plant/*' 5 --keep").err,
            "warning: 312 parts of loaded scenes match and have no bands; give what stands still a shape of its own: "
            "collide add\n");
  fake::server().standing_parts = 1;
  EXPECT_EQ(
      collide("margin add close 'drone*' plant/tank 5 --keep").err.find("warning: 1 part of loaded scenes matches"),
      0u);
}

TEST_F(StandingVerbs, OneThatIsNotKeptStandsAsLongAsItIsWatched) {
  const struct {
    std::string command;
    StandingEvent event;
    std::string plain;
  } rows[] = {
      {"fence add dock box 0 0 0 5 4 3", event(Kind::enter), "99.75\tenter\tdock\tforklift_2\t\t\t\t\t\t\n"},
      {"margin add close 'drone*' 'person*' 5m", event(Kind::approach, 5),
       "99.75\tapproach\tclose\tdrone_1\tperson_2\t5\t5\t\t\t\n"},
      {"nearest add escape 'door_*' person_7 20m", changed("door_1", "door_2", EndReason::none),
       "99.75\tchanged\tescape\tdoor_2\tdoor_1\t\t3\t\t\t\n"},
  };
  for (const auto& row : rows) {
    fake::server().standing_events = {row.event};
    const Ran ran = collide(row.command + " --only unheeded -n 1");
    EXPECT_EQ(ran.code, 0) << ran.err;
    EXPECT_FALSE(added().keep) << row.command;
    EXPECT_EQ(added().form(), row.event.form) << row.command;
    EXPECT_EQ(fake::server().standing_watched_with.only, row.event.standing) << "its own events alone";
    EXPECT_EQ(ran.out, row.plain);
    EXPECT_NE(ran.err.find(row.event.standing + " stands until this ends; --keep lets it stand\n"), std::string::npos)
        << ran.err;
  }
}

TEST_F(StandingVerbs, EventsAreReportedWithTheirTimesAndLengths) {
  const json bracket{{"first_ns", 99'500'000'000}, {"last_ns", 99'750'000'000}};
  const auto with = [](json fields, const json& more) {
    fields.update(more);
    return fields;
  };
  const json no_length{{"distance", nullptr}, {"closing", nullptr}, {"normal", nullptr}};
  const json no_change{{"time", 90}, {"first_ns", nullptr}, {"last_ns", nullptr}, {"after", nullptr}};
  StandingEvent doubtful = event(Kind::near, 2);
  doubtful.doubt = Doubt::publisher_lost;
  doubtful.resync = doubtful.poses_merged = true;
  const struct {
    StandingEvent event;
    std::string line;
    json fields;  // null: the field is empty
  } rows[] = {
      {event(Kind::inside), "inside   dock  forklift_2  since 90.000",
       with(no_change, {{"form", "region"}, {"standing", "dock"}, {"object", "forklift_2"}, {"band", nullptr}})},
      {event(Kind::enter), "99.750 enter  dock  forklift_2  seq 7",
       with(with(no_length, bracket), {{"other", nullptr}, {"left_first_ns", nullptr}, {"episode", 3}})},
      {event(Kind::exit, 0, EndReason::separated), "99.750 exit  dock  forklift_2  after 9.75 s  (separated)  seq 7",
       with(bracket, {{"why", "separated"}, {"after", 9.75}})},
      {event(Kind::cross), "99.937 cross  dock  forklift_2  in for 9.94 s  seq 7",
       with(bracket, {{"left_first_ns", 99'875'000'000}, {"left_last_ns", 99'937'500'000}})},
      {event(Kind::within, 5), "within   close  drone_1 x person_2  5 m  since 90.000",
       with(with(no_length, no_change), {{"form", "bands"}, {"other", "person_2"}, {"band", 5}})},
      {event(Kind::approach, 5),
       "99.750 approach  close  drone_1 x person_2  5 m  closing 4 m/s  contact in 500 ms  seq 7",
       with(bracket, {{"what", "approach"}, {"distance", 5}})},
      {event(Kind::near, 2), "99.750 near  close  drone_1 x person_2  2 m  closing 4 m/s  contact in 500 ms  seq 7",
       with(bracket, {{"distance", 2}, {"closing", 4}, {"contact_in_first", 0.5}, {"normal", {1, 0, 0}}})},
      {event(Kind::contact, 0),
       "99.750 contact  close  drone_1 x person_2  closing 4 m/s  seq 7",
       {{"band", 0}, {"distance", 0}}},
      {event(Kind::leave, 2, EndReason::separated),
       "99.750 leave  close  drone_1 x person_2  2 m  after 9.75 s  (separated)  seq 7",
       with(no_length, {{"why", "separated"}, {"after", 9.75}, {"band", 2}})},
      {event(Kind::leave, 0, EndReason::fence_removed),
       "99.750 leave  close  drone_1 x person_2  contact  after 9.75 s  (margin_removed)  seq 7",
       {{"why", "fence_removed"}}},
      {doubtful,
       "99.750 near  close  drone_1 x person_2  2 m  in doubt (publisher_lost)  seq 7  resync  (poses merged)",
       with(no_length, {{"doubt", "publisher_lost"}, {"resync", true}, {"poses_merged", true}})},
      {event(Kind::is, 3), "is       escape  door_2  3 m  seq 7",
       with(no_change, {{"form", "nearest"}, {"object", "door_2"}, {"other", nullptr}, {"distance", 3}})},
      {changed("door_1", "door_2", EndReason::separated), "99.750 nearest  escape  door_1 -> door_2  3 m  seq 7",
       with(bracket, {{"what", "changed"}, {"object", "door_2"}, {"other", "door_1"}, {"closing", nullptr}})},
      {changed("door_1", "", EndReason::removed), "99.750 nearest  escape  door_1 -> nothing  (removed)  seq 7",
       with(with(no_length, bracket), {{"object", nullptr}, {"other", "door_1"}, {"why", "removed"}})},
      {changed("door_1", "", EndReason::fence_removed),
       "99.750 nearest  escape  door_1 -> nothing  (question_removed)  seq 7",
       {{"why", "fence_removed"}}},
  };
  for (const auto& row : rows) {
    const std::string command = verb_of(row.event.form) + " watch 'c*' -n 1";
    fake::server().standing_events = {row.event};
    EXPECT_EQ(at_terminal(command).out, row.line + "\n");
    fake::server().standing_events = {row.event};
    const json record = json::parse(collide(command + " --json").out);
    for (const auto& [name, value] : row.fields.items())
      EXPECT_EQ(record.value(name, json()), value) << name << " of: " << row.line;
    EXPECT_EQ(fake::server().standing_watched_with.only, "c*");
    EXPECT_EQ(fake::server().standing_watched_with.form, row.event.form) << command;
  }
}

TEST_F(StandingVerbs, ListsHaveTheQuestionsOfTheirFormAndWhatTheyHold) {
  fake::server().listed_standing = one_of_each_form();
  const struct {
    std::string verb;
    std::string table;
    json fields;
  } rows[] = {
      {"fence",
       "NAME  FORM    OF            LOOKS AT   DETAILS     KEPT  HOLDS\n"
       "dock  region  box on truck  forklift*  enter,exit  yes   forklift_1 forklift_2  in doubt: forklift_9\n",
       {{"region", "box"},
        {"detect", "enter,exit"},
        {"holds", "forklift_1 forklift_2"},
        {"in_doubt", "forklift_9"},
        {"hysteresis", nullptr}}},
      {"margin",
       "NAME   FORM   OF      LOOKS AT              DETAILS                                   KEPT  HOLDS\n"
       "close  bands  drone*  person* but person_9  5 m, 2 m; hysteresis 0.1 m; dwell 200 ms  yes   person_2 drone_1 "
       "2 m  person_3 drone_1 contact\n",
       {{"around", "drone*"}, {"bands", "5 m, 2 m"}, {"dwell", 0.2}, {"within", nullptr}}},
      {"nearest",
       "NAME    FORM     OF        LOOKS AT  DETAILS                   KEPT  HOLDS\n"
       "escape  nearest  person_7  door_*    within 20 m; 3 cut short  no    door_2\n",
       {{"standing", "escape"}, {"to", "person_7"}, {"holds", "door_2"}, {"since", 90}, {"cut_short", 3}}},
  };
  for (const auto& row : rows) {
    EXPECT_EQ(at_terminal(row.verb + " ls").out, row.table);
    const json record = json::parse(collide(row.verb + " ls --json").out);
    for (const auto& [name, value] : row.fields.items()) EXPECT_EQ(record.value(name, json()), value) << name;
  }
  fake::server().listed_standing.clear();
  for (const auto& [verb, called] : {std::pair("fence", "fences"), {"margin", "margins"}, {"nearest", "questions"}}) {
    const Ran none = collide(verb);
    EXPECT_EQ(none.code, 1);
    EXPECT_EQ(none.out, "");
    EXPECT_EQ(none.err, "no " + std::string(called) + "; 'collide " + verb + " add' makes one\n");
  }
}

TEST_F(StandingVerbs, RemoveTakesThoseOfTheirForm) {
  collide("fence add dock box 0 0 0 1 1 1 --keep");
  collide("margin add close a b 1 --keep");
  EXPECT_EQ(collide("fence rm close").code, 1) << "it is a margin";
  EXPECT_EQ(at_terminal("margin rm close").out, "removed 1 margin\n");
  EXPECT_EQ(collide("margin rm close").code, 1) << "it has gone";
  EXPECT_EQ(collide("fence rm dock").out, "1\n");
  EXPECT_TRUE(fake::server().standing.empty());
}

}  // namespace
}  // namespace collided
