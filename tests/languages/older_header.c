/* Built with an older header, whose structs end earlier: what it does not know must be left alone, neither read nor
 * written. Each struct lies before a guard of bytes that must stay as they are.
 * usage: older_header DOMAIN */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#include <collided.h>

#define GUARD 0x5a

typedef struct old_error {
  uint32_t size;
  int32_t code;
} old_error;
typedef struct old_options {
  uint32_t size;
  collided_hit_mode mode;
  uint32_t mask;
} old_options;
typedef struct old_info {
  uint32_t size;
  int32_t has_oldest_pose;
  size_t questions;
} old_info;
typedef struct old_columns {
  uint32_t size;
  int32_t first_hits;
  uint8_t* verdict;
} old_columns;

static int whole(const unsigned char* bytes, size_t count) {
  while (count-- > 0) {
    if (*bytes++ != GUARD) return 0;
  }
  return 1;
}

#define BOTH(type) \
  struct {         \
    type value;    \
    unsigned char guard[2048]; \
  }

int main(int count, char** words) {
  BOTH(old_error) error;
  BOTH(old_options) options;
  BOTH(old_info) info;
  BOTH(old_columns) columns;
  collided_client* client = NULL;
  collided_answers* answers = NULL;
  const double ray[7] = {0, 0, 5, 0, 0, -1, HUGE_VAL};
  char domain[32];
  uint8_t verdict = 99;
  if (count != 2) return 2;
  memset(&error, GUARD, sizeof error);
  memset(&options, GUARD, sizeof options);
  memset(&info, GUARD, sizeof info);
  memset(&columns, GUARD, sizeof columns);
  error.value.size = sizeof error.value;
  options.value.size = sizeof options.value;
  options.value.mode = COLLIDED_CLOSEST;
  options.value.mask = 0xffffffff;
  info.value.size = sizeof info.value;
  columns.value.size = sizeof columns.value;
  columns.value.first_hits = 1;
  columns.value.verdict = &verdict;
  sprintf(domain, "{\"domain\":%d}", atoi(words[1]));
  if (collided_connect(domain, &client, (collided_error*)(void*)&error)) return 1;
  /* Read beyond its end, the options would have names at 0x5a5a5a5a5a5a5a5a. */
  if (collided_ask(client, COLLIDED_ASK_RAYS, ray, 1, (const collided_ask_options*)(void*)&options, &answers,
                   (collided_error*)(void*)&error))
    return 1;
  collided_get_info(answers, (collided_answers_info*)(void*)&info);
  if (info.value.questions != 1 || info.value.size != sizeof info.value) return 1;
  collided_read_columns(answers, (const collided_columns*)(void*)&columns);
  if (verdict != COLLIDED_HIT) return 1;
  if (collided_command(client, "pair", "{\"a\":\"nosuch\",\"b\":\"neither\"}", NULL, 0, 0, NULL,
                       (collided_error*)(void*)&error) != COLLIDED_REFUSED)
    return 1;
  if (error.value.code != COLLIDED_REFUSED) return 1;
  collided_free_answers(answers);
  collided_close(client);
  if (!whole(error.guard, sizeof error.guard) || !whole(info.guard, sizeof info.guard)) {
    fprintf(stderr, "written beyond the end of an older struct\n");
    return 1;
  }
  return 0;
}
