#ifndef COLLIDED_H
#define COLLIDED_H

#include <collided/codes.h>
#include <collided/events.h>
#include <stddef.h>
#include <stdint.h>

/* The C interface of the client of a collision server, for C programs and for other languages' foreign function calls.
 * Bulk data crosses it as arrays and structs: questions, answers, contacts, poses, points. Everything else crosses it
 * as JSON. It wraps collided/client.hpp, which documents each call; this page states how to call it from C.
 *
 * units    metres, seconds only if a name ends in _s, nanoseconds if it ends in _ns; quaternions w first; a pose is
 *          x y z, then w x y z
 * errors   a call that returns int returns COLLIDED_OK (0) or another collided_code, and fills *error unless that is
 *          null. No exception leaves the library. After an error a result is as it was, or null
 * sizes    the first member of each struct, `size`, is sizeof of the struct in the caller's header. The library reads
 *          and writes no more than that, so a program built with an older header keeps working
 * memory   each handle has its own function that frees it. A text that a call returns by char** is freed by
 *          collided_free_text. Null may be freed too
 * threads  one client may be used by several threads at once, any other handle by one call at a time
 * options  a text `options` is a JSON object, {"name":value,...}; null or "" selects the defaults. A missing member has
 *          the default of the C++ struct. An unknown member, or one of the wrong type, is COLLIDED_BAD_INPUT. Names are
 *          those of the C++ members, without _m for a length and with _ns for a time. A code is written as its word, an
 *          infinite number as the text "inf", a pose as a list of seven numbers */

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
typedef struct collided_voxels collided_voxels;
typedef struct collided_robot collided_robot;

/* COLLIDED_NOTHING is not an error: no event came in time. collided/result.hpp explains the other codes. */
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
  int64_t retry_after_ns; /* refused: the server expects to have capacity after this time; 0: a retry does not help */
  char message[1024];     /* zero-terminated: where, what, which value and which limit; cut off if it is longer */
  char hint[512];         /* the next step or the consequence; may be empty */
} collided_error;

/* The version of the library, such as "0.2.0". */
COLLIDED_API const char* collided_version(void);
COLLIDED_API void collided_free_text(char* text);

/* ---- Connecting ---- */

/* Waits until a server answers.
 * options  collided::ConnectOptions: domain, name_space, interface, peers, wait_ns, keys, replicas, wait_is_limit; null
 *          or "": from the environment, as for the command line
 * returns  *client, to be closed with collided_close */
COLLIDED_API int collided_connect(const char* options, collided_client** client, collided_error* error);
/* No other call for this client may be in flight. Its watches and publishers keep the connection open. */
COLLIDED_API void collided_close(collided_client* client);

/* ---- Shapes ---- */

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
  COLLIDED_HEIGHT_FIELD = 9, /* columns, spacing x, spacing y; points: the heights, one number each */
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

/* ---- Questions ---- */

/* Kinds of questions, with the numbers in a row. Each row is one question. */
typedef int32_t collided_question;
enum {
  COLLIDED_ASK_RAYS = 0,    /* 7: origin 3, direction 3 (any length but 0), length_m (INFINITY: no limit) */
  COLLIDED_ASK_SPHERES = 1, /* 4: center 3, radius_m */
  COLLIDED_ASK_BOXES = 2,   /* 10: center 3, half_m 3, orientation 4 */
  COLLIDED_ASK_NEAREST = 3, /* 4: point 3, within_m (INFINITY: no limit) */
  COLLIDED_ASK_INSIDE = 4,  /* 3: point 3. Which solids contain it? */
  COLLIDED_ASK_SWEEPS = 5   /* 14: pose at time 0, pose at time 1. What does the shape of the options meet first? */
};

/* Zero selects the default of collided::AskOptions, except for `mask`, where 0 excludes every object. Therefore begin
 * with collided_ask_defaults. */
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
  /* The shape that COLLIDED_ASK_SWEEPS moves; null for other kinds. The parts are laid out as those of collided_command. */
  const collided_part* shape;
  size_t shape_parts;
} collided_ask_options;
COLLIDED_API void collided_ask_defaults(collided_ask_options* options, uint32_t size);

/* Asks 1 to 100,000 questions of one kind about one state of the world.
 * rows     count rows, one after the other. A number that is not finite is COLLIDED_BAD_INPUT unless the row allows it
 * options  may be null
 * answers  on entry null, or the answers of an earlier call, whose memory is reused; to be freed with
 *          collided_free_answers */
COLLIDED_API int collided_ask(collided_client* client, collided_question kind, const double* rows, size_t count,
                              const collided_ask_options* options, collided_answers** answers, collided_error* error);

/* Asks whether configurations of objects would be free of contact, without moving anything; see
 * collided::Client::what_if. Each configuration has one answer; a miss means free. Its pair is returned as two
 * successive hits, the moved object's first. Both have the clearance as distance_m (negative if the two touch) and the
 * normal from the first to the second; each has its own nearest point. `inside` is set for an object that lies within
 * the other one, a solid.
 * objects  JSON: {"objects":["a","b"],"attached":[["child","parent"]],"nearer":2.5,"with_filtered":true}. Only
 *          `objects`, the names of the moved objects, is required; see collided::WhatIfOptions
 * poses    count configurations, each with a pose for each object in order
 * options  mode COLLIDED_ANY: the first contact found, without numbers; else the least clearance. `only` names what the
 *          configurations are tested against: an object, a scene or a glob. max_hits and error_m are ignored. May be
 *          null
 * answers  as for collided_ask */
COLLIDED_API int collided_what_if(collided_client* client, const char* objects, const double* poses, size_t count,
                                  const collided_ask_options* options, collided_answers** answers,
                                  collided_error* error);

/* Properties that all answers of a call share. */
typedef struct collided_answers_info {
  uint32_t size;
  int32_t has_oldest_pose; /* 0: the answers depend on static geometry only */
  size_t questions;
  size_t hits; /* of all questions together */
  uint64_t epoch;
  uint64_t version;
  int64_t world_time_ns;
  int64_t oldest_pose_age_ns;
  int64_t compute_ns;
} collided_answers_info;
COLLIDED_API void collided_get_info(const collided_answers* answers, collided_answers_info* info);

/* The caller's arrays; null arrays are not filled. The first group has an entry for each question, the second one for
 * each hit. The hits of a question are adjacent, nearest first (for spheres and boxes: deepest first). With first_hits
 * set, the second group has one entry for each question: its first hit, or NaN, 0 and 0xffffffff. */
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
  double* point; /* three numbers per entry, as for normal and weights */
  double* point_error_m;
  double* normal;
  double* weights;
  double* time_low;
  double* time_high;
  uint8_t* inside; /* 1: inside; 2: inside by winding number */
  uint8_t* stale;
  /* 1: the mesh does not close, and its winding number places the point inside. distance_m is then the distance to its
   * surface (negative for COLLIDED_ASK_NEAREST). It is not a depth, since a way out may lead through a hole. 0:
   * distance_m is a depth */
  uint8_t* by_winding;
  /* One entry for each question. If its reason is COLLIDED_UNDECIDED_NOT_COVERED: the point (three numbers) where it
   * leaves the space in which the geometry is complete, and the distance that is covered. Otherwise NaN. */
  double* uncovered;
  double* covered_m;
} collided_columns;
COLLIDED_API void collided_read_columns(const collided_answers* answers, const collided_columns* columns);
/* The name of the object of hit number `hit`, counted through all questions; valid until the answers are used again or
 * freed. Null if `hit` is out of range. */
COLLIDED_API const char* collided_hit_object(const collided_answers* answers, size_t hit);
COLLIDED_API void collided_free_answers(collided_answers* answers);

/* ---- Commands ---- */

/* Sends any command. Arguments and answer are JSON objects; idl/commands.hpp and idl/command_table.hpp of the sources
 * describe them. Among the commands are "pair" and "clearance" (contact, depth and distance of objects), "add", "move"
 * and "remove" (objects that outlive this client), "allow", "deny", "attach", "detach", "fence" and "fences" (standing
 * questions), "probe", "explain". The library itself answers "status" with the server's last published status.
 * parts       the shape for "add", in the object's frame, or of a region for "fence"; part_count parts, spaced by the
 *             `size` of the first. Null for other commands
 * timeout_ns  0: 10 s. Each progress message restarts it
 * answer      may be null */
COLLIDED_API int collided_command(collided_client* client, const char* name, const char* arguments,
                                  const collided_part* parts, size_t part_count, int64_t timeout_ns, char** answer,
                                  collided_error* error);

/* Calls a function of the library that needs no collided_client, and returns when it is done. Names of arguments are those of
 * the C++ members; all but the
 * last two also take the options of collided_connect.
 * name       "diagnose": collided::diagnose, {"findings":[...]}
 *            "fleet": collided::fleet
 *            "replay": path, rate, ask, from, to; collided::replay
 *            "fetch_recording": path, last_ns; {"bytes":1000}
 *            "recorded_events", "recorded_standing": path, only, skip, from, to; the events of a recording (collide record)
 * arguments  from and to are {"since":"1970","offset_ns":0}, where since is 1970, begin or end
 * answer     JSON; may be null */
COLLIDED_API int collided_library(const char* name, const char* arguments, char** answer, collided_error* error);

/* ---- Watches ---- */

/* Kinds of watches, and their options. All have only and skip (globs) and capacity (most events that may wait). */
typedef int32_t collided_followed;
enum {
  COLLIDED_WATCH_CONTACTS = 0, /* collided::Event; persisted, since_ns */
  COLLIDED_WATCH_STANDING = 1, /* collided::StandingEvent; form: region, bands or nearest */
  COLLIDED_WATCH_PROBES = 2    /* collided::ProbeReading */
};

/* Subscribes. A watch of contacts or standing questions begins with the current state.
 * returns  *watch, to be closed with collided_watch_close */
COLLIDED_API int collided_watch_start(collided_client* client, collided_followed followed, const char* options,
                                      collided_watch** watch, collided_error* error);
/* Returns the next event as a JSON object with the members of its C++ struct. COLLIDED_NOTHING if none comes within
 * wait_ns. */
COLLIDED_API int collided_watch_next(collided_watch* watch, int64_t wait_ns, char** event, collided_error* error);
/* Reads contact events in bulk: waits up to wait_ns for the first, then takes all that are queued, up to capacity.
 * COLLIDED_NOTHING if none comes. Texts are valid until the next call for the watch.
 * events  an array spaced by the `size` of the first one, which must be set
 * count   number of events read */
COLLIDED_API int collided_watch_read(collided_watch* watch, int64_t wait_ns, collided_event* events, size_t capacity,
                                     size_t* count, collided_error* error);
/* Any pointer may be null.
 * lost     events dropped because they were not read in time
 * in_step  1: the watch has reported the complete current state. 0: not yet, or it is resynchronizing after a loss */
COLLIDED_API void collided_watch_health(const collided_watch* watch, uint64_t* lost, int32_t* in_step);
COLLIDED_API void collided_watch_close(collided_watch* watch);

/* ---- Publishing ---- */

/* options  collided::PublishOptions: lease_ns (100 ms to a day), gap_ns (1 ms to 8 s)
 * returns  *publisher, to be closed with collided_publisher_close, which removes its objects */
COLLIDED_API int collided_publish(collided_client* client, const char* name, const char* options,
                                  collided_publisher** publisher, collided_error* error);
COLLIDED_API void collided_publisher_close(collided_publisher* publisher);
/* Defines an object, or claims an existing one that has no living publisher. A claimed object keeps its shape, and is
 * released where it stands instead of being removed.
 * object  name; pose, layers, mask, group, moving, scale, solid, solid_by, as for the command "add"; lost: what happens
 *         to the object when this publisher is lost (remove, freeze or hold); unknown. With "claim":true only name,
 *         pose and lost are used
 * parts   as for collided_command; null to claim
 * handle  may be null */
COLLIDED_API int collided_publisher_add(collided_publisher* publisher, const char* object, const collided_part* parts,
                                        size_t part_count, uint32_t* handle, collided_error* error);
/* Removes an object from the world; a claimed one is released where it stands. */
COLLIDED_API int collided_publisher_remove(collided_publisher* publisher, uint32_t handle, collided_error* error);
/* Collects the newest poses of `count` objects; the next flush sends them. The call stops at the first pose that is
 * refused; those before it are kept.
 * positions     three numbers each
 * orientations  four numbers each; null: aligned with the world's axes
 * teleport      1: the objects jump there; the path in between is not tested */
COLLIDED_API int collided_publisher_move(collided_publisher* publisher, size_t count, const uint32_t* handles,
                                         const double* positions, const double* orientations, int32_t teleport,
                                         collided_error* error);
/* Sends the collected poses, and states that all other objects have been at rest until source_time_ns.
 * source_time_ns  since 1970; 0: now
 * sequence        number of the last message; may be null
 * error           after success: code COLLIDED_OK and an empty message. If the server had counted this publisher as
 *                 lost since the last flush, the message states the cause and a remedy */
COLLIDED_API int collided_publisher_flush(collided_publisher* publisher, int64_t source_time_ns, uint64_t* sequence,
                                          collided_error* error);
/* Waits until the server has applied every object and pose sent so far; see collided::Publisher::wait_applied. */
COLLIDED_API int collided_publisher_wait_applied(collided_publisher* publisher, int64_t timeout_ns,
                                                 collided_error* error);
/* Returns the objects and poses that the server did not apply as published; see collided::PublisherReport.
 * report  {"refused":"","left_out":[["name","why"]],"left_out_count":1,"merged_poses":0} */
COLLIDED_API int collided_publisher_report(collided_publisher* publisher, int64_t timeout_ns, char** report,
                                           collided_error* error);
/* Renews the publisher's lease without stating anything about its objects.
 * source_time_ns  the publisher's current time, if it passes its own times to collided_publisher_flush; 0: now */
COLLIDED_API int collided_publisher_keep_alive(collided_publisher* publisher, int64_t source_time_ns,
                                               collided_error* error);
/* From now on each object moves between its own poses; see collided::Publisher::stream. */
COLLIDED_API void collided_publisher_stream(collided_publisher* publisher);

/* Claims the links of a robot for the publisher, which then moves them by joint positions; see
 * collided::PublishedRobot. The publisher must outlive the robot.
 * options  urdf: path of the file; scene, base (a pose), joints ([["elbow",0.5]], radians or metres), beyond_limits,
 *          lost
 * returns  *robot, to be closed with collided_robot_close; the links stay claimed until the publisher is closed */
COLLIDED_API int collided_robot_claim(collided_client* client, collided_publisher* publisher, const char* options,
                                      collided_robot** robot, collided_error* error);
/* Moves the links; the next flush sends their poses. After an error in the joints nothing has moved.
 * motion    joints and base as above; missing ones keep their values. Also teleport
 * warnings  a JSON list of sentences; may be null */
COLLIDED_API int collided_robot_set(collided_robot* robot, const char* motion, char** warnings, collided_error* error);
COLLIDED_API void collided_robot_close(collided_robot* robot);

/* ---- Live clouds ---- */

/* Starts a grid of cells that scans mark as occupied, free or unknown; see collided::PublishedVoxels. The publisher
 * must outlive it, and needs to be kept alive as for other objects.
 * options  collided::VoxelOptions: cell, unknown, decay_ns, reach, clearing_delay_ns, most_blocks; and layers and lost
 *          for its objects
 * returns  *voxels, to be closed with collided_voxels_close. Its objects stay until the publisher is closed */
COLLIDED_API int collided_voxels_start(collided_publisher* publisher, const char* name, const char* options,
                                       collided_voxels** voxels, collided_error* error);
COLLIDED_API void collided_voxels_close(collided_voxels* voxels);
/* Inserts a scan and sends the blocks it changes. A scan without points only lets old cells decay to unknown.
 * points   doubles or floats (the other pointer is null), three numbers each, in the world
 * origin   of the sensor: the space between it and each point becomes free. May be null
 * time_ns  of the scan, for decay; 0: now
 * scan     collided::VoxelScan, {"points":100,"refused":0,...}; may be null */
COLLIDED_API int collided_voxels_insert(collided_voxels* voxels, size_t count, const double* points,
                                        const float* floats, const double* origin, int64_t time_ns, char** scan,
                                        collided_error* error);
/* Makes all cells unknown. */
COLLIDED_API int collided_voxels_clear(collided_voxels* voxels, collided_error* error);

#ifdef __cplusplus
}
#endif

#endif
