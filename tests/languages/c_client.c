/* A C89 program that does what the header offers: asks, adds, publishes, watches by polling and by callback.
 * usage: c_client DOMAIN */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

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
  collided_watch_options options;
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

  must(collided_publish(client, "c_mover", &publisher, &error), &error, "publish");
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
  must(collided_publisher_wait_applied(publisher, 5000000000L, &error), &error, "wait");
  event.size = sizeof event;
  for (i = 0; i < 100 && ended == 0; ++i) {
    const int code = collided_watch_next(polled, 100000000, &event, &error);
    if (code == COLLIDED_NOTHING) continue;
    must(code, &error, "next");
    began += event.kind == 1;
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
  uint8_t verdicts[3];
  double distances[6];
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
  collided_get_info(answers, &info);
  expect(info.questions == 1 && info.hits == 2, "a pair is two hits");
  collided_read_columns(answers, &columns);
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
  collided_close(client);
  printf("%d faults\n", faults);
  return faults > 0;
}
