/* The C interface of the cloth simulator Muslin. Generated from core/c/src; a test keeps it current.
 *
 * All memory belongs to the caller. No function allocates, keeps a pointer that it does not say it keeps, or calls back.
 * A handle is used by one thread at a time. Lengths are in meters, times in seconds, masses in kilograms. */

#ifndef MUSLIN_H
#define MUSLIN_H

#include <stdarg.h>
#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>
#include <stdlib.h>

// The result of a call. A call that does not return `MUSLIN_STATUS_OK` has changed nothing (`muslin_step` names its exception).
typedef enum MuslinStatus {
  // Success.
  MUSLIN_STATUS_OK = 0,
  // A pointer is null or not aligned.
  MUSLIN_STATUS_NULL_POINTER = 1,
  // The pointer is not a handle from muslin_open, or a call that failed inside has spoiled it.
  MUSLIN_STATUS_BAD_HANDLE = 2,
  // The bytes are not a cooked scene; make one with muslin cook.
  MUSLIN_STATUS_NOT_COOKED = 10,
  // The scene was cooked by another version of Muslin; cook it again.
  MUSLIN_STATUS_VERSION = 11,
  // The scene was cooked in double precision; cook it with --precision f32.
  MUSLIN_STATUS_PRECISION = 12,
  // The cooked scene does not have the length that it says.
  MUSLIN_STATUS_TRUNCATED = 13,
  // The cooked scene is damaged: its checksum is wrong.
  MUSLIN_STATUS_CHECKSUM = 14,
  // The scene and the memory must begin at a multiple of 32 bytes.
  MUSLIN_STATUS_ALIGNMENT = 15,
  // The memory is too small; muslin_required_bytes and muslin_snapshot_bytes tell the sizes.
  MUSLIN_STATUS_MEMORY = 16,
  // The cooked scene has a number that cannot be; cook it again.
  MUSLIN_STATUS_MALFORMED = 17,
  // Cooked scenes work on little-endian processors only.
  MUSLIN_STATUS_BYTE_ORDER = 18,
  // The step diverged: a position or velocity is not finite.
  MUSLIN_STATUS_NOT_FINITE_STATE = 30,
  // The step has more contacts than can be resolved.
  MUSLIN_STATUS_TOO_MUCH_CONTACT = 31,
  // Surfaces could not be kept apart in the step.
  MUSLIN_STATUS_SURFACES_MEET = 32,
  // The step has too large an error.
  MUSLIN_STATUS_INACCURATE = 33,
  // The step lacks room for contacts; the report says how much; cook the scene with more (--margin, or --pairs and --contacts).
  MUSLIN_STATUS_NO_ROOM = 34,
  // The step would need more than its budget.
  MUSLIN_STATUS_OVER_BUDGET = 35,
  // The step met a fault of Muslin, please report it; the state has not changed.
  MUSLIN_STATUS_FAULT = 36,
  // There is no such vertex.
  MUSLIN_STATUS_NO_VERTEX = 50,
  // There is no such triangle.
  MUSLIN_STATUS_NO_TRIANGLE = 51,
  // There is no such collider.
  MUSLIN_STATUS_NO_COLLIDER = 52,
  // A number is not finite.
  MUSLIN_STATUS_NOT_FINITE = 53,
  // A time must be finite and not negative.
  MUSLIN_STATUS_SECONDS = 54,
  // A collider needs a thousandth of a step at least, or it would jump through the cloth.
  MUSLIN_STATUS_TOO_FAST = 55,
  // A plane cannot turn; take a box.
  MUSLIN_STATUS_PLANE_TURNS = 56,
  // The vertices of the collider move one by one; use muslin_deform_collider.
  MUSLIN_STATUS_DEFORMS = 57,
  // A vertex is attached to the collider, so it cannot deform; release the vertex first.
  MUSLIN_STATUS_CARRIES = 58,
  // Only a mesh changes its shape.
  MUSLIN_STATUS_NO_MESH = 59,
  // There must be one position for every vertex of the collider.
  MUSLIN_STATUS_POINTS = 60,
  // The collider still moves by keys or frames of the scene.
  MUSLIN_STATUS_SCRIPTED = 61,
  // A vertex is held by a collider that stays, or along single axes that would have to turn.
  MUSLIN_STATUS_HELD = 62,
  // Cloth would intersect a collider.
  MUSLIN_STATUS_OVERLAPS = 63,
  // The scene has no wind; give it drag.wind with coefficients, at velocity 0.
  MUSLIN_STATUS_NO_WIND = 64,
  // Impulses are not measured; cook the scene with --impulses.
  MUSLIN_STATUS_NOT_MEASURED = 65,
  // The snapshot is damaged, or of a scene with other meshes, colliders, pins or room.
  MUSLIN_STATUS_OTHER_SCENE = 66,
  // The cooked scene has no free slot for this; cook it with more (--hands, --forces, --deform).
  MUSLIN_STATUS_NO_SLOT = 67,
  // A fault of Muslin, please report it; open the scene again.
  MUSLIN_STATUS_INTERNAL = 99,
} MuslinStatus;

// A cloth in memory of the caller. Its contents are private.
typedef struct MuslinCloth MuslinCloth;

// Place and orientation of a collider in the world.
typedef struct MuslinPose {
  // Position of its centre, m: the middle of a sphere, a capsule or a box, the point of a plane, the zero of the
  // coordinates of a mesh.
  double position[3];
  // Rotation from the orientation in the scene, a quaternion x, y, z, w.
  double rotation[4];
} MuslinPose;

// The impulse of the cloth on a collider.
typedef struct MuslinImpulse {
  // The impulse, N s.
  double linear[3];
  // Its moment about the centre of the collider, N m s.
  double angular[3];
} MuslinImpulse;

// A surface that something touches.
typedef struct MuslinSide {
  // Whether it is a collider; otherwise it is a cloth.
  bool is_collider;
  // Its number.
  uint32_t index;
} MuslinSide;

// A contact that pushes.
typedef struct MuslinTouch {
  // The two surfaces.
  struct MuslinSide sides[2];
  // Vertices of both features. Those of colliders come after those of the cloth.
  uint32_t vertices[4];
  // Their weights in the nearest points: positive on the first side, negative on the second.
  double weights[4];
  // The nearest point of a cloth, in the world, m.
  double position[3];
  // Unit vector from the second side to the first.
  double normal[3];
  // Force on the first side, with friction, N.
  double force[3];
} MuslinTouch;

// A point of a cloth.
typedef struct MuslinPoint {
  // Position in the world, m.
  double position[3];
  // Velocity, m/s.
  double velocity[3];
  // Unit normal of its triangle; zero if the triangle has no area.
  double normal[3];
} MuslinPoint;

// Where a ray hits a cloth first.
typedef struct MuslinHit {
  // Whether it hits. Otherwise the other fields are zero.
  bool hits;
  // The triangle.
  uint32_t triangle;
  // Barycentric coordinates on it.
  double weights[3];
  // Distance from the origin of the ray, m.
  double distance;
} MuslinHit;

// The work after which a step is given up, at the next place where it can be. It does not depend on the machine.
typedef struct MuslinBudget {
  // Iterations of the linear solver, and rounds of the response to contacts after the first.
  uint32_t iterations;
  // Pairs of features that the response has to test.
  uint32_t candidates;
} MuslinBudget;

// The work of a step, whether or not it succeeded.
typedef struct MuslinReport {
  // Iterations of the linear solver, and rounds of the response to contacts after the first.
  uint32_t iterations;
  // Pairs of features that the response had to test.
  uint32_t candidates;
  // Contacts that push.
  uint32_t contacts;
  // Times that the step, or a part of it, was halved because surfaces would have collided; 0 if it was over its budget.
  uint32_t halved;
  // The vertex where a step diverged or surfaces met. Otherwise it has no meaning.
  uint32_t vertex;
  // Candidates of each kind that need room; 0 if there is enough.
  uint32_t candidates_needed;
  // Contacts that need room; 0 if there is enough.
  uint32_t contacts_needed;
} MuslinReport;

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// The version of the library: `0x00MMmmpp`.
uint32_t muslin_version(void);

// Writes the number of bytes that `muslin_open` needs as memory for a scene. It reads the header alone, so a damaged scene
// may pass.
//
// Requires:
// `block` points to `block_length` bytes, and `bytes` to a `size_t`.
enum MuslinStatus muslin_required_bytes(const uint8_t *block,
                                        size_t block_length,
                                        size_t *bytes);

// Opens a cooked scene where it lies, and writes a handle. Scene and memory must stay as they are while the handle is
// used, and both begin at a multiple of 32 bytes. There is nothing to close: the memory belongs to the caller. It stays as
// it was if the scene is damaged or the memory too small.
//
// Requires:
// `block` points to `block_length` bytes, `memory` to `memory_length` bytes that nothing else uses, and `cloth` to a pointer.
enum MuslinStatus muslin_open(const uint8_t *block,
                              size_t block_length,
                              uint8_t *memory,
                              size_t memory_length,
                              struct MuslinCloth **cloth);

// Writes the words of the last call with this handle that was refused or whose step failed, with the numbers in it, and a
// final zero. Null pointers leave them as they were. Cuts them to `capacity` bytes.
// Returns the length of all words without the zero.
//
// Requires:
// `cloth` is null or a handle; `text` is null or points to `capacity` bytes.
size_t muslin_error(const struct MuslinCloth *cloth,
                    char *text,
                    size_t capacity);

// Moves a collider evenly from its present pose to another one within `seconds`. Call it before every step with the length
// of the step. The step detects everything in the way of the collider.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `pose` is null or points to a pose.
enum MuslinStatus muslin_move_collider(struct MuslinCloth *cloth,
                                       uint32_t collider,
                                       const struct MuslinPose *pose,
                                       double seconds);

// Writes the impulse that the cloth has given a collider since the last call. Its moment is about the present centre of the
// collider, or about the world's origin for one that deforms. The scene must be cooked with `--impulses`.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `impulse` is null or points to an impulse.
enum MuslinStatus muslin_take_impulse(struct MuslinCloth *cloth,
                                      uint32_t collider,
                                      struct MuslinImpulse *impulse);

// Moves every vertex of a mesh evenly to a position in the world within `seconds`. `positions` are x, y and z of each of
// the `count` vertices. The scene must be cooked with `--deform`.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `positions` is null or points to `3 * count` numbers.
enum MuslinStatus muslin_deform_collider(struct MuslinCloth *cloth,
                                         uint32_t collider,
                                         const double *positions,
                                         size_t count,
                                         double seconds);

// Switches a collider off: nothing touches it any more. It still moves.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile.
enum MuslinStatus muslin_switch_off(struct MuslinCloth *cloth, uint32_t collider);

// Switches a collider on again. Refuses where cloth intersects it.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile.
enum MuslinStatus muslin_switch_on(struct MuslinCloth *cloth, uint32_t collider);

// Moves a vertex, pinned or free, at constant velocity to a place in the world within `seconds`, or at once for 0. It
// stays pinned there.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `place` is null or points to three numbers.
enum MuslinStatus muslin_move_to(struct MuslinCloth *cloth,
                                 uint32_t vertex,
                                 const double *place,
                                 double seconds);

// Pins a vertex to a collider where it is now: it moves with the collider.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile.
enum MuslinStatus muslin_attach(struct MuslinCloth *cloth, uint32_t vertex, uint32_t collider);

// Removes all pins of a vertex, if it has any. It keeps the velocity with which they moved it until now.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile.
enum MuslinStatus muslin_release(struct MuslinCloth *cloth,
                                 uint32_t vertex);

// Replaces gravity by a constant one, m/s^2.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `acceleration` is null or points to three numbers.
enum MuslinStatus muslin_set_gravity(struct MuslinCloth *cloth,
                                     const double *acceleration);

// Replaces the velocity of the air by a constant one, m/s. The scene must have wind, if only at velocity 0.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `velocity` is null or points to three numbers.
enum MuslinStatus muslin_set_wind(struct MuslinCloth *cloth,
                                  const double *velocity);

// Sets a force on a vertex, N, until it is set again. The scene must be cooked with room (`--forces`).
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `force` is null or points to three numbers.
enum MuslinStatus muslin_set_force(struct MuslinCloth *cloth,
                                   uint32_t vertex,
                                   const double *force);

// Gives a vertex an impulse, N s: its velocity changes at once, but not along axes that a pin holds.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `impulse` is null or points to three numbers.
enum MuslinStatus muslin_push(struct MuslinCloth *cloth,
                              uint32_t vertex,
                              const double *impulse);

// Moves all cloth, its pins and the given colliders by a rotation about the world's origin and then by a displacement, at
// once. The cloth feels nothing of it.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `by` is null or points to a pose, and `colliders` to `count`
// numbers.
enum MuslinStatus muslin_teleport(struct MuslinCloth *cloth,
                                  const struct MuslinPose *by,
                                  const uint32_t *colliders,
                                  size_t count);

// Positions of the vertices, x, y and z of each, from `muslin_origin`. The pointer is valid as long as the handle, and the
// numbers until the next call that changes it. Writes the number of vertices. Null if the handle is bad.
//
// Requires:
// `cloth` is null or a handle; `vertices` is null or points to a number.
const float *muslin_positions(const struct MuslinCloth *cloth,
                              size_t *vertices);

// Velocities of the vertices, m/s, like `muslin_positions`.
//
// Requires:
// `cloth` is null or a handle; `vertices` is null or points to a number.
const float *muslin_velocities(const struct MuslinCloth *cloth, size_t *vertices);

// Computes the unit normals of the vertices and returns them like `muslin_positions`.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `vertices` is null or points to a number.
const float *muslin_normals(struct MuslinCloth *cloth,
                            size_t *vertices);

// Triangles of the cloth, three vertices each. Writes their number. Null if the handle is bad.
//
// Requires:
// `cloth` is null or a handle; `triangles` is null or points to a number.
const uint32_t *muslin_triangles(const struct MuslinCloth *cloth, size_t *triangles);

// Writes the point in the world from which `muslin_positions` counts, m. It is zero unless the scene is far from the
// world's origin.
//
// Requires:
// `cloth` is null or a handle; `origin` points to three numbers.
enum MuslinStatus muslin_origin(const struct MuslinCloth *cloth,
                                double *origin);

// Simulated time, s; 0 if the handle is bad.
//
// Requires:
// `cloth` is null or a handle.
double muslin_time(const struct MuslinCloth *cloth);

// Length of a step, s; 0 if the handle is bad.
//
// Requires:
// `cloth` is null or a handle.
double muslin_step_length(const struct MuslinCloth *cloth);

// Number of steps taken; 0 if the handle is bad.
//
// Requires:
// `cloth` is null or a handle.
uint64_t muslin_steps(const struct MuslinCloth *cloth);

// Hash of positions and velocities: equal states have equal hashes on every machine. 0 if the handle is bad.
//
// Requires:
// `cloth` is null or a handle.
uint64_t muslin_hash(const struct MuslinCloth *cloth);

// Number of colliders; 0 if the handle is bad.
//
// Requires:
// `cloth` is null or a handle.
uint32_t muslin_collider_count(const struct MuslinCloth *cloth);

// Writes the present pose of a collider in the world.
//
// Requires:
// `cloth` is null or a handle; `pose` points to a pose.
enum MuslinStatus muslin_collider_pose(const struct MuslinCloth *cloth,
                                       uint32_t collider,
                                       struct MuslinPose *pose);

// Writes the contacts that push in the last step, as many as there is room for, and the number of all of them.
//
// Requires:
// `cloth` is null or a handle; `touches` is null or points to `capacity` structs, and `count` to a number.
enum MuslinStatus muslin_touches(const struct MuslinCloth *cloth,
                                 struct MuslinTouch *touches,
                                 size_t capacity,
                                 size_t *count);

// Writes the point of a triangle with these barycentric coordinates.
//
// Requires:
// `cloth` is null or a handle; `weights` points to three numbers and `point` to a point.
enum MuslinStatus muslin_point(const struct MuslinCloth *cloth,
                               uint32_t triangle,
                               const double *weights,
                               struct MuslinPoint *point);

// Writes where a ray hits a cloth first, from either side. Nothing is written if the call fails.
//
// Requires:
// `cloth` is null or a handle; `origin` and `direction` point to three numbers each, and `hit` to a hit.
enum MuslinStatus muslin_hit(const struct MuslinCloth *cloth,
                             const double *origin,
                             const double *direction,
                             struct MuslinHit *hit);

// Size of a snapshot, bytes; 0 if the handle is bad.
//
// Requires:
// `cloth` is null or a handle.
size_t muslin_snapshot_bytes(const struct MuslinCloth *cloth);

// Writes a copy of all that steps and calls change: `muslin_snapshot_bytes`, which `muslin_go_back` takes. `length` is at
// least as much; bytes beyond them, and all bytes if the call fails, stay as they were.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `bytes` is null or points to `length` bytes.
enum MuslinStatus muslin_snapshot(struct MuslinCloth *cloth,
                                  uint8_t *bytes,
                                  size_t length);

// Goes back to a snapshot of this cloth, or of another one with the same triangles, colliders, pins and room, whose
// materials and rest shapes may differ: to change materials, take a snapshot, open a scene with other materials in the same
// memory, and go back. `muslin_touches` finds nothing until the next step.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `bytes` is null or points to `length` bytes.
enum MuslinStatus muslin_go_back(struct MuslinCloth *cloth,
                                 const uint8_t *bytes,
                                 size_t length);

// The words of a status. `muslin_error` tells more about the last error of a handle.
const char *muslin_message(int32_t status);

// Takes one step of the length that the scene has. A step that fails leaves the state as it was, except that pins whose
// time has come have begun. `budget` may be null: then there is no limit. `report` may be null.
//
// Requires:
// `cloth` is null or a handle that nothing else uses meanwhile; `budget` and `report` are null or point to such structs.
enum MuslinStatus muslin_step(struct MuslinCloth *cloth,
                              const struct MuslinBudget *budget,
                              struct MuslinReport *report);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* MUSLIN_H */
