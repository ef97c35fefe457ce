#ifndef COLLIDED_H
#define COLLIDED_H

#include <collided/codes.h>
#include <collided/events.h>
#include <stddef.h>
#include <stdint.h>

/* The C interface of the client of a collision server, for C programs and for other languages' foreign function calls.
 * What there may be much of crosses it as arrays and structs: questions, answers, contacts, poses, points. All else
 * crosses it as JSON. It lies over collided/client.hpp, whose texts explain each word; this page says how it is called.
 *
 * units    metres, seconds only if a name ends in _s, nanoseconds if it ends in _ns; quaternions w first; a pose is
 *          x y z, then w x y z
 * errors   a call that returns int returns COLLIDED_OK (0) or another collided_code, and fills *error unless it is null.
 *          No exception leaves the library. After an error a result is as it was, or null
 * sizes    the first member of each struct, `size`, is sizeof of the struct in the caller's header. The library reads and
 *          writes no further, so a program that was built with an older header keeps working
 * memory   each handle has its own function that gives it back. A text that a call returns by char** is given back to
 *          collided_free_text. Null may be given back too
 * threads  one client may be used by several threads at once, any other handle by one call at a time
 * options  a text `options` is a JSON object, {"name":value,...}; null or "" stands for the defaults. A member that is
 *          missing has the default of the C++ struct. A member that is unknown or does not fit is COLLIDED_BAD_INPUT.
 *          Names are those of the C++ members: without _m for a length, with _ns for a time. A code is its word, an
 *          infinite number the text "inf", a pose a list of seven numbers */

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

/* COLLIDED_NOTHING is not an error: no event came in that time. The others are those of collided/result.hpp. */
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
  int64_t retry_after_ns; /* refused: the server expects to have room after this time; 0: asking again does not help */
  char message[1024];     /* zero-terminated: where, what, which value and which limit; cut off if it is longer */
  char hint[512];         /* the next step or the consequence; may be empty */
} collided_error;

/* The version of the library, such as "0.2.0". */
COLLIDED_API const char* collided_version(void);
COLLIDED_API void collided_free_text(char* text);

/* ---- Connecting ---- */

/* Waits until a server answers.
 * options  collided::ConnectOptions: domain, name_space, interface, peers, wait_ns, keys, replicas, wait_is_limit; null
 *          or "": from the environment, as the command line does
 * returns  in *client, to be given to collided_close */
COLLIDED_API int collided_connect(const char* options, collided_client** client, collided_error* error);
/* No other call for this client may be in flight. Its watches and publishers keep the connection that they need. */
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

/* ---- Questions ---- */

/* Kinds of questions, and the numbers of a row; each row is one question. */
typedef int32_t collided_question;
enum {
  COLLIDED_ASK_RAYS = 0,    /* 7: origin 3, direction 3 (any length but 0), length_m (INFINITY: no limit) */
  COLLIDED_ASK_SPHERES = 1, /* 4: center 3, radius_m */
  COLLIDED_ASK_BOXES = 2,   /* 10: center 3, half_m 3, orientation 4 */
  COLLIDED_ASK_NEAREST = 3, /* 4: point 3, within_m (INFINITY: no limit) */
  COLLIDED_ASK_INSIDE = 4,  /* 3: point 3. Which solids hold it? */
  COLLIDED_ASK_SWEEPS = 5   /* 14: pose at time 0, pose at time 1. What does the shape of the options meet first? */
};

/* Zero stands for the default of collided::AskOptions except for `mask`, where 0 lets nothing answer. Therefore begin
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
 * rows     count rows, one after the other. A number that is not finite is COLLIDED_BAD_INPUT except where a row allows it
 * options  may be null
 * answers  *answers is null, or the answers of an earlier call, whose memory is reused; to be given to
 *          collided_free_answers */
COLLIDED_API int collided_ask(collided_client* client, collided_question kind, const double* rows, size_t count,
                              const collided_ask_options* options, collided_answers** answers, collided_error* error);

/* Asks whether configurations of objects would be free, with nothing moved; see collided::Client::what_if. There is one answer
 * for each configuration: a miss is free. Its pair is two hits that follow each other, that of a moved object first; both
 * have the clearance as distance_m (negative if the two touch) and the normal from the first to the second, and each has
 * its nearest point. `inside` is set for one that lies within the other, a solid.
 * objects  JSON: {"objects":["a","b"],"attached":[["child","parent"]],"nearer":2.5,"with_filtered":true}. Only `objects`,
 *          the names of those that are moved, is needed; see collided::WhatIfOptions
 * poses    count configurations, each with a pose for each object in order
 * options  mode COLLIDED_ANY: the first contact found, without numbers; else the least clearance. `only` names what the
 *          configurations are judged against: an object, a scene or a glob. max_hits and error_m do not count. May be null
 * answers  as for collided_ask */
COLLIDED_API int collided_what_if(collided_client* client, const char* objects, const double* poses, size_t count,
                                  const collided_ask_options* options, collided_answers** answers,
                                  collided_error* error);

/* Properties that all answers of a call share. */
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
   * the geometry is complete, three numbers, and the distance that is covered. Else NaN. */
  double* uncovered;
  double* covered_m;
} collided_columns;
COLLIDED_API void collided_read_columns(const collided_answers* answers, const collided_columns* columns);
/* The name of the object of hit number `hit`, counted through all questions; valid until the answers are used again or
 * freed. Null for a number that is too large. */
COLLIDED_API const char* collided_hit_object(const collided_answers* answers, size_t hit);
COLLIDED_API void collided_free_answers(collided_answers* answers);

/* ---- Commands ---- */

/* Sends any command. Arguments and answer are JSON objects, which idl/commands.hpp and idl/command_table.hpp of the sources
 * describe: among others "pair" and "clearance" (how objects stand to each other), "add", "move" and "remove" (objects that
 * outlive this client), "allow", "deny", "attach", "detach", "fence" and "fences" (standing questions), "probe",
 * "explain". The command "status" is answered by the library: what the server last reported of itself.
 * parts       the shape of "add", in the object's frame, or of a region of "fence"; part_count of them, each as far from
 *             the one before as the first one's size. Null for other commands
 * timeout_ns  0: 10 s. A message of progress restarts it
 * answer      may be null */
COLLIDED_API int collided_command(collided_client* client, const char* name, const char* arguments,
                                  const collided_part* parts, size_t part_count, int64_t timeout_ns, char** answer,
                                  collided_error* error);

/* Calls a function of the library that needs no collided_client, and returns when it is done. Names of arguments are those of
 * the C++ members; all but the last two take
 * the options of collided_connect beside their own.
 * name       "diagnose": collided::diagnose, {"findings":[...]}
 *            "fleet": collided::fleet
 *            "replay": path, rate, ask, from, to; collided::replay
 *            "fetch_recording": path, last_ns; {"bytes":1000}
 *            "recorded_events", "recorded_standing": path, only, skip, from, to; the events of a recording (collide record)
 * arguments  from and to are {"since":"1970","offset_ns":0}, where since is 1970, begin or end
 * answer     JSON; may be null */
COLLIDED_API int collided_library(const char* name, const char* arguments, char** answer, collided_error* error);

/* ---- Watches ---- */

/* Kinds of watches, and their options. Each has only and skip (globs) and capacity (events that may wait). */
typedef int32_t collided_followed;
enum {
  COLLIDED_WATCH_CONTACTS = 0, /* collided::Event; persisted, since_ns */
  COLLIDED_WATCH_STANDING = 1, /* collided::StandingEvent; form: region, bands or nearest */
  COLLIDED_WATCH_PROBES = 2    /* collided::ProbeReading */
};

/* Subscribes. A watch of contacts or standing questions begins with what holds already.
 * returns  in *watch, to be given to collided_watch_close */
COLLIDED_API int collided_watch_start(collided_client* client, collided_followed followed, const char* options,
                                      collided_watch** watch, collided_error* error);
/* The next event as a JSON object with the members of its C++ struct. COLLIDED_NOTHING if none comes within wait_ns. */
COLLIDED_API int collided_watch_next(collided_watch* watch, int64_t wait_ns, char** event, collided_error* error);
/* Contacts in bulk: waits up to wait_ns for the first and takes what else is there, up to capacity. COLLIDED_NOTHING if
 * none comes. Texts are valid until the next call for the watch.
 * events  each as far from the one before as the first one's size, which must be set
 * count   how many there are */
COLLIDED_API int collided_watch_read(collided_watch* watch, int64_t wait_ns, collided_event* events, size_t capacity,
                                     size_t* count, collided_error* error);
/* Any pointer may be null.
 * lost     events dropped because they were not taken in time
 * in_step  1: the watch has reported all that holds. 0: not yet, or it is making up for something that it missed */
COLLIDED_API void collided_watch_health(const collided_watch* watch, uint64_t* lost, int32_t* in_step);
COLLIDED_API void collided_watch_close(collided_watch* watch);

/* ---- Publishing ---- */

/* options  collided::PublishOptions: lease_ns (100 ms to a day), gap_ns (1 ms to 8 s)
 * returns  in *publisher, to be given to collided_publisher_close, which removes its objects */
COLLIDED_API int collided_publish(collided_client* client, const char* name, const char* options,
                                  collided_publisher** publisher, collided_error* error);
COLLIDED_API void collided_publisher_close(collided_publisher* publisher);
/* Defines an object, or claims one that is in the world and has no living publisher: its shape stays, and it is given back
 * there instead of being removed.
 * object  name; pose, layers, mask, group, moving, scale, solid, solid_by, as of the command "add"; lost: what becomes of
 *         the object when this publisher is lost (remove, freeze or hold); unknown. With "claim":true only name, pose
 *         and lost count
 * parts   as for collided_command; null to claim
 * handle  may be null */
COLLIDED_API int collided_publisher_add(collided_publisher* publisher, const char* object, const collided_part* parts,
                                        size_t part_count, uint32_t* handle, collided_error* error);
COLLIDED_API int collided_publisher_remove(collided_publisher* publisher, uint32_t handle, collided_error* error);
/* The newest poses of `count` objects, sent by the next flush. The first that is refused ends the call; those before it are
 * taken.
 * positions     three numbers each
 * orientations  four each; null: as the world's axes
 * teleport      1: the objects are placed there, and nothing on the way counts */
COLLIDED_API int collided_publisher_move(collided_publisher* publisher, size_t count, const uint32_t* handles,
                                         const double* positions, const double* orientations, int32_t teleport,
                                         collided_error* error);
/* Sends what was moved, and reports that what was not moved has rested until then.
 * source_time_ns  since 1970; 0: now
 * sequence        number of the last message; may be null
 * error           if the call went well: code COLLIDED_OK and an empty message, unless the server had counted this
 *                 publisher as lost since the last flush; then the message says how that came about and what helps */
COLLIDED_API int collided_publisher_flush(collided_publisher* publisher, int64_t source_time_ns, uint64_t* sequence,
                                          collided_error* error);
COLLIDED_API int collided_publisher_wait_applied(collided_publisher* publisher, int64_t timeout_ns,
                                                 collided_error* error);
/* The objects and poses that the server has not taken as they were published; see collided::PublisherReport.
 * report  {"refused":"","left_out":[["name","why"]],"left_out_count":1,"merged_poses":0} */
COLLIDED_API int collided_publisher_report(collided_publisher* publisher, int64_t timeout_ns, char** report,
                                           collided_error* error);
/* Shows that the publisher is alive, and reports nothing about its objects.
 * source_time_ns  the publisher's time now, for one that gives its own times to collided_publisher_flush; 0: now */
COLLIDED_API int collided_publisher_keep_alive(collided_publisher* publisher, int64_t source_time_ns,
                                               collided_error* error);
/* From now on each object moves between its own poses; see collided::Publisher::stream. */
COLLIDED_API void collided_publisher_stream(collided_publisher* publisher);

/* A robot whose links the publisher claims, to be moved by its joints; see collided::PublishedRobot. The publisher must
 * outlive it.
 * options  urdf: path of the file; scene, base (a pose), joints ([["elbow",0.5]], radians or metres), beyond_limits, lost
 * returns  in *robot, to be given to collided_robot_close; the links stay claimed until the publisher is closed */
COLLIDED_API int collided_robot_claim(collided_client* client, collided_publisher* publisher, const char* options,
                                      collided_robot** robot, collided_error* error);
/* Moves the links; the next flush sends it. After an error of the joints nothing has moved.
 * motion    joints and base as above, where what is missing stays; teleport
 * warnings  a JSON list of sentences; may be null */
COLLIDED_API int collided_robot_set(collided_robot* robot, const char* motion, char** warnings, collided_error* error);
COLLIDED_API void collided_robot_close(collided_robot* robot);

/* ---- Live clouds ---- */

/* A grid of cells in the world that scans make occupied, free or unknown; see collided::PublishedVoxels. The publisher must
 * outlive it, and is to be kept alive as for other objects.
 * options  collided::VoxelOptions: cell, unknown, decay_ns, reach, clearing_delay_ns, most_blocks; and layers and lost
 *          for its objects
 * returns  in *voxels, to be given to collided_voxels_close. Its objects stay until the publisher is closed */
COLLIDED_API int collided_voxels_start(collided_publisher* publisher, const char* name, const char* options,
                                       collided_voxels** voxels, collided_error* error);
COLLIDED_API void collided_voxels_close(collided_voxels* voxels);
/* Takes a scan and sends what it changes. A scan without points lets what was not met for long become unknown.
 * points   doubles, in the world, or floats: three numbers each; one of the two is null
 * origin   of the sensor; with it the space up to each point becomes free. May be null
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
