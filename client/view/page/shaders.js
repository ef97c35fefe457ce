// First pass: what is seen in each pixel, as numbers: slot + 1, distance from the eye, normal. Spheres, boxes, capsules and
// the like are cast by rays inside the box around each; meshes are triangles. Second pass: paper and ink from those numbers.

const kSeenOutput = `#version 300 es
precision highp float;
precision highp int;
layout(location = 0) out uvec4 o_seen;
vec2 folded(vec3 n) {
  n /= abs(n.x) + abs(n.y) + abs(n.z);
  vec2 s = vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
  return n.z >= 0.0 ? n.xy : (1.0 - abs(n.yx)) * s;
}
void write_seen(uint slot, float range, vec3 normal) {
  o_seen = uvec4(slot + 1u, floatBitsToUint(range), packSnorm2x16(folded(normal)), 0u);
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
flat out float v_slot;
void main() {
  v_from_eye = a_position + u_from_eye;
  v_slot = a_slot;
  gl_Position = u_matrix * vec4(v_from_eye, 1.0);
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
flat out float v_slot;
${kTurn}
void main() {
  v_from_eye = turned(i_turn, a_position + u_origin) + i_position + u_anchor_from_eye;
  v_slot = i_slot;
  gl_Position = u_matrix * vec4(v_from_eye, 1.0);
}`;

const kTriangleFragment = `${kSeenOutput}
in vec3 v_from_eye;
flat in float v_slot;
void main() {
  vec3 normal = normalize(cross(dFdx(v_from_eye), dFdy(v_from_eye)));
  if (dot(normal, v_from_eye) > 0.0) normal = -normal;
  write_seen(uint(v_slot), length(v_from_eye), normal);
}`;

// A box around each primitive, seen from behind, so that an eye inside it sees it too.
const kSolidVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec3 a_corner;
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
${kTurn}
void main() {
  vec3 center = i_position + u_anchor_from_eye;
  vec3 corner = a_corner * i_half * 1.001;
  v_eye = turned_back(i_turn, -center);
  v_ray = corner - v_eye;
  v_half = i_half;
  v_turn = i_turn;
  v_kind_slot = i_kind_slot;
  gl_Position = u_matrix * vec4(turned(i_turn, corner) + center, 1.0);
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
float box(vec3 o, vec3 d, vec3 half_size, float from) {
  vec3 inverse = 1.0 / mix(d, vec3(1e-9), lessThan(abs(d), vec3(1e-9)));
  vec3 middle = -o * inverse;
  vec3 reach = abs(inverse) * half_size;
  vec3 enter = middle - reach;
  vec3 leave = middle + reach;
  float first = max(max(enter.x, enter.y), enter.z);
  float last = min(min(leave.x, leave.y), leave.z);
  if (first > last) return kNone;
  float best = kNone;
  keep(first, from, -sign(d) * step(enter.yzx, enter.xyz) * step(enter.zxy, enter.xyz), best);
  keep(last, from, sign(d) * step(leave.xyz, leave.yzx) * step(leave.xyz, leave.zxy), best);
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
    if (dot(p.xy, p.xy) <= cap * cap) keep(t, from, vec3(0.0, 0.0, float(end)), best);
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
  } else if (kind == 1) {
    t = box(o, d, v_half, -shift);
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
  write_seen(uint(v_kind_slot.y), range, turned(v_turn, g_normal));
}`;

const kWholeVertex = `#version 300 es
void main() { gl_Position = vec4(vec2(gl_VertexID % 2, gl_VertexID / 2) * 4.0 - 1.0, 0.0, 1.0); }`;

const kInkFragment = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
uniform usampler2D u_seen;
uniform usampler2D u_states;  // by slot: bit 0 moves, 1 in contact, 2 under the pointer, 3 chosen, 4 stale
uniform vec2 u_size;          // of the picture
uniform vec3 u_paper;
uniform vec3 u_ink;
uniform vec3 u_accent;
uniform vec3 u_light;
uniform vec3 u_back;    // axes of the eye
uniform vec3 u_right;   // with the picture's half width
uniform vec3 u_up;      // with its half height
uniform vec4 u_ground;  // plane: normal, height of the eye above it
uniform vec3 u_grid_eye;
uniform float u_grid;
out vec4 o_color;

vec3 normal_of(uint bits) {
  vec2 e = unpackSnorm2x16(bits);
  vec3 n = vec3(e, 1.0 - abs(e.x) - abs(e.y));
  if (n.z < 0.0) n.xy = (1.0 - abs(n.yx)) * vec2(n.x >= 0.0 ? 1.0 : -1.0, n.y >= 0.0 ? 1.0 : -1.0);
  return normalize(n);
}
uvec4 seen_at(ivec2 place, ivec2 size) { return texelFetch(u_seen, clamp(place, ivec2(0), size - 1), 0); }
float range_of(uvec4 seen) { return seen.x == 0u ? 1e20 : uintBitsToFloat(seen.y); }

// How much of an edge runs on this side of the border to a neighbour.
float edge_to(uvec4 here, float range, vec3 normal, uvec4 there) {
  if (here.x == 0u) return 0.0;
  float beyond = range_of(there);
  if (there.x != here.x) return range <= beyond ? 1.0 : 0.0;
  vec3 other = normal_of(there.z);
  if (beyond - range > 0.04 * range && dot(normal, other) > -0.2) return 0.8;
  return dot(normal, other) < 0.8 ? 0.5 : 0.0;
}

// Lines of a grid on the ground, thinner the farther away.
float ground(vec3 ray) {
  float down = dot(ray, u_ground.xyz);
  if (down * u_ground.w >= 0.0) return 0.0;
  float t = -u_ground.w / down;
  vec3 p = u_grid_eye + t * ray;
  vec2 q = (abs(u_ground.z) > 0.5 ? p.xy : p.xz) / u_grid;
  vec2 width = max(fwidth(q), 1e-6);
  vec2 line = 1.0 - clamp(abs(fract(q - 0.5) - 0.5) / width, 0.0, 1.0);
  return max(line.x, line.y) * clamp(1.0 - max(width.x, width.y) * 3.0, 0.0, 1.0);
}

void main() {
  ivec2 size = textureSize(u_seen, 0);
  vec2 at = gl_FragCoord.xy / u_size;
  ivec2 place = ivec2(gl_FragCoord.xy);
  uvec4 here = seen_at(place, size);
  vec3 ray = -u_back + (2.0 * at.x - 1.0) * u_right + (2.0 * at.y - 1.0) * u_up;
  float lines = ground(ray);
  vec3 color = u_paper;
  float edge = 0.0;
  if (here.x == 0u) {
    color = mix(color, u_ink, 0.16 * lines);
  } else {
    vec3 normal = normal_of(here.z);
    float range = range_of(here);
    uint slot = here.x - 1u;
    uint state = texelFetch(u_states, ivec2(slot % 1024u, slot / 1024u), 0).r;
    float light = dot(normal, u_light);
    float tone = light > 0.45 ? 0.0 : light > -0.15 ? 0.05 : 0.11;
    bool moves = (state & 1u) != 0u;
    color = mix(u_paper, u_ink, tone + (moves ? 0.10 : 0.025));
    if ((state & 2u) != 0u) color = mix(color, u_accent, 0.30);
    if ((state & 4u) != 0u) color = mix(color, u_accent, 0.08);
    if ((state & 8u) != 0u) color = mix(color, u_accent, 0.25);
    if ((state & 16u) != 0u && fract((gl_FragCoord.x + gl_FragCoord.y) / 7.0) < 0.25) color = mix(color, u_ink, 0.4);
    for (int i = 0; i < 4; ++i) {
      ivec2 step_to = i == 0 ? ivec2(1, 0) : i == 1 ? ivec2(-1, 0) : i == 2 ? ivec2(0, 1) : ivec2(0, -1);
      edge = max(edge, edge_to(here, range, normal, seen_at(place + step_to, size)));
    }
    color = mix(color, u_ink, edge * 0.9);
  }
  o_color = vec4(color, 1.0);
}`;

// Lines, rings and dots over the picture; behind something they are paler and dashed, as a draughtsman would.
const kMarkVertex = `#version 300 es
precision highp float;
layout(location = 0) in vec2 a_corner;   // -1 to 1 across and along
layout(location = 1) in vec3 i_from;
layout(location = 2) in vec3 i_to;
layout(location = 3) in vec4 i_look;     // width (px), kind (0 line, 1 ring, 2 dot), strength, accent
uniform mat4 u_matrix;
uniform vec3 u_anchor_from_eye;
uniform vec2 u_size;
uniform float u_pixels;  // to one of the screen
out vec2 v_place;
out float v_range;
flat out vec4 v_look;
flat out float v_pixels;
void main() {
  vec3 from = i_from + u_anchor_from_eye;
  vec3 to = i_to + u_anchor_from_eye;
  vec4 a = u_matrix * vec4(from, 1.0);
  vec4 b = u_matrix * vec4(to, 1.0);
  const float kNear = 1e-4;
  if (a.w < kNear && b.w < kNear) { gl_Position = vec4(2.0, 2.0, 2.0, 1.0); return; }
  if (a.w < kNear) { float t = (kNear - a.w) / (b.w - a.w); a = mix(a, b, t); from = mix(from, to, t); }
  if (b.w < kNear) { float t = (kNear - b.w) / (a.w - b.w); b = mix(b, a, t); to = mix(to, from, t); }
  vec2 along = (b.xy / b.w - a.xy / a.w) * u_size * 0.5;
  v_pixels = length(along);
  along = v_pixels > 1e-3 ? along / v_pixels : vec2(1.0, 0.0);
  vec2 across = vec2(-along.y, along.x);
  bool line = i_look.y < 0.5;
  float end = a_corner.y * 0.5 + 0.5;
  vec4 p = line && end > 0.5 ? b : a;
  float reach = i_look.x * u_pixels * 0.5 + 1.0;
  vec2 offset = a_corner.x * across * reach + a_corner.y * along * (line ? 1.0 : reach);
  v_place = vec2(a_corner.x * reach, line ? end * v_pixels : a_corner.y * reach);
  v_range = length(line ? mix(from, to, end) : from);
  v_look = vec4(i_look.x * u_pixels, i_look.yzw);
  gl_Position = vec4(p.xy + offset / (u_size * 0.5) * p.w, 0.0, p.w);
}`;

const kMarkFragment = `#version 300 es
precision highp float;
precision highp int;
precision highp usampler2D;
uniform usampler2D u_seen;
uniform vec3 u_ink;
uniform vec3 u_accent;
in vec2 v_place;
in float v_range;
flat in vec4 v_look;
flat in float v_pixels;
out vec4 o_color;
void main() {
  uvec4 seen = texelFetch(u_seen, ivec2(gl_FragCoord.xy), 0);
  bool hidden = seen.x != 0u && uintBitsToFloat(seen.y) < v_range * 0.998;
  float half_width = v_look.x * 0.5;
  float cover;
  if (v_look.y < 0.5) {
    cover = clamp(half_width + 0.5 - abs(v_place.x), 0.0, 1.0);
    if (hidden && fract(v_place.y / 8.0) > 0.5) cover = 0.0;
  } else if (v_look.y < 1.5) {
    cover = clamp(1.5 - abs(length(v_place) - half_width + 1.0), 0.0, 1.0);
  } else {
    cover = clamp(half_width + 0.5 - length(v_place), 0.0, 1.0);
  }
  float alpha = cover * v_look.z * (hidden ? 0.4 : 1.0);
  if (alpha <= 0.0) discard;
  o_color = vec4(mix(u_ink, u_accent, v_look.w) * alpha, alpha);
}`;
