#ifndef COLLIDED_H
#define COLLIDED_H

#include <collided/codes.h>
#include <collided/events.h>
#include <stddef.h>
#include <stdint.h>

/* The C interface of the client of a collision server, for C programs and for other languages' foreign function calls.
 * It lies over collided/client.hpp, whose texts say what each word means; here is how it is called.
 *
 * units    metres, seconds only where a name ends in _s, nanoseconds where it ends in _ns; quaternions w first
 * errors   calls that return int return COLLIDED_OK (0) or another collided_code, and fill *error unless it is null.
 *          No exception leaves the library
 * sizes    the first member of each struct, `size`, is sizeof of the struct as the caller's header has it. The library
 *          reads and writes no further than that, so a program built with an older header goes on working
 * memory   what a function makes is given back by the function named beside it; null may be given back too
 * threads  one client from several threads at once; any other object by one call at a time */

#ifdef __cplusplus
extern "C" {
#endif

#if defined(__GNUC__)
#define COLLIDED_API __attribute__((visibility("default")))
#else
#define COLLIDED_API
#endif

typedef struct collided_client collided_client;
typedef struct collided_answers collided_answers;
typedef struct collided_watch collided_watch;
typedef struct collided_publisher collided_publisher;
typedef struct collided_standing_watch collided_standing_watch;

/* COLLIDED_NOTHING is no error: there was no event in that time. The others are those of collided/result.hpp. */
typedef enum collided_code {
  COLLIDED_OK = 0,
  COLLIDED_NOTHING = 1,
  COLLIDED_BAD_INPUT = 2,
  COLLIDED_NO_SERVER = 3,
  COLLIDED_TIMEOUT = 4,
  COLLIDED_REFUSED = 5,
  COLLIDED_DISCONNECTED = 6,
  COLLIDED_INTERNAL = 7
} collided_code;

typedef struct collided_error {
  uint32_t size;
  int32_t code;
  int64_t retry_after_ns; /* refused: the server expects to have room after so long; 0: asking again does not help */
  char message[1024];     /* zero-terminated; where, what, which value and which limit; cut off where it is longer */
  char hint[512];         /* the next step or the consequence; may be empty */
} collided_error;

/* The version of the library, such as "0.2.0". */
COLLIDED_API const char* collided_version(void);

/* ---- Connecting ---- */

/* Zero, null or an empty text: the default of collided::ConnectOptions. */
typedef struct collided_connect_options {
  uint32_t size;
  int32_t domain;
  const char* name_space;
  const char* interface_name;
  int64_t wait_ns;
  const char* const* peers;
  size_t peer_count;
  const char* keys; /* folder made by collide keys add */
} collided_connect_options;

/* options  null: from the environment, as the command line does
 * returns  in *client, to be given to collided_close */
COLLIDED_API int collided_connect(const collided_connect_options* options, collided_client** client,
                                  collided_error* error);
/* No other call for this client may be under way. Its watches and publishers keep the connection that they need. */
COLLIDED_API void collided_close(collided_client* client);

typedef struct collided_status {
  uint32_t size;
  uint32_t pid;
  char name_space[64];
  char version_text[32];
  char state[16]; /* starting, recovering, ready, stopping */
  uint64_t epoch;
  uint64_t version;
  int64_t world_time_ns;
  uint64_t static_triangles;
  uint64_t poses_applied;
  uint64_t poses_dropped;
  uint64_t questions_answered;
  uint64_t questions_refused;
  uint64_t undecided_answers;
  uint32_t objects;
  uint32_t moving;
  uint32_t contacts;
  int32_t contacts_truncated;
  int64_t step_lasting_ns; /* of the step under way; 0: no step takes longer than statuses are apart */
} collided_status;

/* What the server said of itself last. */
COLLIDED_API int collided_get_status(collided_client* client, collided_status* status, collided_error* error);

/* ---- Questions ---- */

/* Zero: the default of collided::AskOptions, but for `mask`, where 0 lets nothing answer: begin with
 * collided_ask_defaults. */
typedef struct collided_ask_options {
  uint32_t size;
  collided_hit_mode mode;
  uint32_t mask;
  uint32_t max_hits;
  const char* only;
  const char* skip;
  double error_m;
  int64_t deadline_ns;
  int64_t timeout_ns;
  int32_t fresh;
  collided_importance importance;
  collided_instant_kind instant;
  int64_t instant_ns;
} collided_ask_options;
COLLIDED_API void collided_ask_defaults(collided_ask_options* options, uint32_t size);

/* Each asks 1 to 100,000 questions of one kind about one state of the world.
 * arrays   row by row, three numbers a point; lengths_m and within_m may be null: unlimited; orientations (w x y z) may
 *          be null: along the world's axes
 * options  may be null
 * answers  *answers is null, or the answers of an earlier call, whose memory is used again; to be given to
 *          collided_free_answers. After an error it is as it was, or null */
COLLIDED_API int collided_ask_rays(collided_client* client, size_t count, const double* origins,
                                   const double* directions, const double* lengths_m,
                                   const collided_ask_options* options, collided_answers** answers,
                                   collided_error* error);
COLLIDED_API int collided_ask_spheres(collided_client* client, size_t count, const double* centers,
                                      const double* radii_m, const collided_ask_options* options,
                                      collided_answers** answers, collided_error* error);
COLLIDED_API int collided_ask_boxes(collided_client* client, size_t count, const double* centers, const double* half_m,
                                    const double* orientations, const collided_ask_options* options,
                                    collided_answers** answers, collided_error* error);
COLLIDED_API int collided_ask_nearest(collided_client* client, size_t count, const double* points,
                                      const double* within_m, const collided_ask_options* options,
                                      collided_answers** answers, collided_error* error);
/* Which solids hold a point? */
COLLIDED_API int collided_ask_inside(collided_client* client, size_t count, const double* points,
                                     const collided_ask_options* options, collided_answers** answers,
                                     collided_error* error);
COLLIDED_API void collided_free_answers(collided_answers* answers);

/* What holds for all answers of a call. */
typedef struct collided_answers_info {
  uint32_t size;
  int32_t has_oldest_pose; /* 0: only static geometry decided */
  size_t questions;
  size_t hits; /* of all questions together */
  uint64_t epoch;
  uint64_t version;
  int64_t world_time_ns;
  int64_t oldest_pose_age_ns;
  int64_t compute_ns;
} collided_answers_info;
COLLIDED_API void collided_get_info(const collided_answers* answers, collided_answers_info* info);

/* The caller's arrays; those that are null are not wanted. The first group has an entry for each question, the second
 * for each hit, where the hits of a question follow each other, nearest (spheres, boxes: deepest) first. With
 * first_hits set, the second group has an entry for each question too: its first hit, or NaN, 0 and 0xffffffff. */
typedef struct collided_columns {
  uint32_t size;
  int32_t first_hits;
  uint8_t* verdict; /* collided_verdict */
  uint8_t* reason;  /* collided_undecided_reason */
  uint32_t* hit_count;
  uint64_t* object_id;
  uint32_t* triangle; /* or COLLIDED_NO_TRIANGLE */
  double* distance_m;
  double* error_m;
  double* exit_m;
  double* point; /* three numbers an entry, as for normal and weights */
  double* point_error_m;
  double* normal;
  double* weights;
  double* time_low;
  double* time_high;
  uint8_t* inside; /* 1: inside; 2: inside by winding number */
  uint8_t* stale;
  /* 1: the mesh does not close and its winding number says inside: distance_m is how far its surface is (nearest: with a
   * minus), and no depth, since a way out may lead through a hole. 0: distance_m is a depth */
  uint8_t* by_winding;
  /* An entry for each question, with reason COLLIDED_UNDECIDED_NOT_COVERED: the point where it leaves the space in which
   * the geometry is complete, three numbers, and the distance that is covered. Else NaN. Clearances have the point alone. */
  double* uncovered;
  double* covered_m;
} collided_columns;
COLLIDED_API void collided_read_columns(const collided_answers* answers, const collided_columns* columns);
/* The name of the object of hit number `hit`, counted through all questions; valid until the answers are used again or
 * freed. Null for a number that is too large. */
COLLIDED_API const char* collided_hit_object(const collided_answers* answers, size_t hit);

/* How two objects stand to each other; see collided::PairAnswer. */
typedef struct collided_pair_answer {
  uint32_t size;
  collided_verdict verdict;
  collided_undecided_reason reason;
  int32_t stale;
  collided_containment contained;
  uint32_t a_triangle;
  uint32_t b_triangle;
  uint64_t version;
  double distance_m;
  double depth_m;
  double error_m;
  double normal[3];
  double on_a[3];
  double on_b[3];
  double point_error_m;
  double point[3];
} collided_pair_answer;
COLLIDED_API int collided_pair(collided_client* client, const char* a, const char* b, int64_t timeout_ns,
                               collided_pair_answer* answer, collided_error* error);

/* The nearest pairs of two groups of objects; see collided::Client::clearance. A group is an object, a scene or a glob.
 * The answer is one question's; each pair is two hits that follow each other, that of the first group first: both have
 * the clearance as distance_m (negative where the two touch) and the normal from the first to the second, and each its
 * nearest point; `inside` is set of one that lies within the other, a solid. Reason COLLIDED_UNDECIDED_TRUNCATED
 * without being undecided: there are more pairs.
 * to        the other group; null or "": everything that the first has not
 * most      pairs told, 1 to 10,000
 * nearer_m  pairs surely farther apart are not told; HUGE_VAL: all are
 * options   skip, deadline_ns, timeout_ns and the instant; may be null */
COLLIDED_API int collided_clearance(collided_client* client, const char* from, const char* to, uint32_t most,
                                    double nearer_m, const collided_ask_options* options, collided_answers** answers,
                                    collided_error* error);

/* Objects thought elsewhere; see collided::Client::what_if. An answer for each configuration: a miss is free. Its pair is
 * two hits as above, that of a moved object first.
 * objects   names of those that are moved, object_count of them
 * poses     count configurations, each with a pose for each object in order: x y z, then w x y z
 * attached  2 * attached_count names: one that moves along, and with what; may be null
 * nearer_m  with clearances: pairs surely farther apart do not count
 * options   mode COLLIDED_ANY: the first contact found, without numbers; else the least clearance. `only` names what the
 *           configurations are judged against, an object, a scene or a glob. max_hits and error_m mean nothing */
COLLIDED_API int collided_what_if(collided_client* client, const char* const* objects, size_t object_count,
                                  size_t count, const double* poses, const char* const* attached, size_t attached_count,
                                  double nearer_m, const collided_ask_options* options, collided_answers** answers,
                                  collided_error* error);

/* ---- Objects ---- */

typedef enum collided_kind {
  COLLIDED_SPHERE = 0,       /* numbers: center 3, radius */
  COLLIDED_BOX = 1,          /* half 3, center 3, orientation 4 */
  COLLIDED_CAPSULE = 2,      /* a 3, b 3, radius */
  COLLIDED_CYLINDER = 3,     /* a 3, b 3, radius */
  COLLIDED_CONE = 4,         /* apex 3, base 3, radius */
  COLLIDED_ELLIPSOID = 5,    /* half 3, center 3, orientation 4 */
  COLLIDED_HALF_SPACE = 6,   /* normal 3, point 3 */
  COLLIDED_HULL = 7,         /* points */
  COLLIDED_MESH = 8,         /* points, triangles */
  COLLIDED_HEIGHT_FIELD = 9, /* columns, spacing x, spacing y; points: one number each, the heights */
  COLLIDED_CLOUD = 10,       /* radius; points */
  COLLIDED_POLYLINE = 11     /* radius; points */
} collided_kind;

typedef struct collided_part {
  uint32_t size;
  int32_t kind;
  double numbers[10];
  const double* points;
  size_t point_count;
  const uint32_t* triangles; /* three point numbers each */
  size_t triangle_count;
} collided_part;

/* An object to add: one or more parts that move as one. Begin with collided_object_defaults. */
typedef struct collided_object {
  uint32_t size;
  uint32_t layers;
  uint32_t mask;
  uint32_t group;
  int32_t moving;
  collided_lost_policy lost_policy;
  const char* name;
  const collided_part* parts;
  size_t part_count;
  double scale[3];
  double position[3];
  double orientation[4];
  int32_t
      solid; /* its closed mesh holds what lies in it; refused where it does not close. 2: then solid by winding number */
} collided_object;
COLLIDED_API void collided_object_defaults(collided_object* object, uint32_t size);

/* Adds an object that stays until it is removed, and outlives the server. *object_id may be null. */
COLLIDED_API int collided_add(collided_client* client, const collided_object* object, uint64_t* object_id,
                              collided_error* error);
/* orientation  null: as the world's axes */
COLLIDED_API int collided_move(collided_client* client, const char* name, const double* position,
                               const double* orientation, int32_t teleport, collided_error* error);
/* Removes by name or glob. *removed may be null. */
COLLIDED_API int collided_remove(collided_client* client, const char* name, uint64_t* removed, collided_error* error);

/* Lets each object of glob a touch each of glob b; because may be null. *ended may be null: contacts that ended with it. */
COLLIDED_API int collided_allow(collided_client* client, const char* a, const char* b, const char* because,
                                uint64_t* ended, collided_error* error);
/* Takes that back. *began may be null: contacts that began with it. */
COLLIDED_API int collided_deny(collided_client* client, const char* a, const char* b, uint64_t* began,
                               collided_error* error);
/* An object that no publisher has moves along with another one until it is detached or one of the two is removed. */
COLLIDED_API int collided_attach(collided_client* client, const char* child, const char* parent, collided_error* error);
COLLIDED_API int collided_detach(collided_client* client, const char* child, collided_error* error);

/* Sends any command; arguments and answer are JSON objects, which idl/commands.hpp of the sources describes. "explain" says why
 * an answer is what it is; the members of its answers are in idl/answers/explanation.hpp.
 * answer  to be given to collided_free_text */
COLLIDED_API int collided_command(collided_client* client, const char* name, const char* json_arguments,
                                  int64_t timeout_ns, char** answer, collided_error* error);
COLLIDED_API void collided_free_text(char* text);

/* ---- Events ---- */

typedef struct collided_watch_options {
  uint32_t size;
  int32_t persisted;
  const char* only;
  const char* skip;
  size_t capacity;  /* 0: the default */
  int64_t since_ns; /* 0: from now on */
} collided_watch_options;

/* user  is what collided_watch_start was given */
typedef void (*collided_event_callback)(const collided_event* event, void* user);

/* options   may be null
 * callback  null: for collided_watch_next. Else it runs on a thread of the library, one event at a time, and must not
 *           close the watch
 * returns   in *watch, to be given to collided_watch_close */
COLLIDED_API int collided_watch_start(collided_client* client, const collided_watch_options* options,
                                      collided_event_callback callback, void* user, collided_watch** watch,
                                      collided_error* error);
/* COLLIDED_NOTHING if no event comes within wait_ns. */
COLLIDED_API int collided_watch_next(collided_watch* watch, int64_t wait_ns, collided_event* event,
                                     collided_error* error);
/* Events dropped because collided_watch_next was not called in time. */
COLLIDED_API uint64_t collided_watch_lost(const collided_watch* watch);
/* 1: the watch knows every contact that holds; 0: not yet, or something missed is being made up for. */
COLLIDED_API int32_t collided_watch_in_step(const collided_watch* watch);
/* Waits for a callback under way. */
COLLIDED_API void collided_watch_close(collided_watch* watch);

/* ---- Standing questions ---- */

/* A standing question; see collided::Standing. Zero, null or an empty text is the default there. Members that belong to
 * other forms are not read. */
typedef struct collided_standing {
  uint32_t size;
  collided_standing_form form; /* COLLIDED_FORM_... */
  const char* name;
  const char* only; /* a region: null or empty for all objects that move */
  const char* skip;
  uint32_t left_out_layers; /* bits: objects with no other layers are not looked at */
  int32_t keep;
  /* COLLIDED_FORM_REGION: see collided::Region. */
  const collided_part* parts;
  size_t part_count;
  int32_t detect; /* COLLIDED_DETECT_... bits; 0: all */
  int32_t reserved;
  /* COLLIDED_FORM_BANDS: see collided::Bands. */
  const char* around;
  const double* bands_m; /* band_count numbers, the widest first */
  size_t band_count;
  int64_t dwell_ns;
  /* COLLIDED_FORM_NEAREST: see collided::Nearest. */
  double point[3]; /* if `to` is null or empty */
  double within_m;
  /* COLLIDED_FORM_REGION: the object that it moves along with. COLLIDED_FORM_NEAREST: the object that the distances are
   * to. */
  const char* to;
  double hysteresis_m; /* COLLIDED_FORM_BANDS and COLLIDED_FORM_NEAREST */
} collided_standing;
/* parts  of loaded scenes that a glob of COLLIDED_FORM_BANDS matches, which have no bands; may be null */
COLLIDED_API int collided_standing_add(collided_client* client, const collided_standing* standing, uint64_t* parts,
                                       collided_error* error);

/* In place of a form below: of any form. */
enum { COLLIDED_FORM_ANY = -1 };
/* Removes by name or glob, of one form or of any. *removed may be null. */
COLLIDED_API int collided_standing_remove(collided_client* client, const char* name, collided_standing_form form,
                                          uint64_t* removed, collided_error* error);

/* only, skip  globs, may be null
 * form        one form, or COLLIDED_FORM_ANY
 * returns     in *watch, to be given to collided_standing_watch_close */
COLLIDED_API int collided_standing_watch_start(collided_client* client, const char* only, const char* skip,
                                               collided_standing_form form, collided_standing_watch** watch,
                                               collided_error* error);
/* COLLIDED_NOTHING if no event comes within wait_ns. */
COLLIDED_API int collided_standing_watch_next(collided_standing_watch* watch, int64_t wait_ns,
                                              collided_standing_event* event, collided_error* error);
/* Events dropped because collided_standing_watch_next was not called in time. */
COLLIDED_API uint64_t collided_standing_watch_lost(const collided_standing_watch* watch);
/* 1: the watch has reported all that holds; 0: not yet, or something missed is being made up for. */
COLLIDED_API int32_t collided_standing_watch_in_step(const collided_standing_watch* watch);
COLLIDED_API void collided_standing_watch_close(collided_standing_watch* watch);

/* ---- Recordings ---- */

/* What standing questions reported in a recording (collide record); no server is needed. See
 * collided::recorded_standing_events. */
typedef struct collided_recorded_standing collided_recorded_standing;

/* What a time in a recording counts from; NONE: there is no such limit. */
enum { COLLIDED_SINCE_NONE = 0, COLLIDED_SINCE_1970 = 1, COLLIDED_SINCE_BEGIN = 2, COLLIDED_SINCE_END = 3 };

typedef struct collided_recorded_options {
  uint32_t size;
  int32_t from_since; /* what held then comes first, then what happened from then on */
  int32_t to_since;
  int32_t reserved;
  int64_t from_ns;
  int64_t to_ns;    /* included */
  const char* only; /* globs, may be null */
  const char* skip;
} collided_recorded_options;

typedef struct collided_recorded_about {
  uint32_t size;
  uint32_t reserved;
  size_t events;
  size_t warnings;
  uint64_t lost;    /* events that are known to be missing */
  int64_t begin_ns; /* of the recording, since 1970 */
  int64_t end_ns;
} collided_recorded_about;

/* options  may be null
 * returns  in *recorded, to be given to collided_free_recorded_standing; null after an error */
COLLIDED_API int collided_read_recorded_standing(const char* path, const collided_recorded_options* options,
                                                 collided_recorded_standing** recorded, collided_error* error);
COLLIDED_API void collided_free_recorded_standing(collided_recorded_standing* recorded);
COLLIDED_API void collided_about_recorded_standing(const collided_recorded_standing* recorded,
                                                   collided_recorded_about* about);
/* An event by its place, from 0; its texts are valid until `recorded` is freed. COLLIDED_NOTHING for a number that is too
 * large. */
COLLIDED_API int collided_recorded_standing_event(const collided_recorded_standing* recorded, size_t number,
                                                  collided_standing_event* event);
/* A sentence about damage of the file, or what is missing; null for a number that is too large. */
COLLIDED_API const char* collided_recorded_warning(const collided_recorded_standing* recorded, size_t number);

/* ---- Publishing ---- */

/* returns  in *publisher, to be given to collided_publisher_close, which removes its objects */
COLLIDED_API int collided_publish(collided_client* client, const char* name, collided_publisher** publisher,
                                  collided_error* error);
/* lease_ns  without a call for this long the server counts it as lost: 100 ms to a day, 0: 500 ms */
COLLIDED_API int collided_publish_leased(collided_client* client, const char* name, int64_t lease_ns,
                                         collided_publisher** publisher, collided_error* error);
/* How a publisher is kept; see collided::PublishOptions. Begin with collided_publish_defaults. */
typedef struct collided_publish_options {
  uint32_t size;
  uint32_t reserved;
  int64_t lease_ns; /* without a call for this long the server counts it as lost: 100 ms to a day */
  int64_t gap_ns;   /* two poses of an object that are farther apart do not connect: 1 ms to 8 s */
} collided_publish_options;
COLLIDED_API void collided_publish_defaults(collided_publish_options* options, uint32_t size);
/* options  null: the defaults */
COLLIDED_API int collided_publish_with(collided_client* client, const char* name,
                                       const collided_publish_options* options, collided_publisher** publisher,
                                       collided_error* error);
COLLIDED_API void collided_publisher_close(collided_publisher* publisher);
COLLIDED_API int collided_publisher_add(collided_publisher* publisher, const collided_object* object, uint32_t* handle,
                                        collided_error* error);
/* Takes over an object that is in the world and has no living publisher; its shape stays. It goes back there instead of
 * being removed.
 * orientation  null: as the world's axes
 * lost         what becomes of it when this publisher is lost; COLLIDED_LOST_REMOVE: it is given back */
COLLIDED_API int collided_publisher_claim(collided_publisher* publisher, const char* name, const double* position,
                                          const double* orientation, collided_lost_policy lost, uint32_t* handle,
                                          collided_error* error);
COLLIDED_API int collided_publisher_remove(collided_publisher* publisher, uint32_t handle, collided_error* error);
/* The newest poses of `count` objects, sent by the next flush: positions three numbers each, orientations (w x y z) four,
 * null: as the world's axes. The first that is refused ends the call; those before it are taken. */
COLLIDED_API int collided_publisher_move(collided_publisher* publisher, size_t count, const uint32_t* handles,
                                         const double* positions, const double* orientations, int32_t teleport,
                                         collided_error* error);
/* source_time_ns  0: now. *sequence may be null.
 * error           of a call that went well: code COLLIDED_OK and an empty message, unless the server had counted this
 *                 publisher as lost since the last flush; then the message says how that came and what helps */
COLLIDED_API int collided_publisher_flush(collided_publisher* publisher, int64_t source_time_ns, uint64_t* sequence,
                                          collided_error* error);
COLLIDED_API int collided_publisher_wait_applied(collided_publisher* publisher, int64_t timeout_ns,
                                                 collided_error* error);
/* What the server has not taken as it was published; see collided::PublisherReport. Texts and arrays are valid until the
 * next report of this publisher. */
typedef struct collided_report {
  uint32_t size;
  uint32_t reserved;
  const char* refused; /* why the server takes nothing of this publisher; empty: it does */
  /* Names of objects that are not in the world as they were defined, and why: at most 20 of left_out_count. */
  const char* const* names;
  const char* const* reasons;
  size_t name_count;
  uint64_t left_out_count;
  uint64_t merged_poses; /* that newer ones replaced, since the server had more than it could apply */
} collided_report;
COLLIDED_API int collided_publisher_report(collided_publisher* publisher, int64_t timeout_ns, collided_report* report,
                                           collided_error* error);
/* Shows that the publisher is alive, and says nothing about its objects. */
COLLIDED_API int collided_publisher_keep_alive(collided_publisher* publisher, collided_error* error);
/* source_time_ns  the publisher's time now, for one that gives its own times to collided_publisher_flush; 0: as above */
COLLIDED_API int collided_publisher_keep_alive_at(collided_publisher* publisher, int64_t source_time_ns,
                                                  collided_error* error);
/* From now on each object moves between its own poses; see collided::Publisher::stream. */
COLLIDED_API void collided_publisher_stream(collided_publisher* publisher);

/* ---- Live clouds ---- */

/* A grid of cells in the world that scans make occupied, free or unknown; see collided::PublishedVoxels. */
typedef struct collided_voxels collided_voxels;

typedef struct collided_voxel_options {
  uint32_t size;
  collided_unknown_cells unknown;
  double cell_m;                    /* side of a cell, rounded to 24 significant bits */
  double reach_m;                   /* points farther from their scan's origin do not count; HUGE_VAL: all do */
  int64_t decay_ns;                 /* a cell that no scan has met for so long is unknown again; 0: never */
  uint32_t layers;                  /* of its objects */
  collided_lost_policy lost_policy; /* of its objects */
  size_t most_blocks;               /* of 16 x 16 x 16 cells that may be in use */
} collided_voxel_options;
COLLIDED_API void collided_voxel_defaults(collided_voxel_options* options, uint32_t size);

/* What became of a scan. */
typedef struct collided_voxel_scan {
  uint32_t size;
  int32_t reserved;
  size_t points;   /* taken */
  size_t refused;  /* not finite, or too far from the grid's origin */
  size_t far_off;  /* beyond reach_m */
  size_t dropped;  /* in a block beyond most_blocks */
  size_t occupied; /* cells that have points */
  size_t crossed;  /* that rays crossed to an effect; see VoxelScan in voxels.hpp */
  size_t changed;  /* blocks whose cells are other than before */
} collided_voxel_scan;

/* The publisher must outlive it, and is to be kept alive as for other objects.
 * options  may be null
 * returns  in *voxels, to be given to collided_voxels_close */
COLLIDED_API int collided_voxels_start(collided_publisher* publisher, const char* name,
                                       const collided_voxel_options* options, collided_voxels** voxels,
                                       collided_error* error);
/* Its objects stay until the publisher is closed; collided_voxels_clear makes all cells unknown. */
COLLIDED_API void collided_voxels_close(collided_voxels* voxels);
/* Takes a scan and sends what it changes.
 * points   three numbers each, m, in the world
 * origin   of the sensor; with it the space up to each point becomes free. May be null
 * time_ns  of the scan, for decay; 0: now
 * scan     may be null */
COLLIDED_API int collided_voxels_insert(collided_voxels* voxels, size_t count, const double* points,
                                        const double* origin, int64_t time_ns, collided_voxel_scan* scan,
                                        collided_error* error);
COLLIDED_API int collided_voxels_insert_floats(collided_voxels* voxels, size_t count, const float* points,
                                               const double* origin, int64_t time_ns, collided_voxel_scan* scan,
                                               collided_error* error);
/* Lets what was not met for long become unknown; insert does so too. *changed, blocks, may be null. */
COLLIDED_API int collided_voxels_decay(collided_voxels* voxels, int64_t time_ns, size_t* changed,
                                       collided_error* error);
COLLIDED_API int collided_voxels_clear(collided_voxels* voxels, collided_error* error);

#ifdef __cplusplus
}
#endif

#endif
