/* A C89 program that does what the header offers: asks, adds, publishes, watches by polling and by callback, adds
 * standing questions, and turns scans into voxels.
 * usage: c_client DOMAIN */
#define _POSIX_C_SOURCE 199309L /* nanosleep */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include <collided.h>

#define MANY 1000

static int faults = 0;

static void expect(int is_so, const char* what) {
  if (is_so) return;
  fprintf(stderr, "not so: %s\n", what);
  ++faults;
}

static void must(int code, const collided_error* error, const char* what) {
  if (code == COLLIDED_OK) return;
  fprintf(stderr, "%s: code %d: %s (%s)\n", what, code, error->message, error->hint);
  exit(1);
}

static double number(double low, double high) { return low + (high - low) * rand() / ((double)RAND_MAX + 1); }

static void rays(collided_client* client) {
  static double origins[3 * MANY], directions[3 * MANY], distances[MANY];
  static unsigned char verdicts[MANY];
  static uint32_t counts[MANY];
  collided_error error;
  collided_answers* answers = NULL;
  collided_answers_info info;
  collided_columns columns;
  int i, round, hits = 0;
  error.size = sizeof error;
  for (i = 0; i < 3 * MANY; ++i) {
    origins[i] = i % 3 == 2 ? 4 : number(-5, 5);
    directions[i] = i % 3 == 2 ? -1 : number(-1, 1);
  }
  for (round = 0; round < 3; ++round) { /* the second and third use the first one's memory */
    must(collided_ask_rays(client, MANY, origins, directions, NULL, NULL, &answers, &error), &error, "rays");
  }
  info.size = sizeof info;
  collided_get_info(answers, &info);
  expect(info.questions == MANY, "as many answers as rays");
  memset(&columns, 0, sizeof columns);
  columns.size = sizeof columns;
  columns.first_hits = 1;
  columns.verdict = verdicts;
  columns.hit_count = counts;
  columns.distance_m = distances;
  collided_read_columns(answers, &columns);
  for (i = 0; i < MANY; ++i) {
    if (verdicts[i] == COLLIDED_HIT) {
      ++hits;
      expect(counts[i] == 1 && distances[i] > 0 && distances[i] < 100, "a hit has a distance");
    } else {
      expect(distances[i] != distances[i], "a miss has the distance NaN");
    }
  }
  expect(hits > MANY / 2 && (size_t)hits == info.hits, "rays down into a warehouse hit");
  expect(collided_hit_object(answers, 0) != NULL && strncmp(collided_hit_object(answers, 0), "", 1) != 0, "a name");
  expect(collided_hit_object(answers, info.hits) == NULL, "no name beyond the last hit");
  collided_free_answers(answers);
}

static int called = 0;
static void count_event(const collided_event* event, void* user) {
  if (event->kind == 1 && user == (void*)&called) ++called;
}

static void moves_and_events(collided_client* client) {
  collided_error error;
  collided_object object;
  collided_part part;
  collided_watch *polled = NULL, *calling = NULL;
  collided_publisher* publisher = NULL;
  collided_report report;
  collided_watch_options options;
  collided_publish_options kept;
  collided_event event;
  collided_pair_answer pair;
  uint32_t ball;
  uint64_t removed = 0;
  double position[3];
  int i, began = 0, ended = 0;
  error.size = sizeof error;
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.only = "c_wall";
  must(collided_watch_start(client, &options, NULL, NULL, &polled, &error), &error, "watch");
  must(collided_watch_start(client, &options, count_event, &called, &calling, &error), &error, "watch by callback");

  memset(&part, 0, sizeof part);
  part.size = sizeof part;
  part.kind = COLLIDED_BOX;
  part.numbers[0] = 0.1;
  part.numbers[1] = part.numbers[2] = 1;
  part.numbers[6] = 1;
  collided_object_defaults(&object, sizeof object);
  object.name = "c_wall";
  object.parts = &part;
  object.part_count = 1;
  object.position[0] = 500;
  must(collided_add(client, &object, NULL, &error), &error, "add");

  collided_publish_defaults(&kept, sizeof kept);
  expect(kept.lease_ns == 500000000L && kept.gap_ns == 1500000000L, "the defaults of a publisher");
  kept.gap_ns = 0;
  expect(collided_publish_with(client, "c_mover", &kept, &publisher, &error) == COLLIDED_BAD_INPUT, "no gap");
  kept.gap_ns = 2000000000L;
  must(collided_publish_with(client, "c_mover", &kept, &publisher, &error), &error, "publish");
  part.kind = COLLIDED_SPHERE;
  memset(part.numbers, 0, sizeof part.numbers);
  part.numbers[3] = 0.2;
  object.name = "c_ball";
  object.position[0] = 497;
  must(collided_publisher_add(publisher, &object, &ball, &error), &error, "add a ball");
  must(collided_publisher_flush(publisher, 0, NULL, &error), &error, "flush");
  must(collided_publisher_wait_applied(publisher, 5000000000L, &error), &error, "wait");
  pair.size = sizeof pair;
  must(collided_pair(client, "c_wall", "c_ball", 0, &pair, &error), &error, "pair");
  expect(pair.verdict == COLLIDED_MISS && pair.distance_m > 2.69 && pair.distance_m < 2.71, "2.7 m apart");
  position[1] = position[2] = 0;
  for (i = 0; i <= 60; ++i) {
    position[0] = 497 + 0.1 * i;
    must(collided_publisher_move(publisher, 1, &ball, position, NULL, 0, &error), &error, "move");
    must(collided_publisher_flush(publisher, 0, NULL, &error), &error, "flush");
  }
  expect(error.code == COLLIDED_OK && error.message[0] == 0, "it was not lost");
  must(collided_publisher_keep_alive_at(publisher, 0, &error), &error, "keep alive");
  must(collided_publisher_wait_applied(publisher, 5000000000L, &error), &error, "wait");
  report.size = sizeof report;
  must(collided_publisher_report(publisher, 5000000000L, &report, &error), &error, "report");
  expect(!strcmp(report.refused, "") && report.name_count == 0 && report.left_out_count == 0, "everything is taken");
  expect(report.merged_poses == 0, "and no pose was replaced");
  object.name = "c_wall";
  must(collided_publisher_add(publisher, &object, NULL, &error), &error, "add a name that is taken");
  must(collided_publisher_flush(publisher, 0, NULL, &error), &error, "flush");
  expect(collided_publisher_wait_applied(publisher, 5000000000L, &error) == COLLIDED_REFUSED, "the name is taken");
  must(collided_publisher_report(publisher, 5000000000L, &report, &error), &error, "report");
  expect(report.name_count == 1 && report.left_out_count == 1 && !strcmp(report.names[0], "c_wall") &&
             !strcmp(report.reasons[0], "the name is taken"),
         "the report says so");
  event.size = sizeof event;
  for (i = 0; i < 100 && ended == 0; ++i) {
    const int code = collided_watch_next(polled, 100000000, &event, &error);
    if (code == COLLIDED_NOTHING) continue;
    must(code, &error, "next");
    began += event.kind == 1;
    if (event.kind == 1) {
      expect(!memcmp(event.surface_normal, event.normal, sizeof event.normal), "a wall alone is one surface");
      expect(event.surface_depth_m == event.depth_m && event.surface_depth_error_m == event.depth_error_m, "and its depth");
    }
    expect(event.poses_merged == 0, "none of its poses was replaced");
    ended += event.kind == 3;
    expect(!strcmp(event.a, "c_wall") || !strcmp(event.b, "c_wall"), "the names");
  }
  expect(began == 1 && ended == 1, "the ball met the wall once and left it");
  expect(collided_watch_lost(polled) == 0, "no event lost");
  collided_watch_close(calling);
  expect(called == 1, "the callback heard of it too");
  collided_watch_close(polled);
  collided_publisher_close(publisher);
  must(collided_remove(client, "c_wall", &removed, &error), &error, "remove");
  expect(removed == 1, "one object removed");
}

static void refusals(collided_client* client) {
  collided_error error;
  collided_answers* answers = NULL;
  char* text = NULL;
  const double zero[3] = {0, 0, 0};
  error.size = sizeof error;
  expect(collided_ask_rays(client, 1, zero, zero, NULL, NULL, &answers, &error) == COLLIDED_BAD_INPUT, "no direction");
  expect(error.code == COLLIDED_BAD_INPUT && strlen(error.message) > 10 && answers == NULL, "and why");
  expect(collided_ask_rays(client, 1, NULL, zero, NULL, NULL, &answers, &error) == COLLIDED_BAD_INPUT, "no array");
  expect(collided_ask_rays(NULL, 1, zero, zero, NULL, NULL, &answers, NULL) == COLLIDED_BAD_INPUT, "no client");
  expect(collided_pair(client, "nosuch", "neither", 0, NULL, &error) == COLLIDED_REFUSED, "unknown names");
  expect(collided_command(client, "list", "{\"limit\":2}", 0, &text, &error) == COLLIDED_OK, "a command");
  expect(text != NULL && text[0] == '{', "its answer");
  collided_free_text(text);
  collided_free_text(NULL);
  collided_free_answers(NULL);
  collided_close(NULL);
}

/* A cube a metre from a wall: how near, and whether it would be free elsewhere. */
static void groups(collided_client* client) {
  static const char* const name[1] = {"c_hand"};
  static const double poses[21] = {0, 0, 60, 1, 0, 0, 0, 0.5, 0, 60, 1, 0, 0, 0, 1.5, 0, 60, 1, 0, 0, 0};
  collided_error error;
  collided_part box;
  collided_object object;
  collided_answers* answers = NULL;
  collided_answers_info info;
  collided_columns columns;
  uint8_t verdicts[3], by_winding[6];
  double distances[6], uncovered[9], covered[3];
  size_t i;
  error.size = sizeof error;
  info.size = sizeof info;
  memset(&box, 0, sizeof box);
  box.size = sizeof box;
  box.kind = COLLIDED_BOX;
  for (i = 0; i < 3; ++i) box.numbers[i] = 0.5;
  box.numbers[6] = 1;
  for (i = 0; i < 2; ++i) {
    collided_object_defaults(&object, sizeof object);
    object.name = i == 0 ? "c_hand" : "c_wall";
    object.parts = &box;
    object.part_count = 1;
    object.position[0] = i == 0 ? 0 : 2;
    object.position[2] = 60;
    must(collided_add(client, &object, NULL, &error), &error, "add");
  }
  must(collided_clearance(client, "c_hand", "c_wall", 1, HUGE_VAL, NULL, &answers, &error), &error, "clearance");
  memset(&columns, 0, sizeof columns);
  columns.size = sizeof columns;
  columns.verdict = verdicts;
  columns.distance_m = distances;
  columns.by_winding = by_winding;
  columns.uncovered = uncovered;
  columns.covered_m = covered;
  collided_get_info(answers, &info);
  expect(info.questions == 1 && info.hits == 2, "a pair is two hits");
  collided_read_columns(answers, &columns);
  expect(by_winding[0] == 0 && by_winding[1] == 0, "no distance by winding number");
  expect(uncovered[0] != uncovered[0] && covered[0] != covered[0], "nothing is uncovered");
  expect(verdicts[0] == COLLIDED_MISS && fabs(distances[0] - 1) < 1e-9, "a metre");
  expect(!strcmp(collided_hit_object(answers, 0), "c_hand") && !strcmp(collided_hit_object(answers, 1), "c_wall"), "names");
  must(collided_what_if(client, name, 1, 3, poses, NULL, 0, HUGE_VAL, NULL, &answers, &error), &error, "what-if");
  collided_get_info(answers, &info);
  expect(info.questions == 3 && info.hits <= 6, "an answer for each configuration");
  if (info.hits == 6) collided_read_columns(answers, &columns);
  expect(verdicts[0] == COLLIDED_MISS && verdicts[1] == COLLIDED_MISS && verdicts[2] == COLLIDED_HIT, "free, free, not");
  expect(fabs(distances[2] - 0.5) < 1e-9 && fabs(distances[4] + 0.5) < 1e-9, "their clearances");
  collided_free_answers(answers);
  answers = NULL;
  expect(collided_clearance(client, "nobody", NULL, 1, HUGE_VAL, NULL, &answers, &error) == COLLIDED_REFUSED, "no group");
  expect(collided_what_if(client, name, 1, 1, NULL, NULL, 0, 0, NULL, &answers, &error) == COLLIDED_BAD_INPUT, "no poses");
  must(collided_remove(client, "c_*", NULL, &error), &error, "remove");
}

/* The next event of a standing question, or the end of the test if none comes. */
static void next_standing_event(collided_standing_watch* watch, collided_standing_event* event) {
  collided_error error;
  int i, code = COLLIDED_NOTHING;
  error.size = sizeof error;
  event->size = sizeof *event;
  for (i = 0; i < 200 && code == COLLIDED_NOTHING; ++i)
    code = collided_standing_watch_next(watch, 100000000, event, &error);
  must(code, &error, "an event of a standing question");
}

/* Until then what is reported may have held before. */
static void await_in_step(collided_standing_watch* watch) {
  collided_error error;
  collided_standing_event event;
  int i;
  error.size = sizeof error;
  event.size = sizeof event;
  for (i = 0; i < 500 && !collided_standing_watch_in_step(watch); ++i)
    collided_standing_watch_next(watch, 10000000, &event, &error);
}

/* A while after the last one: it is on its way for so long. */
static void move_to(collided_publisher* publisher, uint32_t handle, double x) {
  struct timespec while_;
  collided_error error;
  double position[3];
  error.size = sizeof error;
  while_.tv_sec = 0;
  while_.tv_nsec = 300000000L;
  nanosleep(&while_, NULL);
  position[0] = x;
  position[1] = position[2] = 0;
  must(collided_publisher_move(publisher, 1, &handle, position, NULL, 0, &error), &error, "move");
  must(collided_publisher_flush(publisher, 0, NULL, &error), &error, "flush");
  must(collided_publisher_wait_applied(publisher, 5000000000L, &error), &error, "wait");
}

/* A ball of 0.2 m goes into a box of 2 m about (600 0 0) and out, and through it between two poses. */
static void regions(collided_client* client) {
  collided_error error;
  collided_part part;
  collided_standing region;
  collided_object object;
  collided_standing_event event;
  collided_standing_watch* watch = NULL;
  collided_publisher* publisher = NULL;
  uint32_t ball;
  uint64_t removed = 0, entered;
  error.size = sizeof error;
  memset(&part, 0, sizeof part);
  part.size = sizeof part;
  part.kind = COLLIDED_BOX;
  part.numbers[0] = part.numbers[1] = part.numbers[2] = 1;
  part.numbers[3] = 600;
  part.numbers[6] = 1;
  memset(&region, 0, sizeof region);
  region.size = sizeof region;
  region.form = COLLIDED_FORM_REGION;
  region.name = "c_dock";
  region.parts = &part;
  region.part_count = 1;
  region.only = "c_*";
  must(collided_standing_add(client, &region, NULL, &error), &error, "add a region");
  expect(collided_standing_add(client, &region, NULL, &error) == COLLIDED_REFUSED, "one question of a name");
  region.name = "c_nothing";
  region.part_count = 0;
  expect(collided_standing_add(client, &region, NULL, &error) != COLLIDED_OK, "no region");
  region.form = 3;
  expect(collided_standing_add(client, &region, NULL, &error) == COLLIDED_BAD_INPUT, "no such form");
  expect(collided_standing_watch_start(client, NULL, NULL, 3, &watch, &error) == COLLIDED_BAD_INPUT && watch == NULL,
         "no watch of such a form");
  must(collided_standing_watch_start(client, "c_dock", NULL, COLLIDED_FORM_REGION, &watch, &error), &error, "watch a region");
  await_in_step(watch);

  must(collided_publish(client, "c_driver", &publisher, &error), &error, "publish");
  part.kind = COLLIDED_SPHERE;
  memset(part.numbers, 0, sizeof part.numbers);
  part.numbers[3] = 0.2;
  collided_object_defaults(&object, sizeof object);
  object.name = "c_cart";
  object.parts = &part;
  object.part_count = 1;
  object.position[0] = 597;
  must(collided_publisher_add(publisher, &object, &ball, &error), &error, "add a ball");
  must(collided_publisher_flush(publisher, 0, NULL, &error), &error, "flush");
  move_to(publisher, ball, 600);
  next_standing_event(watch, &event);
  entered = event.sequence;
  expect(event.kind == COLLIDED_STANDING_ENTER && event.form == COLLIDED_FORM_REGION && !strcmp(event.object, "c_cart") &&
             !strcmp(event.standing, "c_dock"),
         "it enters");
  expect(event.doubt == 0 && event.bracket_low_s >= event.bracket_high_s, "with a bracket");
  expect(fabs(event.point[0] - 599) < 1e-3, "at the side it came from");
  move_to(publisher, ball, 603);
  next_standing_event(watch, &event);
  expect(event.kind == COLLIDED_STANDING_EXIT && event.episode == entered, "it exits what it entered");
  move_to(publisher, ball, 597);
  next_standing_event(watch, &event);
  expect(event.kind == COLLIDED_STANDING_CROSS && event.left_low_s < event.bracket_low_s, "it crosses between two poses");
  expect(collided_standing_watch_lost(watch) == 0 && collided_standing_watch_in_step(watch) == 1, "nothing is lost");
  event.size = sizeof event;
  expect(collided_standing_watch_next(watch, 1000000, &event, &error) == COLLIDED_NOTHING, "no more of it");
  collided_standing_watch_close(watch);
  collided_publisher_close(publisher);
  must(collided_standing_remove(client, "c_d*", COLLIDED_FORM_BANDS, &removed, &error), &error, "remove bands");
  expect(removed == 0, "a region has no bands");
  must(collided_standing_remove(client, "c_d*", COLLIDED_FORM_REGION, &removed, &error), &error, "remove a region");
  expect(removed == 1, "one region removed");
}

/* Bands of 2 m and 1 m about a ball: another one comes near, touches it, and goes. */
static void bands(collided_client* client) {
  static const double falling[2] = {2, 1};
  static const double rising[2] = {1, 2};
  static const int kinds[6] = {COLLIDED_STANDING_APPROACH, COLLIDED_STANDING_NEAR,  COLLIDED_STANDING_CONTACT,
                               COLLIDED_STANDING_LEAVE,    COLLIDED_STANDING_LEAVE, COLLIDED_STANDING_LEAVE};
  static const double at_band[6] = {2, 1, 0, 0, 1, 2};
  collided_error error;
  collided_part part;
  collided_object object;
  collided_standing asked;
  collided_standing_event event;
  collided_standing_watch* watch = NULL;
  collided_publisher* publisher = NULL;
  uint32_t post, drone;
  uint64_t removed = 0, parts = 7;
  int i, seen = 0;
  error.size = sizeof error;
  memset(&asked, 0, sizeof asked);
  asked.size = sizeof asked;
  asked.form = COLLIDED_FORM_BANDS;
  asked.name = "c_close";
  asked.around = "c_post";
  asked.only = "c_drone";
  asked.bands_m = rising;
  asked.band_count = 2;
  expect(collided_standing_add(client, &asked, NULL, &error) != COLLIDED_OK, "bands come the widest first");
  asked.bands_m = falling;
  must(collided_standing_add(client, &asked, &parts, &error), &error, "add bands");
  expect(parts == 0, "no part of a scene is meant");
  must(collided_standing_watch_start(client, NULL, NULL, COLLIDED_FORM_BANDS, &watch, &error), &error, "watch bands");
  await_in_step(watch);

  must(collided_publish(client, "c_pilot", &publisher, &error), &error, "publish");
  memset(&part, 0, sizeof part);
  part.size = sizeof part;
  part.kind = COLLIDED_SPHERE;
  part.numbers[3] = 0.5;
  collided_object_defaults(&object, sizeof object);
  object.name = "c_post";
  object.parts = &part;
  object.part_count = 1;
  object.position[0] = 650;
  must(collided_publisher_add(publisher, &object, &post, &error), &error, "add a ball");
  object.name = "c_drone";
  object.position[0] = 660;
  must(collided_publisher_add(publisher, &object, &drone, &error), &error, "add another");
  must(collided_publisher_flush(publisher, 0, NULL, &error), &error, "flush");
  move_to(publisher, drone, 652.75);
  next_standing_event(watch, &event);
  expect(event.kind == COLLIDED_STANDING_APPROACH && event.form == COLLIDED_FORM_BANDS && event.band_m == 2 &&
             !strcmp(event.standing, "c_close"),
         "the widest band");
  expect(!strcmp(event.object, "c_drone") && !strcmp(event.other, "c_post"), "what comes near what");
  expect(fabs(event.distance_m - 2) <= event.distance_error_m + 1e-6 && event.closing_mps > 0, "how near, how fast");
  expect(event.has_contact_in == 1 && event.contact_in_low_s <= event.contact_in_high_s, "and when they would touch");
  move_to(publisher, drone, 650.5);
  move_to(publisher, drone, 660);
  for (i = 1; i < 6; ++i) {
    next_standing_event(watch, &event);
    expect(event.kind == kinds[i] || event.kind == COLLIDED_STANDING_LEAVE, "an order of events");
    seen += event.kind == kinds[i];
    if (event.kind != COLLIDED_STANDING_LEAVE) expect(event.band_m == at_band[i], "band after band");
  }
  expect(seen == 5, "near, contact, and out of each band");
  expect(collided_standing_watch_lost(watch) == 0, "nothing is lost");
  collided_standing_watch_close(watch);
  collided_publisher_close(publisher);
  must(collided_standing_remove(client, "c_close", COLLIDED_FORM_ANY, &removed, &error), &error, "remove bands");
  expect(removed == 1, "one question removed");
}

/* Which of two balls is nearest to a point; one passes the other. */
static void nearest(collided_client* client) {
  collided_error error;
  collided_part part;
  collided_object object;
  collided_standing asked;
  collided_standing_event event;
  collided_standing_watch* watch = NULL;
  collided_publisher* publisher = NULL;
  uint32_t post, drone;
  uint64_t removed = 0;
  error.size = sizeof error;
  memset(&asked, 0, sizeof asked);
  asked.size = sizeof asked;
  asked.form = COLLIDED_FORM_NEAREST;
  asked.name = "c_first";
  asked.only = "c_near_*";
  asked.point[0] = 700;
  expect(collided_standing_add(client, &asked, NULL, &error) != COLLIDED_OK, "a distance is needed");
  asked.within_m = 50;
  must(collided_standing_add(client, &asked, NULL, &error), &error, "add a question for the nearest");

  must(collided_publish(client, "c_pilot", &publisher, &error), &error, "publish");
  memset(&part, 0, sizeof part);
  part.size = sizeof part;
  part.kind = COLLIDED_SPHERE;
  part.numbers[3] = 0.5;
  collided_object_defaults(&object, sizeof object);
  object.name = "c_near_post";
  object.parts = &part;
  object.part_count = 1;
  object.position[0] = 705;
  must(collided_publisher_add(publisher, &object, &post, &error), &error, "add a ball");
  object.name = "c_near_drone";
  object.position[0] = 720;
  must(collided_publisher_add(publisher, &object, &drone, &error), &error, "add another");
  must(collided_publisher_flush(publisher, 0, NULL, &error), &error, "flush");
  must(collided_standing_watch_start(client, NULL, NULL, COLLIDED_FORM_NEAREST, &watch, &error), &error, "watch the nearest");
  next_standing_event(watch, &event);
  expect(event.form == COLLIDED_FORM_NEAREST && !strcmp(event.standing, "c_first") && !strcmp(event.object, "c_near_post"),
         "what is nearest at first");
  await_in_step(watch);
  move_to(publisher, drone, 702);
  next_standing_event(watch, &event);
  expect(event.kind == COLLIDED_STANDING_CHANGED && !strcmp(event.other, "c_near_post") &&
             !strcmp(event.object, "c_near_drone"),
         "which one is nearest now, and which one was");
  expect(fabs(event.distance_m - 4.5) <= event.distance_error_m + 1e-3, "how near");
  expect(collided_standing_watch_lost(watch) == 0, "nothing is lost");
  collided_standing_watch_close(watch);
  collided_publisher_close(publisher);
  must(collided_standing_remove(client, "c_first", COLLIDED_FORM_NEAREST, &removed, &error), &error, "remove a question");
  expect(removed == 1, "one question removed");
}

/* What the three questions above reported, read from the server's memory of it. */
static void recordings(collided_client* client) {
  static const char* const names[3] = {"c_dock", "c_close", "c_first"};
  static const int least[3] = {3, 2, 2};
  collided_error error;
  collided_recorded_options options;
  collided_recorded_about about;
  collided_recorded_standing* recorded = NULL;
  collided_standing_event event;
  int counts[3] = {0, 0, 0};
  char* answer = NULL;
  char* path;
  size_t i, first = 0;
  error.size = sizeof error;
  must(collided_command(client, "recording", "{\"last_s\":60}", 10000000000L, &answer, &error), &error, "record");
  path = strstr(answer, "\"path\":\"");
  expect(path != NULL, "where the recording is");
  if (path == NULL) return;
  path += strlen("\"path\":\"");
  *strchr(path, '"') = 0;
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.only = "c_*";
  must(collided_read_recorded_standing(path, &options, &recorded, &error), &error, "read it");
  about.size = sizeof about;
  collided_about_recorded_standing(recorded, &about);
  expect(about.lost == 0 && about.warnings == 0 && about.begin_ns < about.end_ns, "nothing is missing");
  event.size = sizeof event;
  for (i = 0; i < about.events; ++i) {
    expect(collided_recorded_standing_event(recorded, i, &event) == COLLIDED_OK, "each event");
    expect(event.form >= COLLIDED_FORM_REGION && event.form <= COLLIDED_FORM_NEAREST, "of one form");
    if (event.form >= 0 && event.form < 3 && !strcmp(event.standing, names[event.form])) ++counts[event.form];
    if (first == 0 && !strcmp(event.standing, "c_dock")) first = i + 1;
  }
  for (i = 0; i < 3; ++i) expect(counts[i] >= least[i], names[i]);
  expect(collided_recorded_standing_event(recorded, about.events, &event) == COLLIDED_NOTHING, "no more of them");
  expect(first > 0 && collided_recorded_standing_event(recorded, first - 1, &event) == COLLIDED_OK &&
             event.kind == COLLIDED_STANDING_ENTER && !strcmp(event.object, "c_cart"),
         "the cart enters first");
  expect(collided_recorded_warning(recorded, 0) == NULL, "no warning");
  collided_free_recorded_standing(recorded);
  options.from_since = COLLIDED_SINCE_END;
  options.from_ns = 1;
  must(collided_read_recorded_standing(path, &options, &recorded, &error), &error, "read what holds at its end");
  collided_about_recorded_standing(recorded, &about);
  expect(about.events == 0, "nothing is left");
  collided_free_recorded_standing(recorded);
  options.to_since = 4;
  expect(collided_read_recorded_standing(path, &options, &recorded, &error) == COLLIDED_BAD_INPUT && recorded == NULL, "since when");
  expect(collided_read_recorded_standing("/nowhere.mcap", NULL, &recorded, &error) == COLLIDED_BAD_INPUT, "no file");
  collided_free_text(answer);
}

/* An answer of the command `explain`, to be freed. */
static char* explained(collided_client* client, const char* arguments) {
  collided_error error;
  char* answer = NULL;
  error.size = sizeof error;
  must(collided_command(client, "explain", arguments, 10000000000L, &answer, &error), &error, arguments);
  return answer;
}

/* Why a ray meets the floor and neither the glass nor the mast, and what is behind a region and an event of it. */
static void explanations(collided_client* client) {
  static const char* const names[3] = {"c_glass", "c_floor", "c_mast"};
  static const double places[3][3] = {{900, 0, 2}, {900, 0, -0.5}, {901, 0, 2}};
  collided_error error;
  collided_part part;
  collided_object object;
  collided_standing region;
  char question[64];
  char* answer;
  const char* news;
  uint64_t removed = 0;
  size_t i;
  error.size = sizeof error;
  memset(&part, 0, sizeof part);
  part.size = sizeof part;
  part.kind = COLLIDED_BOX;
  part.numbers[0] = part.numbers[1] = part.numbers[2] = 0.5;
  part.numbers[6] = 1;
  collided_object_defaults(&object, sizeof object);
  object.parts = &part;
  object.part_count = 1;
  for (i = 0; i < 3; ++i) {
    object.name = names[i];
    object.layers = i == 0 ? 2 : 1;
    memcpy(object.position, places[i], sizeof object.position);
    must(collided_add(client, &object, NULL, &error), &error, "add a box");
  }
  answer = explained(client, "{\"ray\":[900,0,5,0,0,-1],\"mask\":1,\"why_not\":\"c_mast\",\"most\":1}");
  expect(strstr(answer, "\"answer\":\"hit\"") && strstr(answer, "are not in the mask 0x1") &&
             strstr(answer, "\"box_met\":false") && strstr(answer, "\"object\":\"c_floor\""), "the ray");
  collided_free_text(answer);
  answer = explained(client, "{\"a\":\"c_mast\",\"b\":\"c_floor\"}");
  expect(strstr(answer, "\"answer\":\"miss\"") && strstr(answer, "\"end\":\"found\""), "the pair");
  collided_free_text(answer);

  memset(&region, 0, sizeof region);
  region.size = sizeof region;
  region.name = "c_yard";
  part.numbers[3] = 900;
  part.numbers[4] = 20;
  region.parts = &part;
  region.part_count = 1;
  region.only = "c_m*";
  must(collided_standing_add(client, &region, NULL, &error), &error, "add a region");
  must(collided_move(client, "c_mast", part.numbers + 3, NULL, 0, &error), &error, "move into it");
  answer = explained(client, "{\"standing\":\"c_yard\"}");
  expect(strstr(answer, "\"looked_at\":1") && strstr(answer, "\"reported\":true"), "the region");
  news = strstr(answer, "\"sequence\":");
  sprintf(question, "{\"event\":%lu,\"of\":\"standing\"}", news ? strtoul(news + strlen("\"sequence\":"), NULL, 10) : 0);
  collided_free_text(answer);
  answer = explained(client, question);
  expect(strstr(answer, "\"what\":\"enter\"") && strstr(answer, "\"a\":\"c_mast\""), "the event");
  collided_free_text(answer);
  expect(collided_command(client, "explain", "{\"standing\":\"c_none\"}", 0, &answer, &error) == COLLIDED_REFUSED, "no such question");
  must(collided_standing_remove(client, "c_yard", COLLIDED_FORM_ANY, NULL, &error), &error, "remove the region");
  for (i = 0; i < 3; ++i) must(collided_remove(client, names[i], &removed, &error), &error, "remove a box");
}

/* One ray of unit direction: its verdict, and in *distance where it hits. */
static int ray_along_x(collided_client* client, double x, double y, double z, double* distance) {
  collided_error error;
  collided_answers* answers = NULL;
  collided_columns columns;
  double origin[3], direction[3] = {1, 0, 0};
  unsigned char verdict = 0;
  error.size = sizeof error;
  origin[0] = x;
  origin[1] = y;
  origin[2] = z;
  must(collided_ask_rays(client, 1, origin, direction, NULL, NULL, &answers, &error), &error, "a ray");
  memset(&columns, 0, sizeof columns);
  columns.size = sizeof columns;
  columns.first_hits = 1;
  columns.verdict = &verdict;
  columns.distance_m = distance;
  collided_read_columns(answers, &columns);
  collided_free_answers(answers);
  return verdict;
}

/* A scan of one point makes its cell of 0.5 m occupied, and those on the way to it free. */
static void voxels(collided_client* client) {
  static const double point[3] = {703.25, 0.25, 0.25};
  static const float floats[6] = {703.25f, 0.25f, 0.25f, 704.25f, 0.25f, 0.25f};
  static const double sensor[3] = {700.25, 0.25, 0.25};
  collided_error error;
  collided_voxel_options options;
  collided_voxel_scan scan;
  collided_voxels* cells = NULL;
  collided_publisher* publisher = NULL;
  double distance = 0, bad[3];
  size_t changed = 0;
  error.size = sizeof error;
  must(collided_publish(client, "c_scanner", &publisher, &error), &error, "publish");
  collided_voxel_defaults(&options, sizeof options);
  options.cell_m = 0.5;
  options.unknown = 0;
  options.decay_ns = 1000000000L;
  must(collided_voxels_start(publisher, "c_cloud", &options, &cells, &error), &error, "voxels");
  memset(&scan, 0, sizeof scan);
  scan.size = sizeof scan;
  must(collided_voxels_insert(cells, 1, point, sensor, 0, &scan, &error), &error, "insert");
  expect(scan.points == 1 && scan.occupied == 1 && scan.changed == 1, "what became of the scan");
  must(collided_publisher_wait_applied(publisher, 5000000000L, &error), &error, "wait");
  expect(ray_along_x(client, 700.25, 0.25, 0.25, &distance) == COLLIDED_HIT && fabs(distance - 2.75) < 1e-9, "its cell");
  must(collided_voxels_insert_floats(cells, 2, floats, NULL, 0, &scan, &error), &error, "insert floats");
  expect(scan.points == 2 && scan.occupied == 2 && scan.crossed == 0, "without a sensor no space is free");
  bad[0] = HUGE_VAL;
  bad[1] = bad[2] = 0;
  must(collided_voxels_insert(cells, 1, bad, NULL, 0, &scan, &error), &error, "insert an endless point");
  expect(scan.points == 0 && scan.refused == 1, "what is not finite is counted");
  expect(collided_voxels_insert(cells, 1, NULL, NULL, 0, &scan, &error) == COLLIDED_BAD_INPUT, "no array");
  must(collided_voxels_decay(cells, 0, &changed, &error), &error, "decay");
  expect(changed == 0, "nothing is old yet");
  must(collided_voxels_clear(cells, &error), &error, "clear");
  must(collided_publisher_wait_applied(publisher, 5000000000L, &error), &error, "wait");
  expect(ray_along_x(client, 700.25, 0.25, 0.25, &distance) == COLLIDED_MISS, "nothing is left");
  collided_voxels_close(cells);
  collided_publisher_close(publisher);
}

int main(int count, char** words) {
  collided_error error;
  collided_connect_options options;
  collided_client* client = NULL;
  collided_status status;
  if (count != 2) return 2;
  srand(1);
  error.size = sizeof error;
  memset(&options, 0, sizeof options);
  options.size = sizeof options;
  options.domain = atoi(words[1]);
  must(collided_connect(&options, &client, &error), &error, "connect");
  status.size = sizeof status;
  must(collided_get_status(client, &status, &error), &error, "status");
  expect(!strcmp(status.state, "ready") && !strcmp(status.version_text, collided_version()), "the status");
  rays(client);
  moves_and_events(client);
  refusals(client);
  groups(client);
  regions(client);
  bands(client);
  nearest(client);
  recordings(client);
  explanations(client);
  voxels(client);
  collided_close(client);
  printf("%d faults\n", faults);
  return faults > 0;
}
