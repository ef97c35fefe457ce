// First pass: what is seen in each pixel, as numbers: slot + 1, distance from the eye, normal and how much that
// faces the eye (4 times 8 bits), which smooth side of the object. Spheres, capsules and the like are cast by rays inside the box around each; boxes and meshes are triangles.
// The second pass (shaders_ink.js) makes paper and ink of these numbers.

// By slot: bits 0 to 7 as in world.js (kMoves ...), bits 8 to 11 how far it gives way to others where faces coincide, bits 12
// and 13 which sides of its triangles are left out (opening_of).
const kStates = `
uniform highp usampler2D u_states;
uint state_of(uint slot) { return texelFetch(u_states, ivec2(slot % 1024u, slot / 1024u), 0).r; }
// What encloses others is open towards the eye: 1: its outer sides are not drawn; 2: the same, with its triangles inside out.
float opening_of(uint state) { return float(state >> 12 & 3u); }
// Hidden objects are moved out of the picture. Of coinciding faces that of the smaller object is nearer: the larger one is
// drawn farther along the same rays, by more than corners are rounded to parts of pixels (1/16 where no graphics card draws).
vec4 placed_at(vec4 at, uint state, float shift) {
  if ((state & 32u) != 0u) return vec4(2.0, 2.0, 2.0, 1.0);
  float farther = 1.0 + float(state >> 8 & 15u) * 5e-4;
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

// Triangles that stand still: one surface, every vertex with its object's slot.
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

// Boxes, as the triangles that they are: an impostor's pixels each cost a ray.
const kBoxVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec4 a_corner;  // and the side of the triangle that ends here
layout(location = 1) in vec3 i_position;
layout(location = 2) in vec4 i_turn;
layout(location = 3) in vec3 i_half;
layout(location = 4) in vec2 i_kind_slot;
uniform mat4 u_matrix;
uniform vec3 u_anchor_from_eye;
out vec3 v_from_eye;
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

// A box around each round primitive, seen from behind, so that an eye inside it sees it too.
const kSolidVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec4 a_corner;  // and the side of the triangle that ends here
layout(location = 1) in vec3 i_position;
layout(location = 2) in vec4 i_turn;
layout(location = 3) in vec3 i_half;
layout(location = 4) in vec2 i_kind_slot;
uniform mat4 u_matrix;
uniform vec3 u_anchor_from_eye;
out vec3 v_ray;
out float v_depth;
flat out vec3 v_eye;
flat out vec3 v_half;
flat out vec4 v_turn;
flat out vec2 v_kind_slot;
${kTurn}${kStates}
void main() {
  vec3 center = i_position + u_anchor_from_eye;
  vec3 corner = a_corner.xyz * i_half * 1.001;
  v_eye = turned_back(i_turn, -center);
  v_ray = corner - v_eye;
  v_half = i_half;
  v_turn = i_turn;
  v_kind_slot = i_kind_slot;
  gl_Position = placed_at(u_matrix * vec4(turned(i_turn, corner) + center, 1.0), state_of(uint(i_kind_slot.y)) & 255u, 0.0);
  v_depth = gl_Position.w;
}`;

const kSolidFragment = `${kSeenOutput}
in vec3 v_ray;
in float v_depth;
flat in vec3 v_eye;
flat in vec3 v_half;
flat in vec4 v_turn;
flat in vec2 v_kind_slot;
uniform vec2 u_depth_range;  // near, far
${kTurn}
const float kNone = 1e30;
vec3 g_normal;
uint g_side = 1u;

// Each takes the nearest of its hits ahead of 'from'; origin o, unit direction d.
void keep(float t, float from, vec3 normal, inout float best) {
  if (t > from && t < best) { best = t; g_normal = normal; }
}
float ball(vec3 o, vec3 d, float radius, float from) {
  float b = dot(o, d);
  float reach = radius * radius - dot(o - b * d, o - b * d);
  if (reach < 0.0) return kNone;
  float h = sqrt(reach);
  float best = kNone;
  keep(-b - h, from, (o + (-b - h) * d) / radius, best);
  keep(-b + h, from, (o + (-b + h) * d) / radius, best);
  return best;
}
// A tube about z whose radius is r at z = -h and shrinks by k a metre: cylinder and cone.
float tube(vec3 o, vec3 d, float r, float k, float h, float from) {
  float best = kNone;
  float wide = r - k * (o.z + h);
  float a = dot(d.xy, d.xy) - k * k * d.z * d.z;
  float b = dot(o.xy, d.xy) + k * wide * d.z;
  float c = dot(o.xy, o.xy) - wide * wide;
  float root = b * b - a * c;
  if (root >= 0.0 && abs(a) > 1e-12) {
    root = sqrt(root);
    for (int side = -1; side <= 1; side += 2) {
      float t = (-b + float(side) * root) / a;
      vec3 p = o + t * d;
      if (abs(p.z) <= h) keep(t, from, normalize(vec3(p.xy, k * (r - k * (p.z + h)))), best);
    }
  }
  for (int end = -1; end <= 1; end += 2) {
    float t = (float(end) * h - o.z) / d.z;
    vec3 p = o + t * d;
    float cap = end < 0 ? r : r - 2.0 * k * h;
    if (dot(p.xy, p.xy) > cap * cap) continue;
    float before = best;
    keep(t, from, vec3(0.0, 0.0, float(end)), best);
    if (best < before) g_side = uint(2 + end);
  }
  return best;
}
float pill(vec3 o, vec3 d, float r, float h, float from) {
  float best = kNone;
  float a = dot(d.xy, d.xy);
  float b = dot(o.xy, d.xy);
  float root = b * b - a * (dot(o.xy, o.xy) - r * r);
  if (root >= 0.0 && a > 1e-12) {
    root = sqrt(root);
    for (int side = -1; side <= 1; side += 2) {
      float t = (-b + float(side) * root) / a;
      vec3 p = o + t * d;
      if (abs(p.z) <= h) keep(t, from, vec3(p.xy / r, 0.0), best);
    }
  }
  for (int end = -1; end <= 1; end += 2) {
    vec3 normal = g_normal;
    float t = ball(o - vec3(0.0, 0.0, float(end) * h), d, r, from);
    vec3 found = g_normal;
    g_normal = normal;
    if (t < kNone && (o.z + t * d.z) * float(end) >= h) keep(t, from, found, best);
  }
  return best;
}

void main() {
  float whole = length(v_ray);
  vec3 d = v_ray / whole;
  // From the place nearest to the middle, where numbers are small.
  float shift = -dot(v_eye, d);
  vec3 o = v_eye + shift * d;
  int kind = int(v_kind_slot.x);
  float t = kNone;
  if (kind == 0) {
    t = ball(o, d, v_half.x, -shift);
  } else if (kind == 2) {
    t = pill(o, d, v_half.x, v_half.z - v_half.x, -shift);
  } else if (kind == 5) {
    vec3 e = d / v_half;
    float stretch = length(e);
    t = ball(o / v_half, e / stretch, 1.0, -shift * stretch) / stretch;
    if (t < kNone / stretch) g_normal = normalize(g_normal / v_half); else t = kNone;
  } else {
    t = tube(o, d, v_half.x, kind == 4 ? v_half.x / (2.0 * v_half.z) : 0.0, v_half.z, -shift);
  }
  if (t >= kNone) discard;
  float range = t + shift;
  float depth = v_depth * range / whole;
  float n = u_depth_range.x;
  float f = u_depth_range.y;
  gl_FragDepth = clamp(0.5 + 0.5 * ((f + n) / (f - n) - 2.0 * f * n / ((f - n) * depth)), 0.0, 1.0);
  write_seen(uint(v_kind_slot.y), range, turned(v_turn, g_normal), -turned(v_turn, d), g_side + uint(kind) * 8u);
}`;
