/* A C89 program that does what the header offers: asks, adds, publishes, watches, adds standing questions, moves a robot, and
 * turns scans into voxels.
 * usage: c_client DOMAIN URDF */
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

/* The number that a JSON text has for a name; NaN if it has none. */
static double number_in(const char* json, const char* name) {
  char quoted[64];
  const char* found;
  sprintf(quoted, "\"%s\":", name);
  found = json ? strstr(json, quoted) : NULL;
  return found ? strtod(found + strlen(quoted), NULL) : strtod("nan", NULL);
}

static int has(const char* json, const char* piece) { return json != NULL && strstr(json, piece) != NULL; }

/* Sends a command that must go well. The answer is valid until the next call. */
static const char* command(collided_client* client, const char* name, const char* arguments, const collided_part* part) {
  static char* answer = NULL;
  collided_error error;
  error.size = sizeof error;
  collided_free_text(answer);
  answer = NULL;
  must(collided_command(client, name, arguments, part, part != NULL, 10000000000L, &answer, &error), &error, arguments);
  return answer;
}

/* The code of a command that is refused. */
static int refused(collided_client* client, const char* name, const char* arguments, const collided_part* part) {
  collided_error error;
  error.size = sizeof error;
  return collided_command(client, name, arguments, part, part != NULL, 0, NULL, &error);
}

static collided_part part_of(int kind) {
  collided_part part;
  memset(&part, 0, sizeof part);
  part.size = sizeof part;
  part.kind = kind;
  return part;
}
static collided_part ball(double radius) {
  collided_part part = part_of(COLLIDED_SPHERE);
  part.numbers[3] = radius;
  return part;
}
static collided_part box(double half, double x) {
  collided_part part = part_of(COLLIDED_BOX);
  part.numbers[0] = part.numbers[1] = part.numbers[2] = half;
  part.numbers[3] = x;
  part.numbers[6] = 1;
  return part;
}

static collided_publisher* published(collided_client* client, const char* name) {
  collided_error error;
  collided_publisher* publisher = NULL;
  error.size = sizeof error;
  must(collided_publish(client, name, NULL, &publisher, &error), &error, "publish");
  return publisher;
}

/* A publisher's ball with its center on the x axis. */
static uint32_t add_ball(collided_publisher* publisher, const char* name, double radius, double x) {
  char object[128];
  const collided_part part = ball(radius);
  collided_error error;
  uint32_t handle;
  error.size = sizeof error;
  sprintf(object, "{\"name\":\"%s\",\"pose\":[%g,0,0,1,0,0,0]}", name, x);
  must(collided_publisher_add(publisher, object, &part, 1, &handle, &error), &error, "add a ball");
  must(collided_publisher_flush(publisher, 0, NULL, &error), &error, "flush");
  return handle;
}

static uint64_t lost_of(const collided_watch* watch) {
  uint64_t lost = 1;
  collided_watch_health(watch, &lost, NULL);
  return lost;
}

static void rays(collided_client* client) {
  static double rows[7 * MANY], distances[MANY];
  static unsigned char verdicts[MANY];
  static uint32_t counts[MANY];
  collided_error error;
  collided_answers* answers = NULL;
  collided_answers_info info;
  collided_columns columns;
  int i, round, hits = 0;
  error.size = sizeof error;
  for (i = 0; i < MANY; ++i) {
    double* const ray = rows + 7 * i;
    ray[0] = number(-5, 5);
    ray[1] = number(-5, 5);
    ray[2] = 4;
    ray[3] = number(-1, 1);
    ray[4] = number(-1, 1);
    ray[5] = -1;
    ray[6] = HUGE_VAL;
  }
  for (round = 0; round < 3; ++round) { /* the second and third use the first one's memory */
    must(collided_ask(client, COLLIDED_ASK_RAYS, rows, MANY, NULL, &answers, &error), &error, "rays");
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

static void moves_and_events(collided_client* client) {
  collided_error error;
  collided_part wall = box(1, 0);
  const collided_part taken = ball(0.2);
  collided_watch *polled = NULL, *bulk = NULL;
  collided_publisher* publisher = NULL;
  /* As a header with a longer struct has it. */
  struct {
    collided_event event;
    double of_a_later_version;
  } events[4];
  uint32_t handle;
  size_t count = 0;
  char* text = NULL;
  const char* pair;
  double position[3];
  int i, began = 0, ended = 0, read = 0;
  error.size = sizeof error;
  must(collided_watch_start(client, COLLIDED_WATCH_CONTACTS, "{\"only\":\"c_wall\"}", &polled, &error), &error, "watch");
  must(collided_watch_start(client, COLLIDED_WATCH_CONTACTS, "{\"only\":\"c_wall\"}", &bulk, &error), &error, "watch in bulk");
  wall.numbers[0] = 0.1;
  command(client, "add", "{\"name\":\"c_wall\",\"pose\":[500,0,0,1,0,0,0]}", &wall);

  expect(collided_publish(client, "c_mover", "{\"gap_ns\":0}", &publisher, &error) == COLLIDED_BAD_INPUT, "no gap");
  expect(collided_publish(client, "c_mover", "{\"gap\":2}", &publisher, &error) == COLLIDED_BAD_INPUT, "no such option");
  expect(strstr(error.message, "'gap' is unknown; known are lease_ns, gap_ns") != NULL && publisher == NULL, "and which there are");
  must(collided_publish(client, "c_mover", "{\"gap_ns\":2000000000}", &publisher, &error), &error, "publish");
  handle = add_ball(publisher, "c_ball", 0.2, 497);
  must(collided_publisher_wait_applied(publisher, 5000000000L, &error), &error, "wait");
  pair = command(client, "pair", "{\"a\":\"c_wall\",\"b\":\"c_ball\"}", NULL);
  expect(has(pair, "\"answer\":\"miss\"") && fabs(number_in(pair, "distance") - 2.7) < 0.01, "2.7 m apart");
  position[1] = position[2] = 0;
  for (i = 0; i <= 60; ++i) {
    position[0] = 497 + 0.1 * i;
    must(collided_publisher_move(publisher, 1, &handle, position, NULL, 0, &error), &error, "move");
    must(collided_publisher_flush(publisher, 0, NULL, &error), &error, "flush");
  }
  expect(error.code == COLLIDED_OK && error.message[0] == 0, "it was not lost");
  must(collided_publisher_keep_alive(publisher, 0, &error), &error, "keep alive");
  must(collided_publisher_wait_applied(publisher, 5000000000L, &error), &error, "wait");
  must(collided_publisher_report(publisher, 5000000000L, &text, &error), &error, "report");
  expect(has(text, "\"left_out\":[],\"left_out_count\":0,\"merged_poses\":0,\"refused\":\"\""), "everything is taken");
  collided_free_text(text);
  must(collided_publisher_add(publisher, "{\"name\":\"c_wall\"}", &taken, 1, NULL, &error), &error, "add a name that is taken");
  must(collided_publisher_flush(publisher, 0, NULL, &error), &error, "flush");
  expect(collided_publisher_wait_applied(publisher, 5000000000L, &error) == COLLIDED_REFUSED, "the name is taken");
  must(collided_publisher_report(publisher, 5000000000L, &text, &error), &error, "report");
  expect(has(text, "\"left_out\":[[\"c_wall\",\"the name is taken\"]],\"left_out_count\":1"), "the report says so");
  collided_free_text(text);
  for (i = 0; i < 100 && ended == 0; ++i) {
    const int code = collided_watch_next(polled, 100000000, &text, &error);
    if (code == COLLIDED_NOTHING) continue;
    must(code, &error, "next");
    began += has(text, "\"kind\":\"began\"");
    ended += has(text, "\"kind\":\"ended\"");
    expect(has(text, "\"poses_merged\":false") && has(text, "\"c_wall\""), "its members");
    collided_free_text(text);
  }
  expect(began == 1 && ended == 1, "the ball met the wall once and left it");
  events[0].event.size = sizeof events[0];
  began = ended = 0;
  for (i = 0; i < 100 && ended == 0; ++i) {
    size_t at;
    const int code = collided_watch_read(bulk, 100000000, &events[0].event, 4, &count, &error);
    if (code == COLLIDED_NOTHING) continue;
    must(code, &error, "read");
    for (at = 0; at < count; ++at, ++read) {
      const collided_event* const event = &events[at].event;
      began += event->kind == COLLIDED_CONTACT_BEGAN;
      ended += event->kind == COLLIDED_CONTACT_ENDED;
      if (event->kind == COLLIDED_CONTACT_BEGAN) {
        expect(!memcmp(event->surface_normal, event->normal, sizeof event->normal), "a wall alone is one surface");
        expect(event->surface_depth_m == event->depth_m && event->surface_depth_error_m == event->depth_error_m, "and its depth");
      }
      expect(event->poses_merged == 0, "none of its poses was replaced");
      expect(!strcmp(event->a, "c_wall") || !strcmp(event->b, "c_wall"), "the names");
    }
  }
  expect(began == 1 && ended == 1 && read == 2, "the same in bulk");
  expect(lost_of(polled) == 0 && lost_of(bulk) == 0, "no event lost");
  expect(collided_watch_read(bulk, 0, NULL, 4, &count, &error) == COLLIDED_BAD_INPUT, "no array");
  collided_watch_close(bulk);
  collided_watch_close(polled);
  collided_publisher_close(publisher);
  expect(has(command(client, "remove", "{\"name\":\"c_wall\"}", NULL), "\"removed\":[\"c_wall\"]"), "one object removed");
}

/* A ball of radius 0.5 goes 4 m to a box whose face is 2.5 m away. */
static void sweeps(collided_client* client) {
  const double motions[28] = {0, 0, 200, 1, 0, 0, 0, 4, 0, 200, 1, 0, 0, 0, 0, 0, 200, 1, 0, 0, 0, 1, 0, 200, 1, 0, 0, 0};
  const collided_part wall = box(0.5, 3), probe = ball(0.5);
  collided_ask_options options;
  collided_error error;
  collided_answers* answers = NULL;
  collided_columns columns;
  unsigned char verdicts[2];
  double low[2], high[2];
  error.size = sizeof error;
  command(client, "add", "{\"name\":\"c_gate\",\"pose\":[0,0,200,1,0,0,0]}", &wall);
  collided_ask_defaults(&options, sizeof options);
  expect(collided_ask(client, COLLIDED_ASK_SWEEPS, motions, 2, &options, &answers, &error) == COLLIDED_BAD_INPUT, "no shape");
  options.only = "c_gate";
  options.shape = &probe;
  options.shape_parts = 1;
  must(collided_ask(client, COLLIDED_ASK_SWEEPS, motions, 2, &options, &answers, &error), &error, "sweep");
  memset(&columns, 0, sizeof columns);
  columns.size = sizeof columns;
  columns.first_hits = 1;
  columns.verdict = verdicts;
  columns.time_low = low;
  columns.time_high = high;
  collided_read_columns(answers, &columns);
  expect(verdicts[0] == COLLIDED_HIT && low[0] <= 0.5 && high[0] >= 0.5 && high[0] - low[0] < 1e-5, "the first contact");
  expect(verdicts[1] == COLLIDED_MISS, "a motion that is free");
  collided_free_answers(answers);
  command(client, "remove", "{\"name\":\"c_gate\"}", NULL);
}

static void refusals(collided_client* client) {
  collided_error error;
  collided_answers* answers = NULL;
  collided_watch* watch = NULL;
  collided_publisher* publisher = NULL;
  collided_client* other = NULL;
  const double zero[7] = {0, 0, 0, 0, 0, 0, 0};
  error.size = sizeof error;
  expect(collided_ask(client, COLLIDED_ASK_RAYS, zero, 1, NULL, &answers, &error) == COLLIDED_BAD_INPUT, "no direction");
  expect(error.code == COLLIDED_BAD_INPUT && strlen(error.message) > 10 && answers == NULL, "and why");
  expect(collided_ask(client, COLLIDED_ASK_RAYS, NULL, 1, NULL, &answers, &error) == COLLIDED_BAD_INPUT, "no array");
  expect(collided_ask(client, 6, zero, 1, NULL, &answers, &error) == COLLIDED_BAD_INPUT, "no such question");
  expect(collided_ask(NULL, COLLIDED_ASK_RAYS, zero, 1, NULL, &answers, NULL) == COLLIDED_BAD_INPUT, "no client");
  expect(refused(client, "pair", "{\"a\":\"nosuch\",\"b\":\"neither\"}", NULL) == COLLIDED_REFUSED, "unknown names");
  expect(refused(client, "list", "[2]", NULL) == COLLIDED_BAD_INPUT, "not an object");
  expect(has(command(client, "list", "{\"limit\":2}", NULL), "\"objects\":["), "the answer of a command");
  expect(collided_connect("{\"domain\":1e9}", &other, &error) == COLLIDED_BAD_INPUT && other == NULL, "a domain is whole");
  expect(collided_connect("{\"domain\":4294967297}", &other, &error) == COLLIDED_BAD_INPUT, "and not beyond 32 bits");
  expect(collided_publish(client, "c_x", "{\"gap_ns\":", &publisher, &error) == COLLIDED_BAD_INPUT, "cut short");
  expect(collided_watch_start(client, 3, NULL, &watch, &error) == COLLIDED_BAD_INPUT && watch == NULL, "no such watch");
  expect(collided_watch_start(client, COLLIDED_WATCH_CONTACTS, "{\"capacity\":0}", &watch, &error) == COLLIDED_BAD_INPUT, "no room");
  collided_watch_health(NULL, NULL, NULL);
  collided_free_text(NULL);
  collided_free_answers(NULL);
  collided_close(NULL);
}

/* A cube a metre from a wall: how near, and whether it would be free elsewhere. */
static void groups(collided_client* client) {
  static const double poses[21] = {0, 0, 60, 1, 0, 0, 0, 0.5, 0, 60, 1, 0, 0, 0, 1.5, 0, 60, 1, 0, 0, 0};
  const collided_part cube = box(0.5, 0);
  collided_error error;
  collided_answers* answers = NULL;
  collided_answers_info info;
  collided_columns columns;
  uint8_t verdicts[3], by_winding[6];
  double distances[6], uncovered[9], covered[3];
  const char* clearance;
  error.size = sizeof error;
  info.size = sizeof info;
  command(client, "add", "{\"name\":\"c_hand\",\"pose\":[0,0,60,1,0,0,0]}", &cube);
  command(client, "add", "{\"name\":\"c_wall\",\"pose\":[2,0,60,1,0,0,0]}", &cube);
  clearance = command(client, "clearance", "{\"from\":\"c_hand\",\"to\":\"c_wall\"}", NULL);
  expect(has(clearance, "\"answer\":\"miss\"") && fabs(number_in(clearance, "clearance") - 1) < 1e-9, "a metre");
  expect(has(clearance, "\"a\":\"c_hand\"") && has(clearance, "\"b\":\"c_wall\""), "names");
  memset(&columns, 0, sizeof columns);
  columns.size = sizeof columns;
  columns.verdict = verdicts;
  columns.distance_m = distances;
  columns.by_winding = by_winding;
  columns.uncovered = uncovered;
  columns.covered_m = covered;
  must(collided_what_if(client, "{\"objects\":[\"c_hand\"]}", poses, 3, NULL, &answers, &error), &error, "what-if");
  collided_get_info(answers, &info);
  expect(info.questions == 3 && info.hits == 6, "a pair of hits for each configuration");
  if (info.hits == 6) collided_read_columns(answers, &columns);
  expect(verdicts[0] == COLLIDED_MISS && verdicts[1] == COLLIDED_MISS && verdicts[2] == COLLIDED_HIT, "free, free, not");
  expect(fabs(distances[2] - 0.5) < 1e-9 && fabs(distances[4] + 0.5) < 1e-9, "their clearances");
  expect(by_winding[0] == 0 && by_winding[5] == 0, "no distance by winding number");
  expect(uncovered[0] != uncovered[0] && covered[0] != covered[0], "nothing is uncovered");
  expect(!strcmp(collided_hit_object(answers, 0), "c_hand") && !strcmp(collided_hit_object(answers, 1), "c_wall"), "names");
  collided_free_answers(answers);
  answers = NULL;
  expect(refused(client, "clearance", "{\"from\":\"nobody\"}", NULL) == COLLIDED_REFUSED, "no group");
  expect(collided_what_if(client, "{\"objects\":[\"c_hand\"]}", NULL, 1, NULL, &answers, &error) == COLLIDED_BAD_INPUT, "no poses");
  expect(collided_what_if(client, "{\"objects\":[\"c_hand\"],\"attached\":[[\"c_wall\"]]}", poses, 1, NULL, &answers, &error) ==
             COLLIDED_BAD_INPUT, "attached to what");
  command(client, "remove", "{\"name\":\"c_*\"}", NULL);
}

/* The next event of a standing question, or the end of the test if none comes. It is valid until the next call. */
static const char* next_event(collided_watch* watch) {
  static char* event = NULL;
  collided_error error;
  int i, code = COLLIDED_NOTHING;
  error.size = sizeof error;
  collided_free_text(event);
  event = NULL;
  for (i = 0; i < 200 && code == COLLIDED_NOTHING; ++i) code = collided_watch_next(watch, 100000000, &event, &error);
  must(code, &error, "an event");
  return event;
}

static int in_step(const collided_watch* watch) {
  int32_t is_so = 0;
  collided_watch_health(watch, NULL, &is_so);
  return is_so;
}

/* Until then what is reported may have held before. */
static collided_watch* watched(collided_client* client, const char* options, int until_in_step) {
  collided_error error;
  collided_watch* watch = NULL;
  int i;
  error.size = sizeof error;
  must(collided_watch_start(client, COLLIDED_WATCH_STANDING, options, &watch, &error), &error, "watch standing questions");
  for (i = 0; until_in_step && i < 500 && !in_step(watch); ++i) collided_watch_next(watch, 10000000, NULL, &error);
  return watch;
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
  const collided_part part = box(1, 600);
  collided_error error;
  collided_watch* watch = NULL;
  collided_publisher* publisher;
  const char* event;
  double entered;
  uint32_t cart;
  error.size = sizeof error;
  command(client, "fence", "{\"name\":\"c_dock\",\"only\":\"c_*\"}", &part);
  expect(refused(client, "fence", "{\"name\":\"c_dock\",\"only\":\"c_*\"}", &part) == COLLIDED_REFUSED, "one question of a name");
  expect(refused(client, "fence", "{\"name\":\"c_nothing\"}", NULL) == COLLIDED_REFUSED, "no region");
  expect(collided_watch_start(client, COLLIDED_WATCH_STANDING, "{\"form\":\"fence\"}", &watch, &error) == COLLIDED_BAD_INPUT &&
             watch == NULL, "no watch of such a form");
  watch = watched(client, "{\"only\":\"c_dock\",\"form\":\"region\"}", 1);

  publisher = published(client, "c_driver");
  cart = add_ball(publisher, "c_cart", 0.2, 597);
  move_to(publisher, cart, 600);
  event = next_event(watch);
  entered = number_in(event, "sequence");
  expect(has(event, "\"kind\":\"enter\"") && has(event, "\"form\":\"region\"") && has(event, "\"object\":\"c_cart\"") &&
             has(event, "\"standing\":\"c_dock\""), "it enters");
  expect(has(event, "\"doubt\":\"\"") && number_in(event, "bracket_low_s") >= number_in(event, "bracket_high_s"), "with a bracket");
  expect(has(event, "\"point\":[") && fabs(strtod(strstr(event, "\"point\":[") + 9, NULL) - 599) < 1e-3, "at the side it came from");
  move_to(publisher, cart, 603);
  event = next_event(watch);
  expect(has(event, "\"kind\":\"exit\"") && number_in(event, "episode") == entered, "it exits what it entered");
  move_to(publisher, cart, 597);
  event = next_event(watch);
  expect(has(event, "\"kind\":\"cross\"") && number_in(event, "left_low_s") < number_in(event, "bracket_low_s"),
         "it crosses between two poses");
  expect(lost_of(watch) == 0 && in_step(watch), "nothing is lost");
  expect(collided_watch_next(watch, 1000000, NULL, &error) == COLLIDED_NOTHING, "no more of it");
  collided_watch_close(watch);
  collided_publisher_close(publisher);
  expect(has(command(client, "fence", "{\"name\":\"c_d*\",\"form\":\"bands\",\"remove\":true}", NULL), "\"standing\":[]"),
         "a region has no bands");
  expect(has(command(client, "fence", "{\"name\":\"c_d*\",\"form\":\"region\",\"remove\":true}", NULL), "\"c_dock\""),
         "one region removed");
}

/* Bands of 2 m and 1 m about a ball: another one comes near, touches it, and goes. */
static void bands(collided_client* client) {
  static const char* const kinds[6] = {"approach", "near", "contact", "leave", "leave", "leave"};
  static const double at_band[6] = {2, 1, 0, 0, 1, 2};
  collided_watch* watch;
  collided_publisher* publisher;
  const char* event;
  uint32_t drone;
  int i, seen = 0;
  expect(refused(client, "fence", "{\"name\":\"c_close\",\"around\":\"c_post\",\"only\":\"c_drone\",\"bands\":[1,2]}", NULL) ==
             COLLIDED_REFUSED, "bands come the widest first");
  command(client, "fence", "{\"name\":\"c_close\",\"around\":\"c_post\",\"only\":\"c_drone\",\"bands\":[2,1]}", NULL);
  watch = watched(client, "{\"form\":\"bands\"}", 1);

  publisher = published(client, "c_pilot");
  add_ball(publisher, "c_post", 0.5, 650);
  drone = add_ball(publisher, "c_drone", 0.5, 660);
  move_to(publisher, drone, 652.75);
  event = next_event(watch);
  expect(has(event, "\"kind\":\"approach\"") && has(event, "\"form\":\"bands\"") && number_in(event, "band") == 2 &&
             has(event, "\"standing\":\"c_close\""), "the widest band");
  expect(has(event, "\"object\":\"c_drone\"") && has(event, "\"other\":\"c_post\""), "what comes near what");
  expect(fabs(number_in(event, "distance") - 2) <= number_in(event, "distance_error") + 1e-6 &&
             number_in(event, "closing_mps") > 0, "how near, how fast");
  expect(has(event, "\"contact_in\":{") && number_in(event, "low_s") <= number_in(event, "high_s"), "and when they would touch");
  move_to(publisher, drone, 650.5);
  move_to(publisher, drone, 660);
  for (i = 1; i < 6; ++i) {
    char kind[32];
    int is_leave;
    event = next_event(watch);
    sprintf(kind, "\"kind\":\"%s\"", kinds[i]);
    is_leave = has(event, "\"kind\":\"leave\"");
    expect(has(event, kind) || is_leave, "an order of events");
    seen += has(event, kind);
    if (!is_leave) expect(number_in(event, "band") == at_band[i], "band after band");
  }
  expect(seen == 5, "near, contact, and out of each band");
  expect(lost_of(watch) == 0, "nothing is lost");
  collided_watch_close(watch);
  collided_publisher_close(publisher);
  expect(has(command(client, "fence", "{\"name\":\"c_close\",\"remove\":true}", NULL), "\"c_close\""), "one question removed");
}

/* Which of two balls is nearest to a point; one passes the other. */
static void nearest(collided_client* client) {
  collided_watch* watch;
  collided_publisher* publisher;
  const char* event;
  uint32_t drone;
  expect(refused(client, "fence", "{\"name\":\"c_first\",\"only\":\"c_near_*\",\"point\":[700,0,0],\"within\":0}", NULL) ==
             COLLIDED_REFUSED, "a distance is needed");
  command(client, "fence", "{\"name\":\"c_first\",\"only\":\"c_near_*\",\"point\":[700,0,0],\"within\":50}", NULL);

  publisher = published(client, "c_pilot");
  add_ball(publisher, "c_near_post", 0.5, 705);
  drone = add_ball(publisher, "c_near_drone", 0.5, 720);
  watch = watched(client, "{\"form\":\"nearest\"}", 0);
  event = next_event(watch);
  expect(has(event, "\"form\":\"nearest\"") && has(event, "\"standing\":\"c_first\"") && has(event, "\"object\":\"c_near_post\""),
         "what is nearest at first");
  move_to(publisher, drone, 702);
  do event = next_event(watch);
  while (has(event, "\"object\":\"c_near_post\""));
  expect(has(event, "\"kind\":\"changed\"") && has(event, "\"other\":\"c_near_post\"") && has(event, "\"object\":\"c_near_drone\""),
         "which one is nearest now, and which one was");
  expect(fabs(number_in(event, "distance") - 4.5) <= number_in(event, "distance_error") + 1e-3, "how near");
  expect(lost_of(watch) == 0, "nothing is lost");
  collided_watch_close(watch);
  collided_publisher_close(publisher);
  expect(has(command(client, "fence", "{\"name\":\"c_first\",\"form\":\"nearest\",\"remove\":true}", NULL), "\"c_first\""),
         "one question removed");
}

static int count_of(const char* text, const char* piece) {
  int count = 0;
  for (text = strstr(text, piece); text != NULL; text = strstr(text + 1, piece)) ++count;
  return count;
}

/* What the three questions above reported, read from the server's memory of it. */
static void recordings(collided_client* client) {
  collided_error error;
  char* events = NULL;
  char path[1024];
  char arguments[1200];
  const char* found = strstr(command(client, "recording", "{\"last_s\":60}", NULL), "\"path\":\"");
  const char* first;
  error.size = sizeof error;
  expect(found != NULL, "where the recording is");
  if (found == NULL) return;
  sscanf(found + strlen("\"path\":\""), "%1023[^\"]", path);
  sprintf(arguments, "{\"path\":\"%.1000s\",\"only\":\"c_*\"}", path);
  must(collided_library("recorded_standing", arguments, &events, &error), &error, "read it");
  expect(has(events, "\"lost\":0") && has(events, "\"warnings\":[]") && number_in(events, "begin_ns") < number_in(events, "end_ns"),
         "nothing is missing");
  expect(count_of(events, "\"standing\":\"c_dock\"") >= 3 && count_of(events, "\"standing\":\"c_close\"") >= 2 &&
             count_of(events, "\"standing\":\"c_first\"") >= 2, "events of each form");
  first = strstr(events, "\"form\":\"region\"");
  expect(first != NULL && has(first, "\"kind\":\"enter\"") && strstr(first, "\"kind\":") == strstr(first, "\"kind\":\"enter\"") &&
             strstr(first, "\"object\":") == strstr(first, "\"object\":\"c_cart\""), "the cart enters first");
  collided_free_text(events);
  sprintf(arguments, "{\"path\":\"%.1000s\",\"from\":{\"since\":\"end\",\"offset_ns\":1}}", path);
  must(collided_library("recorded_standing", arguments, &events, &error), &error, "read what holds at its end");
  expect(has(events, "\"events\":[]"), "nothing is left");
  collided_free_text(events);
  sprintf(arguments, "{\"path\":\"%.1000s\",\"only\":\"c_*\"}", path);
  must(collided_library("recorded_events", arguments, &events, &error), &error, "read its contacts");
  expect(has(events, "\"lost\":0") && has(events, "\"scenes\":["), "contacts of a recording");
  collided_free_text(events);
  sprintf(arguments, "{\"path\":\"%.1000s\",\"to\":{\"since\":\"noon\"}}", path);
  expect(collided_library("recorded_standing", arguments, &events, &error) == COLLIDED_BAD_INPUT && events == NULL, "since when");
  expect(collided_library("recorded_standing", "{\"path\":\"/nowhere.mcap\"}", &events, &error) == COLLIDED_BAD_INPUT, "no file");
  expect(collided_library("recorded", "{}", &events, &error) == COLLIDED_BAD_INPUT && has(error.message, "known are diagnose, fleet"),
         "no such function");
}

/* Why a ray meets the floor and neither the glass nor the mast, and what is behind a region and an event of it. */
static void explanations(collided_client* client) {
  const collided_part cube = box(0.5, 0);
  collided_part yard = box(0.5, 900);
  char question[64];
  const char* answer;
  command(client, "add", "{\"name\":\"c_glass\",\"pose\":[900,0,2,1,0,0,0],\"layers\":2}", &cube);
  command(client, "add", "{\"name\":\"c_floor\",\"pose\":[900,0,-0.5,1,0,0,0]}", &cube);
  command(client, "add", "{\"name\":\"c_mast\",\"pose\":[901,0,2,1,0,0,0]}", &cube);
  answer = command(client, "explain", "{\"ray\":[900,0,5,0,0,-1],\"mask\":1,\"why_not\":\"c_mast\",\"most\":1}", NULL);
  expect(has(answer, "\"answer\":\"hit\"") && has(answer, "are not in the mask 0x1") && has(answer, "\"box_met\":false") &&
             has(answer, "\"object\":\"c_floor\""), "the ray");
  answer = command(client, "explain", "{\"a\":\"c_mast\",\"b\":\"c_floor\"}", NULL);
  expect(has(answer, "\"answer\":\"miss\"") && has(answer, "\"end\":\"found\""), "the pair");

  yard.numbers[4] = 20;
  command(client, "fence", "{\"name\":\"c_yard\",\"only\":\"c_m*\"}", &yard);
  command(client, "move", "{\"name\":\"c_mast\",\"pose\":[900,20,0,1,0,0,0]}", NULL);
  answer = command(client, "explain", "{\"standing\":\"c_yard\"}", NULL);
  expect(has(answer, "\"looked_at\":1") && has(answer, "\"reported\":true"), "the region");
  sprintf(question, "{\"event\":%.0f,\"of\":\"standing\"}", number_in(answer, "sequence"));
  answer = command(client, "explain", question, NULL);
  expect(has(answer, "\"what\":\"enter\"") && has(answer, "\"a\":\"c_mast\""), "the event");
  expect(refused(client, "explain", "{\"standing\":\"c_none\"}", NULL) == COLLIDED_REFUSED, "no such question");
  command(client, "fence", "{\"name\":\"c_yard\",\"remove\":true}", NULL);
  command(client, "remove", "{\"name\":\"c_[gfm]*\"}", NULL);
}

/* A probe under a ball reports how high the ball is. */
static void probes(collided_client* client) {
  const collided_part part = ball(0.5);
  collided_error error;
  collided_watch* watch = NULL;
  const char* reading;
  int i;
  error.size = sizeof error;
  must(collided_watch_start(client, COLLIDED_WATCH_PROBES, "{\"only\":\"c_height\"}", &watch, &error), &error, "watch probes");
  command(client, "add", "{\"name\":\"c_ground\",\"pose\":[950,0,0,1,0,0,0]}", &part);
  command(client, "add", "{\"name\":\"c_flyer\",\"pose\":[950,0,8,1,0,0,0]}", &part);
  command(client, "probe", "{\"name\":\"c_height\",\"object\":\"c_flyer\",\"reach_m\":10}", NULL);
  command(client, "move", "{\"name\":\"c_flyer\",\"pose\":[950,0,5,1,0,0,0]}", NULL);
  for (i = 0; i < 100; ++i) {
    reading = next_event(watch);
    if (fabs(number_in(reading, "clearance") - 4.5) < 1e-9) break;
  }
  expect(i < 100 && has(reading, "\"probe\":\"c_height\"") && has(reading, "\"met\":\"c_ground\""), "its height, above what");
  collided_watch_close(watch);
  command(client, "probe", "{\"name\":\"c_height\",\"remove\":true}", NULL);
  command(client, "remove", "{\"name\":\"c_[gf]*\"}", NULL);
}

/* Where an object is along an axis: 0, 1 or 2. */
static double place_of(collided_client* client, const char* name, int axis) {
  char arguments[64];
  const char* found;
  double numbers[3] = {0, 0, 0};
  sprintf(arguments, "{\"name\":\"%s\"}", name);
  found = strstr(command(client, "get", arguments, NULL), "\"position\":[");
  expect(found != NULL && sscanf(found, "\"position\":[%lf,%lf,%lf]", numbers, numbers + 1, numbers + 2) == 3, "where it is");
  return numbers[axis];
}

/* The arm of the guide to robots, 0.9 m from its shoulder to its hand, is bent and moved as a whole. */
static void robots(collided_client* client, const char* urdf) {
  collided_error error;
  collided_publisher* publisher = published(client, "c_joints");
  collided_robot* arm = NULL;
  char options[2048];
  char* warnings = NULL;
  error.size = sizeof error;
  sprintf(options, "{\"path\":\"%.1000s\",\"name\":\"c_arm\",\"moving\":true}", urdf);
  command(client, "load", options, NULL);
  sprintf(options, "{\"urdf\":\"%.1000s\",\"scene\":\"c_arm\",\"base\":[1000,0,0,1,0,0,0],\"joints\":[[\"shoulder\",0.5]]}", urdf);
  must(collided_robot_claim(client, publisher, options, &arm, &error), &error, "claim the arm");
  must(collided_publisher_flush(publisher, 0, NULL, &error), &error, "flush");
  must(collided_publisher_wait_applied(publisher, 5000000000L, &error), &error, "wait");
  expect(fabs(place_of(client, "c_arm/hand", 0) - 1000 - 0.9 * sin(0.5)) < 1e-9, "where the shoulder puts the hand");
  expect(collided_robot_set(arm, "{\"joints\":[[\"knee\",1]]}", &warnings, &error) == COLLIDED_BAD_INPUT, "no such joint");
  expect(collided_robot_set(arm, "{\"joints\":[[\"elbow\",3]]}", &warnings, &error) == COLLIDED_BAD_INPUT, "beyond its limit");
  must(collided_robot_set(arm, "{\"joints\":[[\"shoulder\",0]],\"teleport\":true}", &warnings, &error), &error, "set a joint");
  expect(has(warnings, "["), "a list of warnings");
  collided_free_text(warnings);
  must(collided_robot_set(arm, "{\"base\":[1001,0,0,1,0,0,0]}", NULL, &error), &error, "move the arm");
  must(collided_publisher_flush(publisher, 0, NULL, &error), &error, "flush");
  must(collided_publisher_wait_applied(publisher, 5000000000L, &error), &error, "wait");
  expect(fabs(place_of(client, "c_arm/hand", 0) - 1001) < 1e-9 && fabs(place_of(client, "c_arm/hand", 2) - 1) < 1e-9, "upright");
  collided_robot_close(arm);
  collided_publisher_close(publisher);
  expect(collided_robot_claim(client, NULL, options, &arm, &error) == COLLIDED_BAD_INPUT, "no publisher");
}

/* One ray along x: its verdict, and in *distance where it hits. */
static int ray_along_x(collided_client* client, double x, double y, double z, double* distance) {
  collided_error error;
  collided_answers* answers = NULL;
  collided_columns columns;
  double ray[7] = {0, 0, 0, 1, 0, 0, HUGE_VAL};
  unsigned char verdict = 0;
  error.size = sizeof error;
  ray[0] = x;
  ray[1] = y;
  ray[2] = z;
  must(collided_ask(client, COLLIDED_ASK_RAYS, ray, 1, NULL, &answers, &error), &error, "a ray");
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
  collided_voxels* cells = NULL;
  collided_publisher* publisher = published(client, "c_scanner");
  char* scan = NULL;
  double distance = 0, bad[3];
  error.size = sizeof error;
  expect(collided_voxels_start(publisher, "c_cloud", "{\"unknown\":\"maybe\"}", &cells, &error) == COLLIDED_BAD_INPUT && cells == NULL,
         "unknown as what");
  must(collided_voxels_start(publisher, "c_cloud", "{\"cell\":0.5,\"unknown\":\"free\",\"decay_ns\":1000000000}", &cells, &error),
       &error, "voxels");
  must(collided_voxels_insert(cells, 1, point, NULL, sensor, 0, &scan, &error), &error, "insert");
  expect(number_in(scan, "points") == 1 && number_in(scan, "occupied") == 1 && number_in(scan, "changed") == 1,
         "what became of the scan");
  collided_free_text(scan);
  must(collided_publisher_wait_applied(publisher, 5000000000L, &error), &error, "wait");
  expect(ray_along_x(client, 700.25, 0.25, 0.25, &distance) == COLLIDED_HIT && fabs(distance - 2.75) < 1e-9, "its cell");
  must(collided_voxels_insert(cells, 2, NULL, floats, NULL, 0, &scan, &error), &error, "insert floats");
  expect(number_in(scan, "points") == 2 && number_in(scan, "occupied") == 2 && number_in(scan, "crossed") == 0,
         "without a sensor no space is free");
  collided_free_text(scan);
  bad[0] = HUGE_VAL;
  bad[1] = bad[2] = 0;
  must(collided_voxels_insert(cells, 1, bad, NULL, NULL, 0, &scan, &error), &error, "insert an endless point");
  expect(number_in(scan, "points") == 0 && number_in(scan, "refused") == 1, "what is not finite is counted");
  collided_free_text(scan);
  expect(collided_voxels_insert(cells, 1, NULL, NULL, NULL, 0, &scan, &error) == COLLIDED_BAD_INPUT, "no array");
  must(collided_voxels_insert(cells, 0, NULL, NULL, NULL, 0, &scan, &error), &error, "a scan without points");
  expect(number_in(scan, "changed") == 0, "nothing is old yet");
  collided_free_text(scan);
  must(collided_voxels_clear(cells, &error), &error, "clear");
  must(collided_publisher_wait_applied(publisher, 5000000000L, &error), &error, "wait");
  expect(ray_along_x(client, 700.25, 0.25, 0.25, &distance) == COLLIDED_MISS, "nothing is left");
  collided_voxels_close(cells);
  collided_publisher_close(publisher);
}

int main(int count, char** words) {
  collided_error error;
  collided_client* client = NULL;
  const char* status;
  char options[32];
  if (count != 3) return 2;
  srand(1);
  error.size = sizeof error;
  sprintf(options, "{\"domain\":%d}", atoi(words[1]));
  must(collided_connect(options, &client, &error), &error, "connect");
  status = command(client, "status", "{}", NULL);
  expect(has(status, "\"state\":\"ready\"") && has(status, collided_version()) && number_in(status, "pid") > 0, "the status");
  expect(number_in(status, "age_ns") > 0, "and how old it is");
  rays(client);
  sweeps(client);
  moves_and_events(client);
  refusals(client);
  groups(client);
  regions(client);
  bands(client);
  nearest(client);
  recordings(client);
  explanations(client);
  probes(client);
  robots(client, words[2]);
  voxels(client);
  collided_close(client);
  printf("%d faults\n", faults);
  return faults > 0;
}
