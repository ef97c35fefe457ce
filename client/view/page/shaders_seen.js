// First pass: the visible surface in each pixel, as numbers: slot + 1, distance from the eye, normal and how much that
// faces the eye (4 times 8 bits), and the smooth side of the object. Boxes and meshes are triangles; round primitives
// are cast by rays (shaders_round.js). The second pass (shaders_ink.js) makes paper and ink of these numbers.

// By slot: bits 0 to 7 as in world.js (kMoves ...), bits 8 to 11 its level where faces coincide, bits 12 and 13 which
// sides of its triangles are left out (opening_of).
const kStates = `
uniform highp usampler2D u_states;
uint state_of(uint slot) { return texelFetch(u_states, ivec2(slot % 1024u, slot / 1024u), 0).r; }
// What encloses others is open towards the eye: 1: its outer sides are not drawn; 2: the same, with its triangles inside out.
float opening_of(uint state) { return float(state >> 12 & 3u); }
// The lower level of two coinciding faces is nearer (levels.js): the other one is drawn farther along the same rays, by
// more than corners are rounded to parts of pixels (1/16 where no graphics card draws).
float farther_of(uint state) { return 1.0 + float(state >> 8 & 15u) * 5e-4; }
// Hidden objects are moved out of the picture.
vec4 placed_at(vec4 at, uint state, float shift) {
  if ((state & 32u) != 0u) return vec4(2.0, 2.0, 2.0, 1.0);
  float farther = farther_of(state);
  return vec4(at.xy * farther, (at.z - shift) * farther + shift, at.w * farther);
}
`;

const kSeenOutput = `#version 300 es
precision highp float;
precision highp int;
layout(location = 0) out uvec4 o_seen;
// side: the number of a smooth side; 0: where a new one begins is told by the normal. to_eye: unit, from the place to the eye.
void write_seen(uint slot, float range, vec3 normal, vec3 to_eye, uint side) {
  vec4 rounded = round(clamp(vec4(normal, dot(normal, to_eye)), -1.0, 1.0) * 127.0);
  uvec4 bits = uvec4(ivec4(rounded)) & 255u;
  o_seen = uvec4(slot + 1u, floatBitsToUint(range), bits.x | bits.y << 8 | bits.z << 16 | bits.w << 24, side);
}
`;

const kTurn = `
vec3 turned(vec4 q, vec3 v) { vec3 t = 2.0 * cross(q.yzw, v); return v + q.x * t + cross(q.yzw, t); }
vec3 turned_back(vec4 q, vec3 v) { return turned(vec4(q.x, -q.yzw), v); }
`;

// Static triangles: one surface, every vertex with its object's slot.
const kStillVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec3 a_position;
layout(location = 1) in float a_slot;
uniform mat4 u_matrix;
uniform vec3 u_from_eye;  // the surface's origin
out vec3 v_from_eye;
flat out vec2 v_slot_opening;
${kStates}
void main() {
  uint state = state_of(uint(a_slot));
  v_from_eye = a_position + u_from_eye;
  v_slot_opening = vec2(a_slot, opening_of(state));
  gl_Position = placed_at(u_matrix * vec4(v_from_eye, 1.0), state, u_matrix[3][2]);
}`;

// Triangles of objects with poses: one run of a surface, many objects.
const kPlacedVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec3 a_position;
layout(location = 1) in vec3 i_position;
layout(location = 2) in vec4 i_turn;
layout(location = 3) in float i_slot;
uniform mat4 u_matrix;
uniform vec3 u_anchor_from_eye;
uniform vec3 u_origin;  // of the surface, in the object's frame
out vec3 v_from_eye;
flat out vec2 v_slot_opening;
${kTurn}${kStates}
void main() {
  uint state = state_of(uint(i_slot));
  v_from_eye = turned(i_turn, a_position + u_origin) + i_position + u_anchor_from_eye;
  v_slot_opening = vec2(i_slot, opening_of(state));
  gl_Position = placed_at(u_matrix * vec4(v_from_eye, 1.0), state, u_matrix[3][2]);
}`;

const kOpened = `
bool is_open(float opening) { return opening > 0.5 && gl_FrontFacing == (opening < 1.5); }
`;

const kTriangleFragment = `${kSeenOutput}${kOpened}
in vec3 v_from_eye;
flat in vec2 v_slot_opening;
void main() {
  if (is_open(v_slot_opening.y)) discard;
  vec3 normal = normalize(cross(dFdx(v_from_eye), dFdy(v_from_eye)));
  if (dot(normal, v_from_eye) > 0.0) normal = -normal;
  write_seen(uint(v_slot_opening.x), length(v_from_eye), normal, -normalize(v_from_eye), 0u);
}`;

// A primitive, as written by solids.js.
const kSolidInstance = `
layout(location = 1) in vec3 i_position;
layout(location = 2) in vec4 i_turn;
layout(location = 3) in vec3 i_half;
layout(location = 4) in vec2 i_kind_slot;
uniform mat4 u_matrix;
uniform vec3 u_anchor_from_eye;
`;

// Boxes, as triangles: each pixel of an impostor costs a ray.
const kBoxVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec4 a_corner;  // and the side of the triangle that ends here
${kSolidInstance}out vec3 v_from_eye;
flat out vec3 v_normal;
flat out vec3 v_slot_side_opening;
${kTurn}${kStates}
void main() {
  int side = int(a_corner.w);
  vec3 normal = vec3(0.0);
  normal[side / 2] = side % 2 == 0 ? -1.0 : 1.0;
  v_normal = turned(i_turn, normal);
  v_from_eye = turned(i_turn, a_corner.xyz * i_half) + i_position + u_anchor_from_eye;
  uint state = state_of(uint(i_kind_slot.y));
  v_slot_side_opening = vec3(i_kind_slot.y, float(side + 1), opening_of(state));
  gl_Position = placed_at(u_matrix * vec4(v_from_eye, 1.0), state, u_matrix[3][2]);
}`;

const kBoxFragment = `${kSeenOutput}${kOpened}
in vec3 v_from_eye;
flat in vec3 v_normal;
flat in vec3 v_slot_side_opening;
void main() {
  if (is_open(v_slot_side_opening.z)) discard;
  vec3 normal = dot(v_normal, v_from_eye) > 0.0 ? -v_normal : v_normal;
  write_seen(uint(v_slot_side_opening.x), length(v_from_eye), normal, -normalize(v_from_eye), uint(v_slot_side_opening.y));
}`;
