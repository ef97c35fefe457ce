/* Built with an older header, whose structs end earlier: what it does not know must be left alone, neither read nor
 * written. Each struct lies before a guard of bytes that must stay as they are.
 * usage: older_header DOMAIN */
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
  int32_t domain;
} old_options;
typedef struct old_status {
  uint32_t size;
  uint32_t pid;
} old_status;
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
  BOTH(old_status) status;
  BOTH(old_columns) columns;
  collided_client* client = NULL;
  collided_answers* answers = NULL;
  const double origin[3] = {0, 0, 5}, direction[3] = {0, 0, -1};
  uint8_t verdict = 99;
  if (count != 2) return 2;
  memset(&error, GUARD, sizeof error);
  memset(&options, GUARD, sizeof options);
  memset(&status, GUARD, sizeof status);
  memset(&columns, GUARD, sizeof columns);
  error.value.size = sizeof error.value;
  options.value.size = sizeof options.value;
  options.value.domain = atoi(words[1]);
  status.value.size = sizeof status.value;
  columns.value.size = sizeof columns.value;
  columns.value.first_hits = 1;
  columns.value.verdict = &verdict;
  /* Read beyond its end, the options would have names and peers at 0x5a5a5a5a5a5a5a5a. */
  if (collided_connect((const collided_connect_options*)(void*)&options, &client, (collided_error*)(void*)&error)) return 1;
  if (collided_get_status(client, (collided_status*)(void*)&status, (collided_error*)(void*)&error)) return 1;
  if (status.value.pid == 0 || status.value.size != sizeof status.value) return 1;
  if (collided_ask_rays(client, 1, origin, direction, NULL, NULL, &answers, (collided_error*)(void*)&error)) return 1;
  collided_read_columns(answers, (const collided_columns*)(void*)&columns);
  if (verdict != COLLIDED_HIT) return 1;
  if (collided_ask_rays(client, 1, origin, origin + 3 - 3, NULL, NULL, &answers, (collided_error*)(void*)&error) != COLLIDED_OK)
    return 1; /* (0, 0, 5) is a direction */
  if (collided_pair(client, "nosuch", "neither", 0, NULL, (collided_error*)(void*)&error) != COLLIDED_REFUSED) return 1;
  if (error.value.code != COLLIDED_REFUSED) return 1;
  collided_free_answers(answers);
  collided_close(client);
  if (!whole(error.guard, sizeof error.guard) || !whole(status.guard, sizeof status.guard)) {
    fprintf(stderr, "written beyond the end of an older struct\n");
    return 1;
  }
  return 0;
}
